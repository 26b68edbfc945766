"""Random textures of tables, shelves, bins, walls and floors, as RGB images (H, W, 3)."""

from __future__ import annotations

import colorsys
from collections.abc import Callable, Mapping

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic.textures import Colour, Image, plaster, smooth_noise, wood

__all__ = ["ROOM_SURFACES", "SURFACES", "surface"]

FloatArray = npt.NDArray[np.float64]

_SIZE_PX = 768
_WORDS = ("fresh", "No. 7", "coffee", "daily", "2 + 1", "lemon", "market", "garden", "best", "tea & co")


def surface(kind: str, rng: np.random.Generator) -> Image:
    """Draw a surface texture in random colours. kind: a key of `SURFACES` or `ROOM_SURFACES`."""
    return {**SURFACES, **ROOM_SURFACES}[kind](rng)


def _plain(rng: np.random.Generator) -> Image:
    """Draw paint, plastic or cardboard of one colour with slight variations."""
    return plaster(_colour(rng, rng.uniform(0.0, 0.55), rng.uniform(0.3, 0.95)), rng)[:, :256]


def _wood(rng: np.random.Generator) -> Image:
    """Draw wood of a random brightness."""
    pale = wood(rng, int(rng.integers(3, 10)), (_SIZE_PX, _SIZE_PX)).astype(np.float64)
    mean = pale.mean(axis=(0, 1))
    grain = rng.uniform(0.8, 2.0) * (pale / mean - 1) + 1
    stain = np.array(colorsys.hsv_to_rgb(rng.uniform(0.05, 0.1), rng.uniform(0.3, 0.6), rng.uniform(0.4, 0.9)))
    turned = np.swapaxes(grain, 0, 1) if rng.uniform() < 0.5 else grain
    return _to_image(255 * stain * turned)


def _cloth(rng: np.random.Generator) -> Image:
    """Draw coarse cloth with creases."""
    return _woven(np.array(_colour(rng, rng.uniform(0.1, 0.7), rng.uniform(0.4, 0.9)), np.float64), rng)


def _checker(rng: np.random.Generator) -> Image:
    """Draw tiles or a checked tablecloth."""
    a, b = _two_colours(rng)
    cells = 2 * int(rng.integers(3, 11))
    odd = np.arange(_SIZE_PX) * cells // _SIZE_PX % 2
    if rng.uniform() < 0.5:
        share = (odd[:, None] + odd) / 2.0
        return _woven(_mixed(a, b, share), rng)
    return _to_image(_mixed(a, b, (odd[:, None] ^ odd).astype(np.float64)) + _mottle(rng))


def _stripes(rng: np.random.Generator) -> Image:
    """Draw stripes of two or three colours with different widths."""
    a, b = _two_colours(rng)
    colours = np.array([a, b, _colour(rng, rng.uniform(0.1, 0.7), rng.uniform(0.3, 0.95))], np.float64)
    widths = np.maximum(rng.integers(1, 9, 60) * int(rng.integers(4, 16)), 4)
    line = np.repeat(np.arange(60) % int(rng.integers(2, 4)), widths)
    line = np.resize(line, _SIZE_PX)
    image = np.broadcast_to(colours[line], (_SIZE_PX, _SIZE_PX, 3))
    return _woven(np.swapaxes(image, 0, 1) if rng.uniform() < 0.5 else image, rng)


def _paint(rng: np.random.Generator) -> Image:
    """Draw paint in white, cream, beige or grey."""
    red, green, blue = colorsys.hsv_to_rgb(rng.uniform(0.05, 0.18), rng.uniform(0.0, 0.22), rng.uniform(0.6, 0.97))
    return plaster((round(255 * red), round(255 * green), round(255 * blue)), rng)[:, :256]


