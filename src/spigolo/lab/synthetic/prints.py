"""Random textures of fictitious packaging: fronts, sides and wraps, as RGB images (H, W, 3)."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np

from spigolo.lab.synthetic.textures import (
    Colour,
    Image,
    bar_code,
    box_panels,
    disc,
    fill,
    small_print,
    smooth_noise,
    write,
)

__all__ = ["Palette", "brushed_metal", "carton", "cover", "packet", "page", "palette", "wrap"]

Palette = tuple[Colour, Colour, Colour, Colour]
"""Colours of a packaging texture: background, second colour, accent colour and text colour."""

_BRANDS = ("SOLA", "VINTA", "ORBIT", "MONDO", "KIKO", "PRIMA", "LUMEN", "TERRA", "ZEST", "ALBA", "NOVA", "FINCH")
_HUES = (0.0, 0.01, 0.99, 0.03, 0.08, 0.12, 0.14, 0.3, 0.38, 0.5, 0.57, 0.6, 0.62, 0.66, 0.78, 0.93)
"""Hues of the packaging textures, 0..1, mostly red, yellow and blue."""
_GOODS = ("original", "extra fine", "family size", "no. 64", "classic", "fresh", "natural", "12 pieces", "light")


def palette(rng: np.random.Generator, dark: float = 0.35) -> Palette:
    """Return random colours that go well together. dark: number from 0 to 1. The probability of a dark background is 75
    % for dark = 1, and 0 % for dark = 0.
    """
    hue = _HUES[int(rng.integers(len(_HUES)))] + rng.normal(0, 0.015)
    kind = rng.uniform()
    if kind < 0.25:
        ground = _hsv(0.12, rng.uniform(0.0, 0.12), rng.uniform(0.82, 0.95))
    elif kind < 0.25 + 0.75 * dark:
        ground = _hsv(hue, rng.uniform(0.4, 0.85), rng.uniform(0.15, 0.45))
    else:
        ground = _hsv(hue, rng.uniform(0.45, 0.85), rng.uniform(0.5, 0.9))
    second = _hsv(hue + rng.normal(0.05, 0.05), rng.uniform(0.05, 0.45), rng.uniform(0.65, 0.95))
    accent = _hsv(_HUES[int(rng.integers(len(_HUES)))], rng.uniform(0.5, 0.85), rng.uniform(0.4, 0.9))
    ink = _hsv(hue, 0.4, 0.2) if sum(ground) > 420 else _hsv(0.12, 0.05, 0.95)
    return ground, second, accent, ink


def cover(size: tuple[int, int], colours: Palette, rng: np.random.Generator) -> Image:
    """Draw the front of a packet, book or card. size: height and width in pixels."""
    height, width = size
    ground, second, accent, ink = colours
    image = np.full((height, width, 3), ground, np.uint8)
    _backdrop(image, second, rng)
    middle = round(height * rng.uniform(0.5, 0.7))
    _picture(image, (width // 2, middle), round(0.33 * min(width, height)), colours, rng)
    band = round(height * rng.uniform(0.12, 0.3))
    if rng.uniform() < 0.6:
        tilt = round(height * rng.uniform(-0.06, 0.06))
        half = round(0.11 * height)
        fill(
            image,
            [(0, band - half + tilt), (width, band - half), (width, band + half), (0, band + half + tilt)],
            accent,
        )
    write(
        image, _any(_BRANDS, rng), (width // 2, band), (round(width * rng.uniform(0.6, 0.85)), max(3, width // 26)), ink
    )
    write(image, _any(_GOODS, rng), (width // 2, band + height // 7), (round(0.45 * width), max(1, width // 90)), ink)
    if rng.uniform() < 0.7:
        disc(image, (round(0.82 * width), round(0.88 * height)), round(0.1 * width), accent)
    return _worn(image, rng)


def carton(size_m: tuple[float, float, float], rng: np.random.Generator, colours: Palette | None = None) -> Image:
    """Draw the texture of a carton for `meshes.box`: front, side and top panel. size_m: width, depth and height."""
    colours = colours or palette(rng)
    x, y, z = (max(60, round(2400 * length)) for length in size_m)
    front = cover((z, x), colours, rng)
    side = np.full((z, y, 3), colours[0], np.uint8)
    side[: z // 4] = colours[1]
    small_print(
        side, (round(0.12 * y), round(0.32 * z), max(round(0.88 * y), round(0.12 * y) + 60), round(0.72 * z)), 9
    )
    bar_code(side, (round(0.2 * y), round(0.78 * z), round(0.8 * y), round(0.95 * z)))
    top = np.full((y, x, 3), colours[2] if rng.uniform() < 0.4 else colours[0], np.uint8)
    write(top, _any(_BRANDS, rng), (x // 2, y // 2), (round(0.6 * x), max(2, x // 60)), colours[3])
    return box_panels(front, _worn(side, rng), _worn(top, rng))


def wrap(rng: np.random.Generator, colours: Palette | None = None) -> Image:
    """Draw the wrap of a can, cup or bottle. The same front is drawn on two opposite sides of the wrap."""
    colours = colours or palette(rng)
    front = cover((640, 512), colours, rng)
    front[:24] = front[-24:] = colours[1]
    return np.hstack([front, front])


def packet(rng: np.random.Generator) -> Image:
    """Draw one side of a creased foil bag."""
    front = cover((700, 512), palette(rng), rng).astype(np.float64)
    creases = 14 * smooth_noise((700, 512), (9, 5), rng) + 8 * smooth_noise((700, 512), (26, 16), rng)
    return np.clip(front + creases[..., None], 0, 255).astype(np.uint8)


def page(size: tuple[int, int], rng: np.random.Generator) -> Image:
    """Draw a printed sheet of paper with a heading, lines of text, and sometimes a picture.

    size: height and width in pixels.
    """
    height, width = size
    paper = _hsv(rng.uniform(0.1, 0.16), rng.uniform(0.0, 0.25), rng.uniform(0.85, 0.98))
    image = np.full((height, width, 3), paper, np.uint8)
    y = round(0.1 * height)
    write(image, _any(_BRANDS, rng), (width // 3, y), (round(0.4 * width), max(2, width // 90)), (50, 48, 52))
    for line_y in range(y + height // 16, round(0.93 * height), max(6, height // 34)):
        if rng.uniform() < 0.85:
            end = round(width * rng.uniform(0.5, 0.92))
            cv2.line(image, (round(0.08 * width), line_y), (end, line_y), (110, 108, 112), max(1, height // 160))
    if rng.uniform() < 0.5:
        spot = round(0.65 * width), round(0.6 * height)
        _picture(image, spot, round(0.2 * width), palette(rng), rng)
    return image


def brushed_metal(rng: np.random.Generator, grey: float) -> Image:
    """Draw a texture of brushed metal. grey: mean grey level, 0..255."""
    streaks = 5 * smooth_noise((256, 256), (120, 4), rng) + 6 * smooth_noise((256, 256), (5, 4), rng)
    return np.clip(np.repeat((grey + streaks)[..., None], 3, axis=2), 0, 255).astype(np.uint8)


def _backdrop(image: Image, colour: Colour, rng: np.random.Generator) -> None:
    """Draw the background of a packaging texture: rays, slanted stripes, a second colour in the lower part, or no
    pattern.
    """
    height, width = image.shape[:2]
    kind = int(rng.integers(4))
    if kind == 0:
        for angle in np.arange(0, 2 * np.pi, np.pi / 9):
            ends = [
                (width / 2 + 2 * height * np.cos(a), height * 0.6 + 2 * height * np.sin(a))
                for a in (angle, angle + 0.17)
            ]
            fill(image, [(width / 2, 0.6 * height), *ends], colour)
    elif kind == 1:
        for x in range(-height, width, max(8, width // 6)):
            fill(
                image, [(x, height), (x + width // 14, height), (x + width // 14 + height, 0), (x + height, 0)], colour
            )
    elif kind == 2:
        image[round(height * rng.uniform(0.45, 0.75)) :] = colour


def _picture(image: Image, centre: tuple[int, int], radius_px: int, colours: Palette, rng: np.random.Generator) -> None:
    """Draw food on a plate, as on the package of a product."""
    _, second, accent, _ = colours
    axes = (radius_px, round(radius_px * rng.uniform(0.5, 1.0)))
    cv2.ellipse(image, centre, axes, 0, 0, 360, second, -1, cv2.LINE_AA)
    hue, size = rng.uniform(), max(3, round(radius_px * rng.uniform(0.1, 0.3)))
    for _ in range(int(rng.integers(8, 40))):
        turn, reach = rng.uniform(0, 2 * np.pi), 0.75 * np.sqrt(rng.uniform())
        spot = round(centre[0] + axes[0] * reach * np.cos(turn)), round(centre[1] + axes[1] * reach * np.sin(turn))
        tone = _hsv(hue + rng.normal(0, 0.04), rng.uniform(0.4, 0.9), rng.uniform(0.35, 0.95))
        if rng.uniform() < 0.5:
            disc(image, spot, size, tone)
        else:
            cv2.ellipse(image, spot, (size, size // 2 + 1), rng.uniform(0, 180), 0, 360, tone, -1, cv2.LINE_AA)
    cv2.ellipse(image, centre, axes, 0, 0, 360, accent, max(1, radius_px // 16), cv2.LINE_AA)


def _worn(image: Image, rng: np.random.Generator) -> Image:
    """Add uneven brightness to a texture."""
    uneven = 3.0 * smooth_noise(image.shape[:2], (4, 4), rng) + 1.5 * smooth_noise(image.shape[:2], (40, 40), rng)
    return np.clip(image + uneven[..., None], 0, 255).astype(np.uint8)


def _any(words: tuple[str, ...], rng: np.random.Generator) -> str:
    return words[int(rng.integers(len(words)))]


def _hsv(hue: float, saturation: float, value: float) -> Colour:
    red, green, blue = (round(255 * part) for part in colorsys.hsv_to_rgb(hue % 1.0, saturation, value))
    return red, green, blue
