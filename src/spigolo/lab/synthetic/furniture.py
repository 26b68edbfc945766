"""Unlabelled background objects of rendered rooms: monitors, chairs, cartons, posters and paper.

World frame: x to the right, y away from the camera, z up. Lengths are in metres.
"""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic.meshes import Mesh, box, joined, moved, prism, rounded_rectangle
from spigolo.lab.synthetic.prints import carton, cover, page, palette
from spigolo.lab.synthetic.scene import Part
from spigolo.lab.synthetic.surfaces import surface
from spigolo.lab.synthetic.textures import Image, plain_card

__all__ = ["chair", "keyboard", "packing_case", "poster", "screen", "sheet_of_paper"]

FloatArray = npt.NDArray[np.float64]
Place = tuple[float, float, float]


def screen(at_m: Place, yaw_deg: float, rng: np.random.Generator) -> list[Part]:
    """Create a monitor with a stand. The screen of the monitor is black or shows a page of text."""
    wide, tall = rng.uniform(0.4, 0.55), rng.uniform(0.26, 0.34)
    shell = _put(
        joined([_slab((wide, 0.03, tall), 0.12), _slab((0.05, 0.03, 0.14), 0.0), _slab((0.2, 0.15, 0.012), 0.0)]),
        at_m,
        yaw_deg,
    )
    face = moved(_slab((wide - 0.03, 0.004, tall - 0.03), 0.135), np.eye(3), (0.0, -0.0155, 0.0))
    image = np.full((240, 360, 3), 14, np.uint8)
    if rng.uniform() < 0.5:
        image[20:220, 15:345] = page((200, 330), rng) // 2 + 60
    whole = np.hstack([image, image, image])
    return [
        Part(shell, plain_card((26, 26, 28)), 0.2, 0.4),
        Part(_put(face, at_m, yaw_deg), whole, 0.5, 0.8),
    ]


def chair(at_m: Place, yaw_deg: float, rng: np.random.Generator) -> list[Part]:
    """Create the seat and the back of a chair, covered with cloth. at_m: centre of the seat."""
    back = prism(rounded_rectangle((0.44, 0.48), 0.09)[0], -0.03, 0.03)
    upright = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    seat = prism(rounded_rectangle((0.46, 0.44), 0.08)[0], -0.04, 0.04)
    whole = joined([moved(back, upright, (0.0, 0.22, 0.34)), seat])
    return [Part(_put(whole, at_m, yaw_deg), surface("cloth", rng), 0.0, 0.1)]


def packing_case(at_m: Place, yaw_deg: float, rng: np.random.Generator) -> list[Part]:
    """Create a large carton, 20 to 45 cm wide, 20 to 40 cm deep and 15 to 40 cm high."""
    size_m = rng.uniform(0.2, 0.45), rng.uniform(0.2, 0.4), rng.uniform(0.15, 0.4)
    colours = (168, 128, 84), (150, 112, 72), palette(rng)[2], (70, 52, 40)
    print_m = tuple(0.4 * length for length in size_m)
    return [
        Part(_put(box(size_m), at_m, yaw_deg), carton((print_m[0], print_m[1], print_m[2]), rng, colours), 0.0, 0.1)
    ]


def poster(at_m: Place, rng: np.random.Generator) -> list[Part]:
    """Create a flat panel on a wall. The panel shows the front of a package, a page of text, a bookshelf or window
    blinds. at_m: centre of the panel.
    """
    wide, tall = rng.uniform(0.3, 0.8), rng.uniform(0.3, 0.9)
    size = round(500 * tall), round(500 * wide)
    makes = (_spines, _blinds, page, lambda size, rng: cover(size, palette(rng), rng))
    image = makes[int(rng.integers(len(makes)))](size, rng)
    panel = moved(box((wide, 0.01, tall)), np.eye(3), (at_m[0], at_m[1], at_m[2] - tall / 2))
    return [Part(panel, np.hstack([image, image, image]), 0.05, 0.2)]


def _spines(size: tuple[int, int], rng: np.random.Generator) -> Image:
    """Draw an image of a bookshelf."""
    height, width = size
    image = np.full((height, width, 3), 40, np.uint8)
    for low in range(height, 60, -150):
        x = 4
        while x < width - 30:
            thick, tall = int(rng.integers(8, 26)), int(rng.integers(90, 135))
            ground, second, _, _ = palette(rng, dark=0.5)
            image[max(0, low - 8 - tall) : low - 8, x : x + thick] = ground
            image[max(0, low + 12 - tall) : max(0, low + 40 - tall), x + 2 : x + thick - 2] = second
            x += thick + 1
        image[low - 8 : low] = (140, 120, 96)
    return image


def _blinds(size: tuple[int, int], rng: np.random.Generator) -> Image:
    """Draw an image of window blinds."""
    rows = np.arange(size[0]) % int(rng.integers(9, 16))
    tone = np.where(rows < 2, rng.uniform(60, 120), rng.uniform(170, 230) - 4.0 * rows)
    return np.ascontiguousarray(np.broadcast_to(tone[:, None, None], (*size, 3))).astype(np.uint8)


def sheet_of_paper(at_m: Place, yaw_deg: float, rng: np.random.Generator) -> Part:
    """Create a printed sheet of paper, 0.2 mm thick. Objects can stand on the sheet."""
    size_m = (0.297, 0.21) if rng.uniform() < 0.6 else (rng.uniform(0.07, 0.2), rng.uniform(0.1, 0.2))
    outline, _ = rounded_rectangle(size_m, 0.0005, 2)
    image: Image = page((420, 420), rng)
    return Part(_put(prism(outline, 0.0, 0.0002), at_m, yaw_deg), image, 0.0, 0.1)


def keyboard(spot_m: tuple[float, float], yaw_deg: float, rng: np.random.Generator) -> Part:
    """Create a keyboard."""
    dark = rng.uniform() < 0.7
    ground, key = ((20, 20, 22), (48, 48, 52)) if dark else ((150, 150, 148), (214, 212, 206))
    image = np.full((440, 440, 3), ground, np.uint8)
    for row in range(6):
        for column in range(17):
            corner = 12 + 25 * column + 4 * (row % 2), 322 + 18 * row
            cv2.rectangle(image, corner, (corner[0] + 19, corner[1] + 13), key, -1)
    outline, _ = rounded_rectangle((0.43, 0.12), 0.008, 4)
    return Part(_put(prism(outline, 0.0, 0.018), (*spot_m, 0.0), yaw_deg), image, 0.05, 0.2)


def _slab(size_m: Place, low_m: float) -> Mesh:
    return moved(box(size_m), np.eye(3), (0.0, 0.0, low_m))


def _put(mesh: Mesh, at_m: Place, yaw_deg: float) -> Mesh:
    cos, sin = np.cos(np.radians(yaw_deg)), np.sin(np.radians(yaw_deg))
    turn: FloatArray = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
    return moved(mesh, turn, at_m)
