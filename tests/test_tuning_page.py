"""The tuning page in a real browser: a slider changes the picture, a click keeps a region, a bag is gone through.

SPIGOLO_SCREENSHOTS=docs/images python -m pytest tests/test_tuning_page.py draws the picture of docs/tuning.md again.
"""

from __future__ import annotations

import contextlib
import itertools
import os
import shutil
import socket
import statistics
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import cv2
import numpy as np
import pytest

import spigolo as sp
from bags import usual_bag
from browser import chromium, in_browser, opened, until
from spigolo.view.tuning import TuningPage
from spigolo.view.tuning_session import Session

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

pytestmark = [
    in_browser,
    pytest.mark.alone,
    pytest.mark.skipif(os.environ.get("NUMBA_DISABLE_JIT") == "1", reason="whole frames need compiled kernels"),
]
SCENE = Path(sp.__file__).parent / "demo_scene"
TABLE, BALL = (440, 150), (325, 545)
HEIGHT = "additions.support.min_height_m"
WINDOW, PHONE = (1280, 800), (390, 844)


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with chromium() as started:
        yield started


@pytest.fixture
def page(tmp_path: Path) -> Iterator[TuningPage]:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    with TuningPage(Session([frame, frame]), free_port(), folder=tmp_path) as started:
        yield started


def test_play_goes_on_after_an_unreadable_first_frame(tmp_path: Path) -> None:
    for name in ("a", "b"):
        shutil.copytree(SCENE, tmp_path / name)
    (tmp_path / "a" / "depth.png").write_bytes(b"junk")
    source = sp.open_source(tmp_path)
    with source, TuningPage(Session(source), free_port(), folder=tmp_path) as page:
        page._playing.value = True
        page.worker.ask()
        until(lambda: page.session.answer is not None and not page._playing.value)
        assert page.session.reel.position == 1


def test_a_preset_is_written_into_the_folder_of_the_page(page: TuningPage, tmp_path: Path) -> None:
    assert page._write("sub/mine.toml") == tmp_path / "mine.toml"
    assert sp.preset(tmp_path / "mine.toml").digest == sp.OBJECTS.digest
    with pytest.raises(sp.errors.SpigoloError, match="got an empty name"):
        page._write("")


def free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


def test_a_slider_changes_the_picture_and_a_click_keeps_a_region(
    browser: Browser, page: TuningPage, tmp_path: Path
) -> None:
    seen = opened(browser, page.url, *WINDOW)
    settle(page, seen)
    found = len(answer(page))
    before = canvas(seen)

    slider = seen.get_by_role("slider").nth(1)  # that of the height above the plane, after that of frames
    slider.focus()
    slider.press("End")  # an arrow key would turn the view too
    until(lambda: page.session.values.of[HEIGHT] == 0.05)
    settle(page, seen)
    assert len(answer(page)) < found or len(answer(page).rejected) > 2
    assert changed(before, canvas(seen)) > 0.001
    seen.get_by_role("heading", name=f"{len(answer(page))} object").wait_for(timeout=20_000)

    seen.get_by_role("button", name="reset to preset").click()
    until(lambda: page.session.values.of[HEIGHT] == 0.008)
    settle(page, seen)
    assert len(answer(page)) == found

    select(page, seen, TABLE)
    seen.get_by_text("Rejected: support").first.wait_for(timeout=20_000)
    seen.get_by_role("button", name="keep").click()
    until(lambda: len(answer(page)) == found + 1)
    assert answer(page).labels[TABLE] > 0
    seen.get_by_role("button", name="undo").click()
    until(lambda: len(answer(page)) == found)

    seen.get_by_role("button", name="save preset").click()
    until((tmp_path / "mine.toml").is_file)
    assert sp.preset(tmp_path / "mine.toml").digest == sp.OBJECTS.digest
    seen.close()


def test_it_looks_as_in_the_docs_and_fits_a_phone(browser: Browser, page: TuningPage, tmp_path: Path) -> None:
    folder = Path(os.environ.get("SPIGOLO_SCREENSHOTS", tmp_path))
    seen = opened(browser, page.url, *WINDOW)
    settle(page, seen)
    select(page, seen, BALL)
    settle(page, seen)
    write(folder / "tuning.jpg", screenshot(seen))
    seen.close()
    seen = opened(browser, page.url, *PHONE)
    settle(page, seen)
    write(tmp_path / "phone.jpg", screenshot(seen))
    box = seen.get_by_role("button", name="keep").bounding_box()
    assert box is not None
    assert 0 <= box["x"] < box["x"] + box["width"] <= PHONE[0]
    seen.close()


def test_a_new_picture_follows_each_move_of_a_slider(browser: Browser, page: TuningPage) -> None:
    seen = opened(browser, page.url, *WINDOW)
    settle(page, seen)
    times = [follow(seen, k % 2 == 0) for k in range(6)]
    print(f"slider to new picture in the page: median {statistics.median(times):.0f} ms, largest {max(times):.0f} ms")
    settle(page, seen)
    seen.get_by_role("heading", name=f"{len(answer(page))} object").wait_for(timeout=20_000)
    seen.close()


def test_a_recording_is_gone_through_by_steps_and_by_numbers(browser: Browser, tmp_path: Path) -> None:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    path = usual_bag("ros2-mcap", frame, pairs=5, shift_px=-60).write(tmp_path)
    with sp.open_source(path) as source, TuningPage(Session(source), free_port(), folder=tmp_path) as page:
        seen = opened(browser, page.url, *WINDOW)
        number = seen.locator("input.mantine-NumberInput-input").first
        pictures = [stand_at(page, seen, 1)]
        press(page, seen, "next", 1)
        pictures.append(stand_at(page, seen, 2))

        number.fill("5")
        pictures.append(stand_at(page, seen, 5))
        press(page, seen, "next", 4)  # there is none
        press(page, seen, "previous", 3)
        pictures.append(stand_at(page, seen, 4))
        number.fill("1")
        again = stand_at(page, seen, 1)
        seen.close()
    assert all(changed(a, b) > 0.08 for a, b in itertools.combinations(pictures, 2))
    assert changed(again, pictures[0]) < 0.02  # the page draws edges softer after a while


