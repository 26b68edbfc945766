"""Line charts with two logarithmic axes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import cv2
import numpy as np

from spigolo.frames.frame import Color
from spigolo.objects.drawing import FONT, INK

WIDTH, HEIGHT, FINER = 1120, 720, 3
"""Width and height of the chart in pixels, and a scale factor. The chart is drawn larger by the scale factor and then
reduced, so that lines are smooth.
"""
LEFT, RIGHT, TOP, BOTTOM = 90, 300, 80, 110
"""Margins of the chart in pixels. The names of the curves are written in the right margin."""
COLORS = ((31, 98, 184), (214, 92, 20), (110, 110, 110), (30, 140, 90), (150, 60, 150), (190, 150, 0))
GRID, GUIDE, PALE = (229, 229, 229), (170, 170, 170), (95, 95, 95)
LINE_PX = 24

Tint = tuple[int, int, int]
Point = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Curve:
    """Curve in a chart.

    - name: one or two lines of text.
    - x: positive values in ascending order.
    - y: positive value for each x.
    """

    name: str
    x: Sequence[float]
    y: Sequence[float]


@dataclass(frozen=True, slots=True)
class Axis:
    """Logarithmic axis of a chart. The axis begins at the value `low` and the pixel position `start`, and ends at the
    value `high` and the pixel position `end`.
    """

    low: float
    high: float
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """Return the position of a value along the axis in pixels."""
        share = math.log(value / self.low) / math.log(self.high / self.low)
        return self.start + share * (self.end - self.start)

    @property
    def ticks(self) -> list[float]:
        """Return the values of the ticks: 1, 2 and 5 times each power of ten within the range of the axis."""
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        every = [float(f"{digit}e{decade}") for decade in decades for digit in (1, 2, 5)]
        return [tick for tick in every if self.low <= tick <= self.high]


def log_log(curves: Sequence[Curve], title: str, x_label: str, y_label: str, note: str = "") -> Color:
    """Draw a chart (H, W, 3) with two logarithmic axes.

    A dashed line with slope 1 passes through the first point of the first curve. On the dashed line, y is proportional
    to x.
    """
    x = _axis([v for c in curves for v in c.x], LEFT, WIDTH - RIGHT)
    y = _axis([v for c in curves for v in c.y], HEIGHT - BOTTOM, TOP)
    picture = np.full((HEIGHT * FINER, WIDTH * FINER, 3), 255, np.uint8)
    _draw_grid(picture, x, y)
    _draw_guide(picture, curves[0], x, y)
    tints = [COLORS[k % len(COLORS)] for k in range(len(curves))]
    for curve, tint in zip(curves, tints, strict=True):
        _draw_curve(picture, [(x(a), y(b)) for a, b in zip(curve.x, curve.y, strict=True)], tint)
    _draw_names(picture, curves, tints, y)
    _text(picture, title, (LEFT, TOP - 42), 0.72, INK, weight=2)
    _text(picture, y_label, (LEFT, TOP - 16), 0.48, PALE)
    _text(picture, x_label, (LEFT, HEIGHT - BOTTOM + 52), 0.48, PALE)
    _text(picture, note, (LEFT, HEIGHT - 22), 0.42, PALE)
    return np.asarray(cv2.resize(picture, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA), np.uint8)


def _axis(values: list[float], start: float, end: float) -> Axis:
    """Return an axis that covers all values, with a margin at both ends."""
    low, high = min(values), max(values)
    room = max((high / low) ** 0.06, 1.15)
    return Axis(low / room, high * room, start, end)


def _draw_grid(picture: Color, x: Axis, y: Axis) -> None:
    for tick in x.ticks:
        _line(picture, (x(tick), y.start), (x(tick), y.end), GRID)
        _text(picture, f"{tick:g}", (x(tick), y.start + 24), 0.46, INK, align=0.5)
    for tick in y.ticks:
        _line(picture, (x.start, y(tick)), (x.end, y(tick)), GRID)
        _text(picture, f"{tick:g}", (x.start - 10, y(tick) + 5), 0.46, INK, align=1.0)
    _line(picture, (x.start, y.start), (x.end, y.start), PALE)
    _line(picture, (x.start, y.start), (x.start, y.end), PALE)


def _draw_guide(picture: Color, curve: Curve, x: Axis, y: Axis) -> None:
    """Draw a dashed line with slope 1 through the first point of a curve. The line crosses the whole chart."""
    factor = curve.y[0] / curve.x[0]
    low, high = max(x.low, y.low / factor), min(x.high, y.high / factor)
    ends = np.array([(x(low), y(low * factor)), (x(high), y(high * factor))])
    length = float(np.hypot(*(ends[1] - ends[0])))
    for begin in np.arange(0, length, 12):
        a, b = (ends[0] + (ends[1] - ends[0]) * min(s, length) / length for s in (begin, begin + 6))
        _line(picture, (a[0], a[1]), (b[0], b[1]), GUIDE, width=1.5)


def _draw_curve(picture: Color, points: list[Point], tint: Tint) -> None:
    for a, b in pairwise(points):
        _line(picture, a, b, tint, width=2.4)
    for px, py in points:
        center = round(px * FINER), round(py * FINER)
        cv2.circle(picture, center, round(5.5 * FINER), (255, 255, 255), -1, cv2.LINE_AA)
        cv2.circle(picture, center, round(4.5 * FINER), tint, -1, cv2.LINE_AA)


def _draw_names(picture: Color, curves: Sequence[Curve], tints: Sequence[Tint], y: Axis) -> None:
    """Write the name of each curve next to its last point. Names do not overlap."""
    free = float(TOP)
    for curve, tint in sorted(zip(curves, tints, strict=True), key=lambda pair: y(pair[0].y[-1])):
        lines = curve.name.split("\n")
        at = max(y(curve.y[-1]) + 5, free)
        for k, line in enumerate(lines):
            _text(picture, line, (WIDTH - RIGHT + 12, at + 20 * k), 0.52 if k == 0 else 0.42, tint, weight=2 - k)
        free = at + LINE_PX * len(lines)


def _line(picture: Color, a: Point, b: Point, tint: Tint, width: float = 1.0) -> None:
    ends = [(round(px * FINER), round(py * FINER)) for px, py in (a, b)]
    cv2.line(picture, ends[0], ends[1], tint, round(width * FINER), cv2.LINE_AA)


def _text(picture: Color, text: str, at: Point, size: float, tint: Tint, align: float = 0.0, weight: int = 1) -> None:
    """Write a text at the position `at` in pixels.

    align: 0 if the text begins at the position `at`, 0.5 if it is centred at `at`, and 1 if it ends at `at`.
    """
    thickness = round((0.6 + 0.5 * weight) * FINER)
    (width, _), _ = cv2.getTextSize(text, FONT, size * FINER, thickness)
    corner = round(at[0] * FINER - align * width), round(at[1] * FINER)
    cv2.putText(picture, text, corner, FONT, size * FINER, tint, thickness, cv2.LINE_AA)
