"""Models of household objects: boxes, bags, a book, a cap and a camera.

Each object stands on z = 0, and its front faces -y. Lengths are in metres.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from spigolo.lab.synthetic.meshes import (
    Mesh,
    box,
    gable_roof,
    joined,
    lathe,
    line,
    moved,
    prism,
    rounded_rectangle,
    sheet,
)
from spigolo.lab.synthetic.prints import brushed_metal, carton, cover, packet, palette, wrap
from spigolo.lab.synthetic.scene import Part
from spigolo.lab.synthetic.textures import box_panels, milk_roof, plain_card, smooth_noise

__all__ = ["book", "bottle_carton", "camera", "cap", "cereal_box", "milk", "pouch", "small_box"]

FloatArray = npt.NDArray[np.float64]
Parts = tuple[Part, ...]


def cereal_box(rng: np.random.Generator) -> Parts:
    """Create a cereal box, 17 to 21 cm wide and 24 to 30 cm high."""
    return _box((rng.uniform(0.17, 0.21), rng.uniform(0.05, 0.07), rng.uniform(0.24, 0.30)), rng)


def small_box(rng: np.random.Generator) -> Parts:
    """Create a small carton, 8 to 15 cm wide and 9 to 17 cm high."""
    return _box((rng.uniform(0.08, 0.15), rng.uniform(0.035, 0.07), rng.uniform(0.09, 0.17)), rng)


def bottle_carton(rng: np.random.Generator) -> Parts:
    """Create a tall narrow carton, 6 to 9 cm wide and 17 to 22 cm high."""
    return _box((rng.uniform(0.06, 0.09), rng.uniform(0.04, 0.07), rng.uniform(0.17, 0.22)), rng)


def milk(rng: np.random.Generator) -> Parts:
    """Create a one-litre milk carton with a gable roof."""
    wide, wall = 0.073, 0.17
    colours = palette(rng, dark=0.1)
    body = carton((wide, wide, wall), rng, colours)
    roof = milk_roof()
    return Part(box((wide, wide, wall)), body, 0.15, 0.3), Part(
        gable_roof(wide, wide, wall, 0.034, 0.016), roof, 0.15, 0.3
    )


def book(rng: np.random.Generator) -> Parts:
    """Create a paperback book, 19 to 23 cm high."""
    size_m = rng.uniform(0.13, 0.17), rng.uniform(0.012, 0.028), rng.uniform(0.19, 0.23)
    colours = palette(rng)
    front = cover((round(2400 * size_m[2]), round(2400 * size_m[0])), colours, rng)
    spine = np.full((256, 64, 3), colours[0], np.uint8)
    leaves = np.repeat(232 + 8 * rng.standard_normal((1, 128, 1)), 3, axis=2).clip(0, 255).astype(np.uint8)
    return (Part(box(size_m), box_panels(front, spine, np.repeat(leaves, 64, axis=0)), 0.3, 0.5),)


def pouch(rng: np.random.Generator) -> Parts:
    """Create a creased foil bag that is thick in the middle and flat at the top and bottom."""
    wide, thick, tall = rng.uniform(0.14, 0.18), rng.uniform(0.045, 0.06), rng.uniform(0.18, 0.23)
    v, u = np.mgrid[-1:1:41j, -1:1:31j]
    bulge = (1 - v**4) ** 0.6 * (1 - np.abs(u) ** 3) ** 0.6
    faces = []
    for side, shown in ((-1, 0.0), (1, 0.5)):
        crease = 1 + 0.06 * smooth_noise(u.shape, (9, 7), rng)
        depth = side * thick / 2 * bulge * crease
        points = np.stack([-side * u * wide / 2 * (1 - 0.06 * bulge), depth, (1 + v) * tall / 2], axis=-1)
        faces.append(
            sheet(points, np.stack([shown + 0.002 + 0.496 * (u + 1) / 2, 0.002 + 0.996 * (1 - v) / 2], axis=-1))
        )
    return (Part(joined(faces), np.hstack([packet(rng), packet(rng)]), 0.5, 0.6),)


def camera(rng: np.random.Generator) -> Parts:
    """Create a compact camera, 11 cm wide, with an extended lens."""
    outline, _ = rounded_rectangle((0.112, 0.036), 0.012)
    grip, _ = rounded_rectangle((0.026, 0.016), 0.006)
    body = joined([prism(outline, 0.0, 0.066), prism(grip + np.array([-0.04, -0.020]), 0.002, 0.06)])
    hump = prism(rounded_rectangle((0.05, 0.026), 0.006)[0], 0.066, 0.080)
    barrel = lathe(
        [
            line((0.029, 0.0), (0.029, 0.018)),
            line((0.029, 0.018), (0.025, 0.018)),
            line((0.025, 0.018), (0.025, 0.036)),
            line((0.025, 0.036), (0.019, 0.036)),
            line((0.019, 0.036), (0.016, 0.030)),
            line((0.016, 0.030), (0.0, 0.030)),
        ]
    )
    forward = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # turns z to -y
    lens = moved(barrel, forward, (0.012, -0.017, 0.033))
    button = moved(
        lathe([line((0.008, 0.0), (0.008, 0.005)), line((0.008, 0.005), (0.0, 0.005))]), np.eye(3), (-0.038, 0.0, 0.066)
    )
    paint = np.repeat(plain_card(palette(rng, dark=0.3)[0]), 8, axis=1)
    rings = np.full((256, 8, 3), 74, np.uint8)
    rings[::24] = rings[1::24] = 150
    return (
        Part(joined([body, hump]), paint, 0.2, 0.4),
        Part(lens, rings, 0.35, 0.5),
        Part(button, brushed_metal(rng, 180.0), 0.4, 0.5),
    )


def cap(rng: np.random.Generator) -> Parts:
    """Create a baseball cap with a peak."""
    side, front, tall = 0.082, 0.095, rng.uniform(0.095, 0.115)
    t, phi = np.meshgrid(np.linspace(0, 0.49 * np.pi, 26), np.linspace(-np.pi, np.pi, 73), indexing="ij")
    round_r = np.cos(t) ** 0.75
    dome = np.stack([side * round_r * np.cos(phi), front * round_r * np.sin(phi), tall * np.sin(t) ** 1.1], axis=-1)
    uv = np.stack([(phi + np.pi) / (2 * np.pi), 0.002 + 0.996 * (1 - t / (np.pi / 2))], axis=-1)
    image, colours = _panels_of_cloth(rng)
    button = moved(
        lathe([line((0.007, 0.0), (0.005, 0.005)), line((0.005, 0.005), (0.0, 0.006))]), np.eye(3), (0, 0, tall - 0.001)
    )
    cloth = plain_card(colours[1])
    return (
        Part(sheet(dome, uv), image, 0.0, 0.1),
        Part(joined([_peak(side, front, 0.004), _peak(side, front, 0.0)]), cloth, 0.0, 0.1),
        Part(button, cloth, 0.0, 0.1),
    )


def _peak(side_m: float, front_m: float, lift_m: float) -> Mesh:
    """Create one face of the peak of a baseball cap: the lower face if lift_m is 0, else the upper face.

    lift_m: height of the created face above the lower face, in metres.
    """
    out, phi = np.meshgrid(np.linspace(1, 0, 12), np.linspace(-2.55, -0.6, 40), indexing="ij")
    middle = np.maximum(np.sin((phi + 2.55) / 1.95 * np.pi), 0.02) ** 0.7
    reach = 0.068 * out * middle
    x, y = (side_m + 0.5 * reach) * np.cos(phi), (front_m + reach) * np.sin(phi)
    z = lift_m * (1 - out**2) + 0.016 * middle * (0.4 + 0.6 * out)
    uv = np.stack([out, (phi + 2.55) / 2], axis=-1)
    points = np.stack([x, y, z], axis=-1)
    return sheet(points, uv) if lift_m > 0 else sheet(points[::-1], uv)


def _panels_of_cloth(rng: np.random.Generator) -> tuple[npt.NDArray[np.uint8], tuple[tuple[int, int, int], ...]]:
    """Create a cloth texture with six panels and an emblem. Return the texture and its colours."""
    colours = palette(rng, dark=0.5)
    image = np.full((384, 1024, 3), colours[0], np.uint8)
    emblem = wrap(rng, colours)[180:460, 100:400]
    image[190:350, 176:336] = emblem[: 2 * 160 : 1][np.linspace(0, 279, 160).astype(int)][
        :, np.linspace(0, 299, 160).astype(int)
    ]
    for k in range(6):
        x = round((k + 0.0) * 1024 / 6)
        image[:, x : x + 4] = image[:, x : x + 4] // 2
    weave = 5 * smooth_noise((384, 1024), (190, 500), rng) + 6 * smooth_noise((384, 1024), (5, 12), rng)
    return np.clip(image + weave[..., None], 0, 255).astype(np.uint8), colours


def _box(size_m: tuple[float, float, float], rng: np.random.Generator) -> Parts:
    return (Part(box(size_m), carton(size_m, rng), 0.2, 0.4),)
