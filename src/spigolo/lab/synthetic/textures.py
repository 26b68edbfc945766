"""Procedural textures of the demo scene: wood, plaster and fictitious packaging, as RGB images (H, W, 3)."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import cv2
import numpy as np
import numpy.typing as npt

__all__ = [
    "bar_code",
    "beach_ball",
    "box_panels",
    "can_label",
    "cereal_box",
    "disc",
    "fill",
    "flashlight_bands",
    "glazed",
    "milk_carton",
    "milk_roof",
    "mug_glaze",
    "plain_card",
    "plaster",
    "small_print",
    "smooth_noise",
    "tea_box",
    "wood",
    "write",
]

Image = npt.NDArray[np.uint8]
Colour = tuple[int, int, int]

_WHITE: Colour = (246, 243, 236)
_ROUND_FONT = cv2.FONT_HERSHEY_DUPLEX


def smooth_noise(size: tuple[int, int], cells: tuple[int, int], rng: np.random.Generator) -> npt.NDArray[np.float64]:
    """Return smooth noise (H, W) with values of about -2 to 2.

    Parameters
    ----------
    size
        Height and width of the returned noise in pixels.
    cells
        Numbers of rows and columns of cells in a grid of random values. The noise is interpolated in the grid, so more
        cells give finer noise.
    rng
        Random number generator.

    """
    grid = rng.standard_normal((cells[0] + 1, cells[1] + 1)).astype(np.float32)
    return cv2.resize(grid, (size[1], size[0]), interpolation=cv2.INTER_CUBIC).astype(np.float64)


def wood(rng: np.random.Generator, planks: int = 7, size: tuple[int, int] = (1024, 2048)) -> Image:
    """Draw planks of pale oak with fine joints. size: height and width in pixels."""
    height, width = size
    image = np.empty((height, width, 3))
    edges = np.linspace(0, height, planks + 1).astype(int)
    for top, bottom in pairwise(edges):
        size = (bottom - top, width)
        across = np.linspace(0, 1, size[0])[:, None]
        warp = smooth_noise(size, (2, 5), rng)
        rings = np.sin(2 * np.pi * (rng.uniform(2, 4) * across + 0.8 * warp + rng.uniform()))
        fibre = smooth_noise(size, (70, 24), rng) + 0.6 * smooth_noise(size, (size[0] // 2, 90), rng)
        tone = rng.normal(0, 5) + 5.5 * rings + 3.5 * fibre + 4 * smooth_noise(size, (1, 3), rng)
        image[top:bottom] = np.array([203, 170, 130]) + tone[..., None] * np.array([1.0, 1.05, 1.1])
        image[top : top + 2] -= 34
    return _to_image(image)


def plaster(colour: Colour, rng: np.random.Generator) -> Image:
    """Draw a painted surface of one colour with slight variations."""
    size = (256, 512)
    mottle = 0.8 * smooth_noise(size, (5, 9), rng) + 1.2 * smooth_noise(size, (60, 110), rng)
    return _to_image(np.array(colour) + mottle[..., None])


def plain_card(colour: Colour) -> Image:
    """Draw a surface of one colour."""
    return np.full((8, 24, 3), colour, dtype=np.uint8)


def glazed(colour: Colour, rim: Colour, rim_share: float) -> Image:
    """Draw glaze of one colour with a band of another colour at the rim.

    rim_share: height of the band as a share of the image height.
    """
    image = np.full((256, 8, 3), colour, dtype=np.uint8)
    image[: round(256 * rim_share)] = rim
    return image


def box_panels(front: Image, side: Image, top: Image) -> Image:
    """Combine three images into the texture of a box for `meshes.box`."""
    return np.hstack([cv2.resize(panel, (512, 512), interpolation=cv2.INTER_AREA) for panel in (front, side, top)])


def cereal_box() -> Image:
    """Draw the texture of a red cereal box."""
    red, yellow, navy = (206, 38, 36), (252, 198, 38), (26, 46, 104)
    front = np.full((1000, 680, 3), red, dtype=np.uint8)
    for k in range(20):
        angle = np.radians(18 * k + np.array([-3.6, 3.6]))
        far = np.column_stack([340 + 900 * np.cos(angle), 690 + 900 * np.sin(angle)])
        fill(front, [(340, 690), *far], (224, 66, 40))
    fill(front, [(0, 90), (680, 40), (680, 300), (0, 350)], yellow)
    fill(front, [(0, 350), (680, 300), (680, 318), (0, 368)], _WHITE)
    write(front, "CRUNCH", (340, 205), (490, 20), navy)
    write(front, "OAT RINGS", (340, 420), (430, 9), _WHITE)
    _bowl_of_rings(front, (340, 690), 240)
    disc(front, (570, 920), 84, yellow)
    write(front, "NEW", (570, 920), (120, 7), red)
    write(front, "450 g", (120, 950), (150, 4), _WHITE)
    side = np.full((1000, 220, 3), red, dtype=np.uint8)
    side[60:330] = yellow
    write(side, "OAT", (110, 150), (150, 9), navy)
    write(side, "RINGS", (110, 250), (170, 7), navy)
    small_print(side, (24, 390, 196, 800), 13)
    bar_code(side, (44, 850, 176, 960))
    top = np.full((220, 680, 3), yellow, dtype=np.uint8)
    top[150:] = red
    write(top, "CRUNCH", (340, 80), (360, 12), navy)
    return box_panels(front, side, top)


def tea_box() -> Image:
    """Draw the texture of a green tea box."""
    green, dark, gold = (72, 142, 84), (22, 74, 52), (226, 178, 74)
    front = np.full((900, 680, 3), green, dtype=np.uint8)
    for x in range(-900, 700, 90):
        fill(front, [(x, 900), (x + 34, 900), (x + 934, 0), (x + 900, 0)], (92, 162, 98))
    disc(front, (340, 390), 262, gold)
    disc(front, (340, 390), 242, (248, 240, 214))
    write(front, "TEA", (340, 345), (300, 24), dark)
    for k, turn in enumerate((-40, 0, 40)):
        centre = (250 + 90 * k, 510 - 26 * (k == 1))
        cv2.ellipse(front, centre, (24, 62), turn, 0, 360, green, -1, cv2.LINE_AA)
        cv2.ellipse(front, centre, (4, 56), turn, 0, 360, dark, -1, cv2.LINE_AA)
    front[716:840] = dark
    front[706:716] = front[840:850] = gold
    write(front, "40 BAGS", (340, 778), (380, 9), _WHITE)
    side = np.full((900, 300, 3), dark, dtype=np.uint8)
    side[60:70] = side[706:716] = side[840:850] = gold
    side[716:840] = green
    write(side, "TEA", (150, 180), (210, 14), gold)
    small_print(side, (40, 290, 260, 640), 10)
    top = np.full((300, 680, 3), green, dtype=np.uint8)
    top[120:180] = gold
    write(top, "TEA", (340, 150), (130, 7), dark)
    return box_panels(front, side, top)


def milk_carton() -> Image:
    """Draw the texture of a white and blue milk carton."""
    blue, pale, grass = (34, 96, 182), (150, 200, 236), (96, 172, 78)
    front = np.full((700, 360, 3), _WHITE, dtype=np.uint8)
    front[:40] = blue
    front[330:] = pale
    disc(front, (270, 410), 44, (252, 206, 66))
    cv2.ellipse(front, (100, 720), (270, 190), 0, 0, 360, grass, -1, cv2.LINE_AA)
    cv2.ellipse(front, (320, 740), (220, 170), 0, 0, 360, (66, 140, 66), -1, cv2.LINE_AA)
    for x, y, r in ((90, 450, 26), (124, 440, 32), (160, 452, 24)):
        disc(front, (x, y), r, _WHITE)
    write(front, "MILK", (180, 160), (290, 20), blue)
    write(front, "FRESH 1 L", (180, 275), (200, 5), (196, 44, 52))
    side = front[:, ::-1].copy()
    side[50:330] = _WHITE
    small_print(side, (60, 80, 300, 300), 8)
    return box_panels(front, side, np.full((8, 8, 3), blue, dtype=np.uint8))


def milk_roof() -> Image:
    """Draw the texture of the blue roof of a milk carton."""
    blue = (34, 96, 182)
    slope = np.full((200, 360, 3), blue, dtype=np.uint8)
    slope[150:170] = _WHITE
    write(slope, "MILK", (180, 80), (170, 9), _WHITE)
    fin = np.full((8, 8, 3), (232, 232, 226), dtype=np.uint8)
    return box_panels(slope, fin, slope)


def can_label() -> Image:
    """Draw the label of a tomato soup can. The same front is drawn on two opposite sides of the can."""
    cream, red, gold = (250, 240, 216), (196, 40, 44), (222, 170, 62)
    half = np.full((512, 512, 3), cream, dtype=np.uint8)
    half[:205] = red
    half[196:214] = gold
    for x in range(0, 512, 64):
        half[400:, x : x + 32] = red
    half[392:404] = gold
    write(half, "TOMATO", (256, 110), (350, 15), cream)
    write(half, "SOUP", (256, 305), (210, 10), red)
    for x in (52, 460):
        disc(half, (x, 302), 40, red)
        disc(half, (x, 282), 14, (86, 140, 62))
    return np.hstack([half, half])


def beach_ball() -> Image:
    """Draw the six orange and white segments of a beach ball."""
    colours = np.array(3 * [(240, 138, 28), (226, 223, 216)], dtype=np.uint8)
    return np.ascontiguousarray(np.broadcast_to(np.repeat(colours, 128, axis=0), (64, 768, 3)))


def flashlight_bands() -> Image:
    """Draw the coloured bands of a flashlight, from its rear end (bottom) to its lens (top)."""
    image = np.full((512, 8, 3), (46, 49, 56), dtype=np.uint8)
    image[:8] = (214, 226, 232)  # lens
    image[8:140] = (238, 186, 28)
    image[140:156] = (40, 42, 48)
    image[200:440:12] = image[201:440:12] = image[202:440:12] = (24, 26, 30)  # grip pattern
    image[478:] = (238, 186, 28)
    return image


def mug_glaze() -> Image:
    """Draw the glaze of a cream and blue mug with a row of dots."""
    image = np.full((256, 1024, 3), (242, 232, 214), dtype=np.uint8)
    image[168:] = (44, 84, 140)
    image[158:164] = (44, 84, 140)
    for k in range(24):
        disc(image, (21 + 43 * k, 128), 11, (214, 92, 62))
    return image


def write(image: Image, text: str, centre: tuple[int, int], pen_px: tuple[int, int], colour: Colour) -> None:
    """Draw text, centred at a point, into an image. pen_px: width of the text and width of its strokes, in pixels."""
    (unit_width, unit_height), _ = cv2.getTextSize(text, _ROUND_FONT, 1.0, 1)
    scale = pen_px[0] / unit_width
    x, y = centre[0] - pen_px[0] / 2, centre[1] + scale * unit_height / 2
    cv2.putText(image, text, (round(x), round(y)), _ROUND_FONT, scale, colour, pen_px[1], cv2.LINE_AA)


def fill(image: Image, corners: Sequence[npt.ArrayLike], colour: Colour) -> None:
    """Fill a convex polygon in an image. corners: corners (x, y) in pixels."""
    cv2.fillPoly(image, [np.round(np.array(corners, dtype=np.float64)).astype(np.int32)], colour, cv2.LINE_AA)


def disc(image: Image, centre: tuple[int, int], radius_px: int, colour: Colour) -> None:
    """Fill a circle in an image. centre: (x, y) in pixels."""
    cv2.circle(image, centre, radius_px, colour, -1, cv2.LINE_AA)


def _bowl_of_rings(image: Image, centre: tuple[int, int], radius_px: int) -> None:
    """Draw a bowl filled with cereal rings."""
    x, y = centre
    rng = np.random.default_rng(3)
    cv2.ellipse(image, (x, y), (radius_px, radius_px // 3), 0, 0, 360, (252, 250, 244), -1, cv2.LINE_AA)
    for _ in range(46):
        turn, reach = rng.uniform(0, 2 * np.pi), np.sqrt(rng.uniform(0, 0.75))
        spot = (int(x + radius_px * reach * np.cos(turn)), int(y - 18 + radius_px * reach * np.sin(turn) / 3.2))
        cv2.circle(image, spot, 25, (150, 92, 30), 17, cv2.LINE_AA)
        cv2.circle(image, spot, 25, (226, 164, 70), 11, cv2.LINE_AA)
    cv2.ellipse(image, (x, y + 16), (radius_px, int(radius_px * 0.8)), 0, 0, 180, (38, 92, 170), -1, cv2.LINE_AA)
    cv2.ellipse(image, (x, y + 16), (radius_px, 40), 0, 0, 180, _WHITE, 10, cv2.LINE_AA)


def small_print(image: Image, corners: tuple[int, int, int, int], rows: int) -> None:
    """Draw a white panel with lines of small text. corners: left, top, right, bottom in pixels."""
    left, top, right, bottom = corners
    image[top:bottom, left:right] = (250, 248, 240)
    rng = np.random.default_rng(rows)
    pitch = (bottom - top) / (rows + 1)
    for row in range(rows):
        y = round(top + pitch * (row + 0.7))
        end = left + round((right - left) * rng.uniform(0.45, 0.7))
        cv2.line(image, (left + 12, y), (end, y), (60, 60, 66), max(2, round(pitch / 4)))
        cv2.line(image, (right - 40, y), (right - 12, y), (60, 60, 66), max(2, round(pitch / 4)))


def bar_code(image: Image, corners: tuple[int, int, int, int]) -> None:
    """Draw a bar code. corners: left, top, right, bottom in pixels."""
    left, top, right, bottom = corners
    image[top:bottom, left:right] = 250
    rng = np.random.default_rng(9)
    bars = np.repeat(rng.integers(0, 2, (right - left) // 4), 4)[: right - left]
    image[top + 8 : bottom - 8, left : left + len(bars)][:, bars == 1] = 24


def _to_image(values: npt.NDArray[np.float64]) -> Image:
    return np.clip(np.round(values), 0, 255).astype(np.uint8)
