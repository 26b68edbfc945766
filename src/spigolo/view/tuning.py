"""Web page to tune parameters interactively, with a control for each parameter next to the segmentation result."""

from __future__ import annotations

import contextlib
import io
import threading
import webbrowser
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spigolo.errors import SpigoloError
from spigolo.frames.frame import Frame
from spigolo.frames.roi import Roi
from spigolo.settings.config import Config
from spigolo.settings.presets import OBJECTS
from spigolo.view import tuning_scene as scene
from spigolo.view import tuning_text as text
from spigolo.view.tuning_controls import Controls
from spigolo.view.tuning_lists import Lists
from spigolo.view.tuning_session import Numbered, Pixel, Session
from spigolo.view.tuning_space import Space
from spigolo.view.tuning_worker import Latest

if TYPE_CHECKING:
    import viser

VIEWS = ("picture", "both", "cloud")
KEEP, DROP, MERGE, UNDO = "keep", "drop", "merge", "undo"
RESET, SAVE = "reset to preset", "save preset"
BACK, ON = "◀ previous", "next ▶"
WIDTH_PX = 360
PHONE = """<style>@media (max-width: 600px) {
.mantine-Paper-root[style*="position: fixed"][style*="bottom: 0px"], .mantine-Paper-root div[style*="width: 20em"]
{ width: 100% !important; } }</style>"""
"""Style sheet that makes the controls as wide as the screen of a phone."""
BRAND = (46, 134, 222)


def tune(
    frames: Frame | Iterable[Frame] | Numbered,
    config: Config = OBJECTS,
    roi: Roi | None = None,
    port: int = 8080,
    host: str = "127.0.0.1",
    *,
    open_browser: bool = True,
    folder: Path | str = ".",
    block: bool = True,
) -> TuningPage:
    """Open a web page to tune the parameters of the segmentation interactively.

    - frames: a frame, a list of frames, a source of frames, or an iterator of frames.
    - config: configuration whose values the page shows first.
    - roi: region of interest in all frames, as for `segment`.
    - port: port of the web server.
    - host: network address of the web server. By default, the page can be opened only on this machine.
    - open_browser: True to open the page in a browser.
    - folder: folder in which the page saves presets.
    - block: True to wait until the page is closed or Ctrl-C is pressed.

    Raises SpigoloError if the package viser is missing (`pip install "spigolo[tune]"`).
    """
    page = TuningPage(Session(frames, config, roi), port, host, Path(folder))
    if open_browser:
        webbrowser.open(page.url)
    if block:
        page.wait()
    return page


