"""State of a tuning session: frames, parameter values, corrections by hand, and the latest result. The module does not
use viser, the package that shows the web page.
"""

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
from spigolo.frames.roi import Roi
from spigolo.kernels.workspace import Workspace
from spigolo.objects.facts import RegionFacts
from spigolo.objects.segmentation import ObjectMask, RejectedRegion, Segmentation
from spigolo.pipeline import Trace, trace
from spigolo.settings.config import Config
from spigolo.settings.presets import OBJECTS, PRESETS
from spigolo.view.tuning_values import SHOWN, Values, nearest_preset

Pixel = tuple[int, int]
REMEMBERED = 30
"""Number of past frames of a stream that are kept in memory, so that the user can go back to them."""


@runtime_checkable
class Numbered(Protocol):
    """Sequence of frames of known length, such as a list of frames."""

    def __len__(self) -> int: ...

    def __getitem__(self, number: int, /) -> Frame: ...


class Reel:
    """Position in a sequence or a stream of frames. The user moves forwards and backwards between frames.

    A frame of a sequence is read when it becomes the current frame. The last 30 frames of a stream are kept in memory.
    """

    def __init__(self, frames: Iterable[Frame] | Numbered) -> None:
        self._sequence = frames if isinstance(frames, Numbered) else None
        self._read: tuple[int, Frame] | None = None
        self._stream: Iterator[Frame] = iter(()) if isinstance(frames, Numbered) else iter(frames)
        self._seen: deque[Frame] = deque(maxlen=REMEMBERED)
        self._back = 0
        self.position = 0
        """Number of the current frame, from 0."""
        if self._sequence is None:
            self.move(1)
            self.position = 0
        elif not len(self._sequence):
            raise FrameError("expected at least one frame, got none")

    @property
    def count(self) -> int | None:
        """Number of frames, or None for a stream, which has no known length."""
        return None if self._sequence is None else len(self._sequence)

    def current(self) -> Frame:
        """Return the current frame. Raises SpigoloError if the frame cannot be read."""
        frame = self._seen[-1 - self._back] if self._sequence is None else self._numbered(self._sequence)
        check_frame(frame)
        return frame

    def move(self, step: int) -> bool:
        """Go to the next (step 1) or the previous frame (step -1). Return False if no such frame exists."""
        if self._sequence is not None:
            return self.go(self.position + step)
        return self._move_back() if step < 0 else self._move_on()

    def go(self, position: int) -> bool:
        """Go to a frame by its number, counted from 0. Return True if the current frame has changed. In a stream, the
        current frame does not change, and the result is False.
        """
        if self._sequence is None:
            return False
        target = min(max(position, 0), len(self._sequence) - 1)
        moved, self.position = target != self.position, target
        return moved

    def _numbered(self, frames: Numbered) -> Frame:
        """Return the frame at the current position. The frame is read again only if the position has changed."""
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
    """Correction of a segmentation result by hand.

    Each corrected region is identified by one of its pixels, so that the correction can be repeated after a change of
    parameters.
    """

    action: Literal["keep", "drop", "merge"]
    """Kind of the correction, which is also the name of a method of `Segmentation`."""
    pixels: tuple[Pixel, ...]
    """One pixel (y, x) of each region that is corrected."""

    def on(self, result: Segmentation) -> Segmentation:
        """Apply the correction to a segmentation result, and return the corrected result."""
        regions = [result.at(pixel) for pixel in self.pixels]
        if self.action == "merge":
            return result.merge(*regions)
        return result.keep(regions[0]) if self.action == "keep" else result.drop(regions[0])


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """Result of one segmentation on the tuning page."""

    position: int
    """Number of the segmented frame, from 0."""
    run: Trace
    """Results of all stages."""
    result: Segmentation
    """Segmentation result after the corrections by hand."""
    wall_s: float
    """Wall time of the segmentation, in seconds."""
    stages_s: dict[str, float]
    """Wall time of each stage in seconds, indexed by the name of the stage. The longest time comes first."""
    notes: tuple[str, ...]
    """Warning messages of the segmentation."""


