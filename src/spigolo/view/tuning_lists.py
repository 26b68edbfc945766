"""Lists of objects and rejected regions on the tuning page. Each object or region is a button."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from spigolo.objects.boxes import OrientedBox
from spigolo.objects.drawing import palette
from spigolo.objects.segmentation import ObjectMask, RejectedRegion, Segmentation
from spigolo.view import tuning_text as text
from spigolo.view.tuning_session import Pixel, inner_pixel

if TYPE_CHECKING:
    import viser

MOST_OBJECTS, MOST_REJECTED = 40, 30
"""Maximum number of objects in the list of objects, and of regions in the list of rejected regions. Objects are listed
by descending score, and regions by descending area.
"""
GREY, RED, YELLOW = (73, 80, 87), (235, 64, 52), (200, 160, 0)


class Lists:
    """Two lists of buttons, one button for each object and each rejected region. A click on a button selects an object
    or a rejected region.

    - gui: interface of the page.
    - select: function that is called with a pixel (y, x) of the selected object or region.
    """

    def __init__(self, gui: viser.GuiApi, select: Callable[[Pixel | None], None]) -> None:
        self._select = select
        self._shown: dict[int, ObjectMask | RejectedRegion] = {}
        self._title = gui.add_markdown("")
        self.objects = [self._button(gui, k) for k in range(MOST_OBJECTS)]
        self._refused = gui.add_markdown("")
        self.rejected = [self._button(gui, k) for k in range(MOST_OBJECTS, MOST_OBJECTS + MOST_REJECTED)]

    def show(
        self,
        result: Segmentation,
        boxes: Sequence[OrientedBox | None],
        chosen: ObjectMask | RejectedRegion | None,
    ) -> None:
        """Show the objects and rejected regions of a result in the lists.

        - boxes: oriented box of each object.
        - chosen: selected object or region, which is highlighted.
        """
        tints = palette(len(result))
        refused = sorted(result.rejected, key=lambda r: -r.area_px)[:MOST_REJECTED]
        self._title.content = text.count(len(result), "object")
        self._refused.content = text.count(len(result.rejected), "rejected region")
        self._shown = dict(enumerate(result.objects[:MOST_OBJECTS])) | dict(enumerate(refused, start=MOST_OBJECTS))
        for k, button in enumerate([*self.objects, *self.rejected]):
            region = self._shown.get(k)
            if region is not None:
                is_object = isinstance(region, ObjectMask)
                here = chosen is not None and chosen.region == region.region
                plain = tuple(int(v * 0.75) for v in tints[k]) if is_object else GREY
                _set(button, "color", (YELLOW if is_object else RED) if here else plain)
                _set(button, "label", text.line(region, boxes[k] if is_object else None))
                _set(button, "hint", text.facts(region))
            _set(button, "visible", region is not None)

    def _button(self, gui: viser.GuiApi, k: int) -> Any:
        button = gui.add_button("", visible=False)
        button.on_click(lambda _: self._pressed(k))
        return button

    def _pressed(self, k: int) -> None:
        region = self._shown.get(k)
        if region is not None:
            self._select(inner_pixel(region))


def _set(handle: Any, name: str, value: Any) -> None:
    if getattr(handle, name) != value:
        setattr(handle, name, value)