class TuningPage:
    """Web server and state of one tuning page. Call `close` to stop the server, or use the page as a context
    manager.
    """

    def __init__(self, session: Session, port: int = 8080, host: str = "127.0.0.1", folder: Path = Path()) -> None:
        self.session = session
        self.server = _server(host, port)
        self.url = f"http://{host}:{self.server.get_port()}"
        """URL of the page."""
        self.drawn = 0
        """Number of times that a segmentation result was drawn on the page."""
        self._folder, self._saved = folder, set[Path]()
        self._tried = False  # True after the first attempt to segment a frame
        self._stage, self._merging = scene.STAGES[0], False
        self._place: viser.GuiSliderHandle[int] | None = None
        self._drawing = threading.RLock()
        self._closed = threading.Event()
        self.space = Space(self.server, self.select)
        self._build()
        self.worker = Latest(self._run)
        self.worker.ask()

    def __enter__(self) -> TuningPage:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def wait(self) -> None:
        """Wait until the page is closed or Ctrl-C is pressed."""
        try:
            self._closed.wait()
        except KeyboardInterrupt:
            self.close()

    def close(self) -> None:
        """Stop the web server and the segmentation thread."""
        self._playing.value = False
        self.worker.close()
        self.server.stop()
        self._closed.set()

    def select(self, pixel: Pixel | None) -> None:
        """Select the object or rejected region at a pixel (y, x).

        If the user chose the action "merge" before, the new selection is merged with the previous selection.
        """
        if self._merging and pixel is not None and self.session.selected is not None:
            self.session.correct("merge", self.session.selected, pixel)
        self._merging = False
        self.session.selected = pixel
        self._draw()

    def act(self, action: str) -> None:
        """Keep, drop or merge the selected object or region, or undo the last correction."""
        pixel = self.session.selected
        self._merging = action == MERGE and pixel is not None
        if action == UNDO:
            self.session.undo()
        elif action == KEEP and pixel is not None:
            self.session.correct("keep", pixel)
        elif action == DROP and pixel is not None:
            self.session.correct("drop", pixel)
        self._draw()

    def _build(self) -> None:
        gui = self.server.gui
        gui.configure_theme(
            control_width="large", dark_mode=True, show_logo=False, show_share_button=False, brand_color=BRAND
        )
        gui.main_panel.dock_right()
        gui.main_panel.set_width(WIDTH_PX)
        gui.add_html(PHONE)
        self._status = gui.add_markdown("segmenting ...")
        self._build_view(gui)
        self._chosen = gui.add_markdown(text.HINT)
        actions = gui.add_button_group("selected", (KEEP, DROP, MERGE, UNDO))
        actions.on_click(lambda event: self.act(event.target.value))
        tabs = gui.add_tab_group()
        with tabs.add_tab("Tune"):
            self._build_presets(gui)
            self._controls = Controls(gui, self.session.values, self._set)
        with tabs.add_tab("Objects"):
            self._lists = Lists(gui, self.select)
        with tabs.add_tab("Time"):
            self._times = gui.add_markdown("")

    def _build_view(self, gui: viser.GuiApi) -> None:
        stages = gui.add_dropdown("show", scene.STAGES, hint="Stage of the method to show as an image.")
        stages.on_update(lambda event: self._show(event.target.value))
        views = gui.add_button_group("look at", VIEWS)
        views.on_click(self._turn)
        count = self.session.reel.count
        several = count != 1
        if count is not None and several:
            self._place = gui.add_slider("frame", 1, count, 1, 1, hint=f"Number of the frame, from 1 to {count}.")
            self._place.on_update(lambda event: self._go(event.target.value - 1))
        steps = gui.add_button_group("go to", (BACK, ON), visible=several)
        steps.on_click(lambda event: self._move(1 if event.target.value == ON else -1))
        self._playing = gui.add_checkbox("play", False, hint="Show all frames one after the other.", visible=several)
        self._playing.on_update(lambda _: self.worker.ask())

    def _build_presets(self, gui: viser.GuiApi) -> None:
        names = tuple(self.session.presets)
        self._preset = gui.add_dropdown("preset", names, initial_value=self.session.preset)
        self._preset.on_update(lambda event: self._load(event.target.value))
        name = gui.add_text("file", "mine.toml", hint=f"Name of the file to save to, in {self._folder.resolve()}.")
        actions = gui.add_button_group("values", (RESET, SAVE))
        actions.on_click(
            lambda event: (
                self._save(name.value, event.client) if event.target.value == SAVE else self._load(self._preset.value)
            )
        )

    def _turn(self, event: viser.GuiEvent[Any]) -> None:
        if event.client is not None:
            self.space.look(event.client, event.target.value)

    def _set(self, key: str, value: Any) -> None:
        if self.session.set(key, value):
            self.worker.ask()

    def _load(self, name: str) -> None:
        self.session.load(name)
        with self.server.atomic():
            self._controls.refresh()
        self.worker.ask()

    def _show(self, stage: str) -> None:
        self._stage = stage
        self._draw()

    def _move(self, step: int) -> None:
        try:
            if self.session.move(step):
                self._show_place()
                self.worker.ask()
        except SpigoloError as error:
            self._status.content = text.trouble(error)

    def _go(self, position: int) -> None:
        if self.session.go(position):  # `go` returns False if `_show_place` moved the slider
            self.worker.ask()

    def _show_place(self) -> None:
        """Move the slider for frames to the number of the current frame."""
        if self._place is not None:
            self._place.value = self.session.reel.position + 1

    def _save(self, name: str, client: viser.ClientHandle | None) -> None:
        try:
            path = self._write(name)
            said = f"{path.name} saved. Use it with --preset {path}"
        except (SpigoloError, OSError) as error:
            said = str(error)
        if client is not None:
            client.add_notification("spigolo", said, auto_close_seconds=8.0)

    def _write(self, name: str) -> Path:
        path = self._folder / Path(name).name
        if not Path(name).name:
            raise SpigoloError("expected a name that ends in .toml, got an empty name")
        if path.exists() and path not in self._saved:
            raise SpigoloError(f"{path.name} exists already: choose another name")
        self.session.save(path)
        self._saved.add(path)
        return path

    def _run(self) -> bool:
        """Segment the current frame and draw the result. `_run` is called on the segmentation thread, and returns True
        if it must be called again.
        """
        try:
            if self._playing.value and self._tried:
                self._play()
            self._tried = True
            first = self.session.answer is None
            self.session.run()
            self._draw()
            if first:  # the first run also loaded the kernels: measure the time again
                return True
        except SpigoloError as error:
            self._status.content = text.trouble(error)
        except Exception as error:  # the page must continue after any error
            self._status.content = text.trouble(error)
        return bool(self._playing.value)

    def _play(self) -> None:
        if self.session.move(1):
            self._show_place()
        else:
            self._playing.value = False

    def _draw(self) -> None:
        """Draw the segmentation result and the selected object or region."""
        with self._drawing:
            answer = self.session.answer
            if answer is None:
                return
            chosen = self.session.at(self.session.selected)
            boxes = [o.oriented_box() for o in answer.result]
            self.space.show(answer, self._stage, chosen, boxes)
            self._status.content = text.status(answer, self.session)
            self._chosen.content = text.selection(chosen, self._merging)
            self._times.content = text.times(answer)
            self._lists.show(answer.result, boxes, chosen)
            self.drawn += 1


def _server(host: str, port: int) -> viser.ViserServer:
    try:
        import viser
    except ImportError:
        raise SpigoloError('the tuning page needs viser: pip install "spigolo[tune]"') from None
    with contextlib.redirect_stdout(io.StringIO()):  # suppresses the start message of viser
        return viser.ViserServer(host=host, port=port, label="spigolo", verbose=False)