class Session:
    """Tuning session: frames, values of all parameters, corrections by hand, and the latest result.

    The methods may be called from several threads.

    - frames: a frame or any iterable of frames.
    - config: configuration with the initial values of the parameters.
    - roi: region of interest in all frames, as for `segment`.
    """

    def __init__(
        self, frames: Frame | Iterable[Frame] | Numbered, config: Config = OBJECTS, roi: Roi | None = None
    ) -> None:
        self.roi = roi
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
        """Set a parameter by its key. Return True if its value changes. The value None switches a rule off."""
        with self._lock:
            return self.values.set(key, value)

    def load(self, preset: str) -> None:
        """Set all parameters to the values of a preset."""
        with self._lock:
            self.preset = preset
            self.values.load(self.presets[preset])

    def run(self) -> Answer:
        """Segment the current frame with the current parameter values.

        Raises SpigoloError if the parameter values contradict each other.
        """
        with self._lock:
            config, frame, position = self.values.config(), self.reel.current(), self.reel.position
        began = time.perf_counter()
        with warnings.catch_warnings(record=True) as caught, clock.stopwatch() as times:
            warnings.simplefilter("always")
            run = trace(frame, config, self.roi, self._workspace)
        wall_s = time.perf_counter() - began
        spent = {name: sum(lap.wall_s for lap in laps) for name, laps in times.items()}
        stages = dict(sorted(spent.items(), key=lambda item: -item[1]))
        with self._lock:
            notes = tuple(str(warning.message) for warning in caught)
            self.answer = Answer(position, run, self._corrected(run.segmentation), wall_s, stages, notes)
            return self.answer

    def at(self, pixel: Pixel | None) -> ObjectMask | RejectedRegion | None:
        """Return the object or rejected region at a pixel (y, x). Return None if the pixel lies outside the image, or
        if no result exists yet.
        """
        with self._lock:
            if self.answer is None or pixel is None:
                return None
            height, width = self.answer.result.labels.shape
            inside = 0 <= pixel[0] < height and 0 <= pixel[1] < width
            return self.answer.result.at(pixel) if inside else None

    def correct(self, action: Literal["keep", "drop", "merge"], *pixels: Pixel) -> None:
        """Keep, drop or merge the objects or regions at pixels (y, x).

        The correction is applied again after each change of parameters. When another frame becomes the current frame,
        all corrections are deleted.
        """
        with self._lock:
            self.corrections.append(Correction(action, pixels))
            self._correct_again()

    def undo(self, everything: bool = False) -> None:
        """Undo the last correction by hand. With `everything=True`, undo all corrections."""
        with self._lock:
            self.corrections = [] if everything else self.corrections[:-1]
            self._correct_again()

    def move(self, step: int) -> bool:
        """Go to the next (step 1) or the previous frame (step -1), and delete all corrections by hand.

        Returns False if no such frame exists.
        """
        return self._left(self.reel.move(step))

    def go(self, position: int) -> bool:
        """Go to a frame by its number, from 0, and delete all corrections by hand.

        Returns True if the current frame changes.
        """
        return self._left(self.reel.go(position))

    def _left(self, moved: bool) -> bool:
        with self._lock:
            if moved:
                self.corrections, self.selected = [], None
        return moved

    def toml(self) -> str:
        """Return the parameter values as TOML text. The text contains the name of a preset and all values that differ
        from this preset.
        """
        config = self.values.config()
        return config.to_toml(self.presets[self.preset] if self.preset in SHOWN else nearest_preset(config))

    def save(self, path: Path) -> None:
        """Write the parameter values to a TOML file that the option `--preset` reads. Raises FileError if the name does
        not end in .toml.
        """
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
            except (SpigoloError, IndexError):  # for example, two regions to merge are now one region
                continue
        return result


def inner_pixel(region: RegionFacts) -> Pixel:
    """Return the pixel (y, x) of a region that is farthest from its outline."""
    y0, x0, y1, x1 = region.box_px
    mask = np.pad(region.mask[y0:y1, x0:x1], 1).astype(np.uint8)
    inside = cv2.distanceTransform(mask, cv2.DIST_L2, 3)
    y, x = np.unravel_index(int(inside.argmax()), inside.shape)
    return int(y) - 1 + y0, int(x) - 1 + x0
