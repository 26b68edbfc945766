"""A tuning session without a page: frames, values, corrections by hand, and the answer to them."""

from __future__ import annotations

import threading
import time
import warnings
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, Protocol, runtime_checkable

import cv2
import numpy as np

from spigolo import clock
from spigolo.errors import FileError, FrameError, SpigoloError
from spigolo.frames.files import write_bytes
from spigolo.frames.frame import Frame, check_frame
from spigolo.kernels.workspace import Workspace
from spigolo.objects.facts import RegionFacts
from spigolo.objects.segmentation import ObjectMask, RejectedRegion, Segmentation
from spigolo.pipeline import Trace, trace
from spigolo.settings.config import Config
from spigolo.settings.presets import OBJECTS, PRESETS
from spigolo.view.tuning_values import SHOWN, Values, nearest_preset

Pixel = tuple[int, int]
REMEMBERED = 30
"""Frames of a stream that can be looked at again."""


@runtime_checkable
class Numbered(Protocol):
    """Frames that are read by their number, from 0: a list, or a source whose number of frames is known."""

    def __len__(self) -> int: ...

    def __getitem__(self, number: int, /) -> Frame: ...


class Reel:
    """Frames that are looked at one after the other. Those with a number are read when they are shown.

    A stream without an end gives its next frame when it is asked. Its last 30 frames are remembered.
    """

    def __init__(self, frames: Iterable[Frame] | Numbered) -> None:
        self._sequence = frames if isinstance(frames, Numbered) else None
        self._read: tuple[int, Frame] | None = None
        self._stream: Iterator[Frame] = iter(()) if isinstance(frames, Numbered) else iter(frames)
        self._seen: deque[Frame] = deque(maxlen=REMEMBERED)
        self._back = 0
        self.position = 0
        """Number of the frame, from 0."""
        if self._sequence is None:
            self.move(1)
            self.position = 0
        elif not len(self._sequence):
            raise FrameError("expected at least one frame, got none")

    @property
    def count(self) -> int | None:
        """Number of frames. None if it is not known."""
        return None if self._sequence is None else len(self._sequence)

    def current(self) -> Frame:
        """Return the frame. Raises SpigoloError for a frame that cannot be read."""
        frame = self._seen[-1 - self._back] if self._sequence is None else self._numbered(self._sequence)
        check_frame(frame)
        return frame

    def move(self, step: int) -> bool:
        """Go to the next (1) or the previous (-1) frame, and return whether there is one."""
        if self._sequence is not None:
            return self.go(self.position + step)
        return self._move_back() if step < 0 else self._move_on()

    def go(self, position: int) -> bool:
        """Go to a frame by its number, from 0, and return whether that moves. A stream without a count stays."""
        if self._sequence is None:
            return False
        target = min(max(position, 0), len(self._sequence) - 1)
        moved, self.position = target != self.position, target
        return moved

    def _numbered(self, frames: Numbered) -> Frame:
        """Return the frame at the position. It is read once while the reel stands there."""
        position = self.position
        if self._read is None or self._read[0] != position:
            self._read = position, frames[position]
        return self._read[1]

    def _move_back(self) -> bool:
        moved = self._back + 1 < len(self._seen)
        self._back += moved
        self.position -= moved
        return moved

    def _move_on(self) -> bool:
        if self._back:
            self._back -= 1
        else:
            frame = next(self._stream, None)
            if frame is None:
                if not self._seen:
                    raise FrameError("expected at least one frame, got none")
                return False
            self._seen.append(frame)
        self.position += 1
        return True


@dataclass(frozen=True, slots=True)
class Correction:
    """One correction by hand. It names regions by a pixel, so that it holds for other parameters too."""

    action: Literal["keep", "drop", "merge"]
    """Name of the method of `Segmentation`."""
    pixels: tuple[Pixel, ...]
    """A pixel (y, x) of each region."""

    def on(self, result: Segmentation) -> Segmentation:
        """Return the corrected answer."""
        regions = [result.at(pixel) for pixel in self.pixels]
        if self.action == "merge":
            return result.merge(*regions)
        return result.keep(regions[0]) if self.action == "keep" else result.drop(regions[0])


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """The answer of one run."""

    position: int
    """Number of the frame, from 0."""
    run: Trace
    """Every stage."""
    result: Segmentation
    """The segmentation with the corrections."""
    wall_s: float
    """Time of the run, s."""
    stages_s: dict[str, float]
    """Wall time of each stage, s, longest first."""
    notes: tuple[str, ...]
    """Warnings of the run."""