def _carpet(rng: np.random.Generator) -> Image:
    """Draw carpet in several tones of one colour."""
    ground = np.array(_colour(rng, rng.uniform(0.05, 0.35), rng.uniform(0.2, 0.6)), np.float64)
    yarn = smooth_noise((_SIZE_PX, _SIZE_PX), (_SIZE_PX // 5, _SIZE_PX // 5), rng)
    return _to_image(ground * (1 + rng.uniform(0.15, 0.45) * yarn[..., None]) + _mottle(rng))


def _print(rng: np.random.Generator) -> Image:
    """Draw a pattern of flowers, leaves, rings or words."""
    ground, ink = _two_colours(rng)
    inks = [ink, *(_colour(rng, rng.uniform(0.2, 0.9), rng.uniform(0.2, 0.95)) for _ in range(2))]
    image = np.full((_SIZE_PX, _SIZE_PX, 3), ground, np.uint8)
    motif = (_flower, _leaf, _ring, _word)[int(rng.integers(4))]
    pitch = int(rng.integers(70, 190))
    for row, y in enumerate(range(0, _SIZE_PX + pitch, pitch)):
        for x in range(-pitch // 2 * (row % 2), _SIZE_PX + pitch, pitch):
            shift = rng.integers(-pitch // 6, pitch // 6 + 1, 2)
            centre = (int(x + shift[0]), int(y + shift[1]))
            motif(image, centre, int(pitch * rng.uniform(0.2, 0.42)), inks[int(rng.integers(3))], rng)
    return _to_image(image + _mottle(rng))


def _terrazzo(rng: np.random.Generator) -> Image:
    """Draw a pale stone floor with dark and bright chips."""
    ground = np.array(_colour(rng, rng.uniform(0.0, 0.2), rng.uniform(0.55, 0.9)), np.float64)
    cells = int(rng.integers(60, 160))
    fine = smooth_noise((_SIZE_PX, _SIZE_PX), (cells, cells), rng)
    chips = np.clip(8 * (np.abs(fine) - rng.uniform(0.9, 1.3)), 0, 1) * np.sign(fine)
    return _to_image(ground + rng.uniform(15, 50) * chips[..., None] + _mottle(rng))


SURFACES: Mapping[str, Callable[[np.random.Generator], Image]] = {
    "plain": _plain,
    "wood": _wood,
    "cloth": _cloth,
    "checker": _checker,
    "stripes": _stripes,
    "print": _print,
    "terrazzo": _terrazzo,
}
"""Functions that draw textures of tables, shelves and bins, indexed by the name of the texture."""

ROOM_SURFACES: Mapping[str, Callable[[np.random.Generator], Image]] = {"paint": _paint, "carpet": _carpet}
"""Functions that draw additional textures of walls and floors, indexed by the name of the texture."""


def _flower(image: Image, centre: tuple[int, int], radius_px: int, ink: Colour, rng: np.random.Generator) -> None:
    first = rng.uniform(0, 2 * np.pi)
    for k in range(6):
        turn = first + k * np.pi / 3
        petal = (round(centre[0] + 0.6 * radius_px * np.cos(turn)), round(centre[1] + 0.6 * radius_px * np.sin(turn)))
        cv2.circle(image, petal, round(0.4 * radius_px), ink, -1, cv2.LINE_AA)
    cv2.circle(image, centre, round(0.3 * radius_px), (236, 196, 70), -1, cv2.LINE_AA)


def _leaf(image: Image, centre: tuple[int, int], radius_px: int, ink: Colour, rng: np.random.Generator) -> None:
    axes = (radius_px, round(0.4 * radius_px))
    cv2.ellipse(image, centre, axes, rng.uniform(0, 180), 0, 360, ink, -1, cv2.LINE_AA)


def _ring(image: Image, centre: tuple[int, int], radius_px: int, ink: Colour, rng: np.random.Generator) -> None:
    cv2.circle(image, centre, round(0.8 * radius_px), ink, round(radius_px * rng.uniform(0.1, 0.5)), cv2.LINE_AA)


def _word(image: Image, centre: tuple[int, int], radius_px: int, ink: Colour, rng: np.random.Generator) -> None:
    text = _WORDS[int(rng.integers(len(_WORDS)))]
    corner = (centre[0] - radius_px, centre[1] + radius_px // 4)
    cv2.putText(image, text, corner, cv2.FONT_HERSHEY_TRIPLEX, radius_px / 45, ink, 2 + radius_px // 20, cv2.LINE_AA)


def _woven(colours: FloatArray, rng: np.random.Generator) -> Image:
    """Add threads and folds of cloth to a colour (3,) or to a colour image (H, W, 3)."""
    along = np.sin(2 * np.pi * np.arange(_SIZE_PX) / rng.uniform(5, 9))
    threads = 3.5 * along[:, None] * along + _mottle(rng)[..., 0]
    folds = rng.uniform(1, 5) * smooth_noise((_SIZE_PX, _SIZE_PX), (3, 3), rng)
    return _to_image(colours + (threads + folds)[..., None])


def _mottle(rng: np.random.Generator) -> FloatArray:
    """Return random brightness variations (H, W, 1) with fine and coarse structure."""
    size = (_SIZE_PX, _SIZE_PX)
    return (1.5 * smooth_noise(size, (200, 200), rng) + 1.5 * smooth_noise(size, (6, 6), rng))[..., None]


def _mixed(a: Colour, b: Colour, share: FloatArray) -> FloatArray:
    low, high = np.array(a, np.float64), np.array(b, np.float64)
    return np.asarray(low + share[..., None] * (high - low))


def _two_colours(rng: np.random.Generator) -> tuple[Colour, Colour]:
    """Return a pale and a darker random colour, in random order."""
    pale = _colour(rng, rng.uniform(0.0, 0.35), rng.uniform(0.75, 0.97))
    deep = _colour(rng, rng.uniform(0.3, 0.85), rng.uniform(0.25, 0.7))
    return (pale, deep) if rng.uniform() < 0.6 else (deep, pale)


def _colour(rng: np.random.Generator, saturation: float, value: float) -> Colour:
    red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(rng.uniform(), saturation, value))
    return red, green, blue


def _to_image(values: npt.NDArray[np.float64]) -> Image:
    return np.clip(np.round(values), 0, 255).astype(np.uint8)