def test_the_slider_of_frames_follows_play_and_fits_a_phone(browser: Browser, page: TuningPage) -> None:
    seen = opened(browser, page.url, *PHONE)
    settle(page, seen)
    for thing in (seen.get_by_role("slider").first, seen.locator("input.mantine-NumberInput-input").first):
        box = thing.bounding_box()
        assert box is not None
        assert 0 <= box["x"] < box["x"] + box["width"] <= PHONE[0]
    page._playing.value = True
    stand_at(page, seen, 2)
    until(lambda: not page._playing.value)  # the last frame ends it
    seen.close()


def test_a_stream_has_steps_and_no_slider_of_frames(browser: Browser, tmp_path: Path) -> None:
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    with TuningPage(Session(itertools.repeat(frame)), free_port(), folder=tmp_path) as page:
        seen = opened(browser, page.url, *WINDOW)
        assert page._place is None
        press(page, seen, "next", 1)
        seen.get_by_text("frame 2 · ").first.wait_for(timeout=20_000)
        seen.close()


def press(page: TuningPage, seen: Page, name: str, position: int) -> None:
    """Press a button until the session stands at a frame: a busy browser may miss a click."""
    for _ in range(3):
        seen.get_by_role("button", name=name).click()
        with contextlib.suppress(AssertionError):
            until(lambda: page.session.reel.position == position, 15)
            return
    raise AssertionError(f"no click on {name} arrived")


def stand_at(page: TuningPage, seen: Page, number: int) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """Return the picture once the text and the slider say that it is that of a frame, counted from 1."""
    seen.get_by_text(f"frame {number} of ").first.wait_for(timeout=20_000)
    settle(page, seen)
    assert seen.get_by_role("slider").first.get_attribute("aria-valuenow") == str(number)
    return canvas(seen)


def follow(seen: Page, up: bool) -> float:
    """Move the slider and return the time until the page shows another answer, ms.

    A browser that draws on a busy processor may miss a key: then the slider is moved the other way.
    """
    for k in range(6):
        took = seen.evaluate(MOVED, up == (k % 2 == 0))
        if took is not None:
            return float(took)
    raise AssertionError("six moves of the slider changed nothing on the page")


MOVED = """async up => {
    const head = () => document.querySelector("h3").innerText
    const slider = document.querySelectorAll("[role=slider]")[1]
    const before = head(), began = performance.now()
    const changed = new Promise(done => {
        const look = () => { if (head() != before) { watch.disconnect(); done(performance.now() - began) } }
        const watch = new MutationObserver(look)
        watch.observe(document.body, {subtree: true, childList: true, characterData: true})
        setTimeout(() => { watch.disconnect(); done(null) }, 8000)
    })
    slider.dispatchEvent(new KeyboardEvent("keydown", {key: up ? "End" : "Home", bubbles: true}))
    return await changed
}"""


def answer(page: TuningPage) -> sp.Segmentation:
    assert page.session.answer is not None
    return page.session.answer.result


def settle(page: TuningPage, seen: Page) -> None:
    """Wait until the last answer is drawn."""
    assert page.worker.idle(60)
    seen.wait_for_timeout(2500)


def select(page: TuningPage, seen: Page, pixel: tuple[int, int]) -> None:
    """Click on a pixel (y, x) until it is selected: a browser that draws on a busy processor may miss a click."""
    for _ in range(6):
        click(page, seen, pixel)
        with contextlib.suppress(AssertionError):
            until(lambda: page.session.selected is not None, 5)
            return
    raise AssertionError(f"no click on {pixel} arrived")


def click(page: TuningPage, seen: Page, pixel: tuple[int, int]) -> None:
    """Click on a pixel (y, x) of the picture, where the page's camera sees it."""
    stand = page.space.stand
    assert stand is not None
    client = list(page.server.get_clients().values())[-1]
    height, width = stand.shape
    share = np.array([(pixel[1] + 0.5) / width - 0.5, (pixel[0] + 0.5) / height - 0.5, 0])
    away = stand.board + share * [*stand.size, 0] - client.camera.position
    box = seen.locator("canvas").first.bounding_box()
    assert box is not None
    scale = box["height"] / 2 / np.tan(client.camera.fov / 2)
    x, y = away[:2] / away[2] * scale
    seen.mouse.click(box["x"] + box["width"] / 2 + x, box["y"] + box["height"] / 2 + y)


def screenshot(seen: Page) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return np.asarray(cv2.imdecode(np.frombuffer(seen.screenshot(), np.uint8), cv2.IMREAD_COLOR), np.uint8)


def canvas(seen: Page) -> np.ndarray[Any, np.dtype[np.uint8]]:
    return screenshot(seen)[:, :900]


def changed(a: np.ndarray[Any, Any], b: np.ndarray[Any, Any]) -> float:
    """Return the share of pixels that differ clearly."""
    return float((np.abs(a.astype(int) - b).max(axis=2) > 40).mean())


def write(path: Path, picture: np.ndarray[Any, Any]) -> None:
    cv2.imwrite(str(path), picture, [cv2.IMWRITE_JPEG_QUALITY, 88])
    assert path.stat().st_size < 200_000
    assert picture.std() > 20