class Session:
    """Frames, the values of all parameters, corrections by hand, and the answer. `run` segments the frame.

    frames: a frame or any iterable of frames. config: the configuration to start from.
    Methods may be called from several threads.
    """

    def __init__(self, frames: Frame | Iterable[Frame] | Numbered, config: Config = OBJECTS) -> None:
        self.reel = Reel([frames] if isinstance(frames, Frame) else frames)
        self.presets = {name: PRESETS[name] for name in SHOWN}
        self.preset = next((n for n, p in self.presets.items() if p.digest == config.digest), f"{config.name} (yours)")
        self.presets.setdefault(self.preset, config)
        self.values = Values(config)
        self.corrections: list[Correction] = []
        self.selected: Pixel | None = None
        self.answer: Answer | None = None
        self._lock = threading.RLock()
        self._workspace = Workspace()

    def set(self, key: str, value: Any) -> bool:
        """Set a parameter by its dotted name, and return whether that changes it. None switches a rule off."""
        with self._lock:
            return self.values.set(key, value)

    def load(self, preset: str) -> None:
        """Take all values of a preset."""
        with self._lock:
            self.preset = preset
            self.values.load(self.presets[preset])

    def run(self) -> Answer:
        """Segment the frame with the values of now. Raises SpigoloError if they do not go together."""
        with self._lock:
            config, frame, position = self.values.config(), self.reel.current(), self.reel.position
        began = time.perf_counter()
        with warnings.catch_warnings(record=True) as caught, clock.stopwatch() as times:
            warnings.simplefilter("always")
            run = trace(frame, config, workspace=self._workspace)
        wall_s = time.perf_counter() - began
        spent = {name: sum(lap.wall_s for lap in laps) for name, laps in times.items()}
        stages = dict(sorted(spent.items(), key=lambda item: -item[1]))
        with self._lock:
            notes = tuple(str(warning.message) for warning in caught)
            self.answer = Answer(position, run, self._corrected(run.segmentation), wall_s, stages, notes)
            return self.answer

    def at(self, pixel: Pixel | None) -> ObjectMask | RejectedRegion | None:
        """Return the object or rejected region at a pixel. None without an answer there."""
        with self._lock:
            if self.answer is None or pixel is None:
                return None
            height, width = self.answer.result.labels.shape
            inside = 0 <= pixel[0] < height and 0 <= pixel[1] < width
            return self.answer.result.at(pixel) if inside else None

    def correct(self, action: Literal["keep", "drop", "merge"], *pixels: Pixel) -> None:
        """Keep, drop or merge what lies at pixels (y, x). It holds for this frame, with other values too."""
        with self._lock:
            self.corrections.append(Correction(action, pixels))
            self._correct_again()

    def undo(self, everything: bool = False) -> None:
        """Take back the last correction, or all."""
        with self._lock:
            self.corrections = [] if everything else self.corrections[:-1]
            self._correct_again()

    def move(self, step: int) -> bool:
        """Go to the next (1) or the previous (-1) frame, and return whether there is one. Corrections stay behind."""
        return self._left(self.reel.move(step))

    def go(self, position: int) -> bool:
        """Go to a frame by its number, from 0, and return whether that moves. Corrections stay behind."""
        return self._left(self.reel.go(position))

    def _left(self, moved: bool) -> bool:
        with self._lock:
            if moved:
                self.corrections, self.selected = [], None
        return moved

    def toml(self) -> str:
        """Return the values as TOML: the preset they start from, and what differs."""
        config = self.values.config()
        return config.to_toml(self.presets[self.preset].name if self.preset in SHOWN else nearest_preset(config))

    def save(self, path: Path) -> None:
        """Write the values to a TOML file, which `--preset` reads. Raises FileError for another kind of name."""
        if path.suffix.lower() != ".toml" or not path.stem:
            raise FileError(f"expected a name that ends in .toml, got {path.name!r}")
        write_bytes(path, self.toml().encode())

    def _correct_again(self) -> None:
        if self.answer is not None:
            self.answer = replace(self.answer, result=self._corrected(self.answer.run.segmentation))

    def _corrected(self, result: Segmentation) -> Segmentation:
        for correction in self.corrections:
            try:
                result = correction.on(result)
            except (SpigoloError, IndexError):  # as of a merge of one region with itself by now
                continue
        return result


def inner_pixel(region: RegionFacts) -> Pixel:
    """Return the pixel (y, x) of a region that lies deepest inside."""
    y0, x0, y1, x1 = region.box_px
    mask = np.pad(region.mask[y0:y1, x0:x1], 1).astype(np.uint8)
    inside = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    y, x = np.unravel_index(int(inside.argmax()), inside.shape)
    return int(y) - 1 + y0, int(x) - 1 + x0
