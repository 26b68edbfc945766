"""Models of round household objects: cans, mugs, bowls, cups, flashlights and bottles.

Each object stands on z = 0, and its axis is the z axis. Lengths are in metres.
"""

from __future__ import annotations

import numpy as np

from spigolo.lab.synthetic.meshes import arc, lathe, line, tub, tube
from spigolo.lab.synthetic.prints import Palette, brushed_metal, palette, wrap
from spigolo.lab.synthetic.scene import Part
from spigolo.lab.synthetic.textures import Colour, Image, glazed, plain_card, write

__all__ = ["bowl", "coffee_cup", "coffee_mug", "flashlight", "glue_bottle", "shampoo", "soda_can"]

Parts = tuple[Part, ...]


def soda_can(rng: np.random.Generator) -> Parts:
    """Create a 33 cl beverage can, 66 mm in diameter and 115 to 122 mm high."""
    r, tall = 0.033, rng.uniform(0.115, 0.122)
    foot = [line((0.0, 0.004), (0.022, 0.002)), line((0.022, 0.002), (0.025, 0.0)), line((0.025, 0.0), (r, 0.011))]
    neck = arc((r - 0.007, tall - 0.011), 0.007, 0, 75, 8)
    top = [
        line(tuple(neck[-1]), (0.027, tall - 0.001)),
        line((0.027, tall - 0.001), (0.026, tall)),
        line((0.026, tall), (0.0245, tall - 0.004)),
        line((0.0245, tall - 0.004), (0.0, tall - 0.004)),
    ]
    bare = brushed_metal(rng, 190.0)
    sleeve = lathe([np.vstack([line((r, 0.011)), neck])])
    return (
        Part(sleeve, wrap(rng), 0.45, 0.6),
        Part(lathe(foot), bare, 0.7, 0.5),
        Part(lathe(top), bare, 0.7, 0.5),
    )


def coffee_mug(rng: np.random.Generator) -> Parts:
    """Create a hollow mug with a handle, 76 to 86 mm in diameter."""
    r, tall, wall, foot_m = rng.uniform(0.038, 0.043), rng.uniform(0.085, 0.105), 0.004, 0.006
    taper = rng.choice([0.0, 0.0, 0.006])
    foot = arc((r - taper - foot_m, foot_m), foot_m, -90, 0, 8)
    corner = arc((r - taper - wall - foot_m, wall + 2 * foot_m), foot_m, 0, -90, 8)
    outside = [line((0.0, 0.0), (r - taper - foot_m, 0.0)), np.vstack([foot, line((r, tall))])]
    inside = [
        arc((r - wall / 2, tall), wall / 2, 0, 180, 9),
        np.vstack([line((r - wall, tall)), corner]),
        line(tuple(corner[-1]), (0.0, wall + foot_m)),
    ]
    colour = _glaze(rng)
    lining = colour if rng.uniform() < 0.5 else (240, 236, 226)
    turn = np.linspace(-np.pi / 2, np.pi / 2, 28)
    reach, half = rng.uniform(0.024, 0.03), 0.27 * tall
    handle = np.column_stack([r - 0.0015 + reach * np.cos(turn), 0 * turn, 0.52 * tall + half * np.sin(turn)])
    handle[[0, -1], 0] -= taper / 2
    return (
        Part(lathe(outside), _decorated(colour, rng), 0.4, 0.6),
        Part(lathe(inside), plain_card(lining), 0.4, 0.6),
        Part(tube(handle, 0.0055), plain_card(colour), 0.4, 0.6),
    )


def bowl(rng: np.random.Generator) -> Parts:
    """Create a hollow bowl with a foot ring, 14 to 18 cm in diameter."""
    size, deep = rng.uniform(0.82, 1.06), rng.uniform(0.85, 1.25)
    t = np.linspace(0.0, 1.0, 32)
    outside = np.column_stack([0.036 + 0.049 * np.sin(t * np.pi / 2) ** 0.9, 0.008 + 0.060 * t**1.7])
    inside = np.column_stack([0.081 * np.sin(t * np.pi / 2) ** 0.85, 0.012 + 0.056 * t**2.1])[::-1]
    rim = arc((0.083, 0.068), 0.002, 0, 180, 9)
    foot = line((0.0, 0.0), (0.036, 0.0)), line((0.036, 0.0), (0.036, 0.008))
    sections = [section * [size, size * deep] for section in (*foot, outside, rim, inside)]
    return (Part(lathe(sections), glazed(_glaze(rng), _glaze(rng), rng.choice([0.0, 0.06, 0.2])), 0.35, 0.6),)


def coffee_cup(rng: np.random.Generator) -> Parts:
    """Create a paper cup with a white lid, 13 cm high."""
    tall, low_r, high_r = 0.112, 0.029, 0.0415
    cup = lathe([line((0.0, 0.0), (low_r, 0.0)), np.linspace((low_r, 0.0), (high_r, tall), 6)])
    lid = lathe(
        [
            line((high_r, tall - 0.004), (0.0445, tall - 0.004)),
            line((0.0445, tall - 0.004), (0.0445, tall + 0.002)),
            line((0.0445, tall + 0.002), (0.0395, tall + 0.004)),
            line((0.0395, tall + 0.004), (0.037, tall + 0.014)),
            line((0.037, tall + 0.014), (0.033, tall + 0.014)),
            line((0.033, tall + 0.014), (0.031, tall + 0.008)),
            line((0.031, tall + 0.008), (0.0, tall + 0.008)),
        ]
    )
    return Part(cup, wrap(rng), 0.1, 0.3), Part(lid, plain_card((238, 236, 230)), 0.2, 0.4)


def flashlight(rng: np.random.Generator) -> Parts:
    """Create a flashlight, 17 cm long, whose head is wider than its barrel. Its rear end is at z = 0."""
    long, r, head = 0.17, 0.014, 0.021
    profile = [
        line((0.0, 0.0), (r - 0.002, 0.0)),
        arc((r - 0.002, 0.002), 0.002, -90, 0, 5),
        line((r, 0.002), (r, 0.72 * long)),
        line((r, 0.72 * long), (head, 0.85 * long)),
        line((head, 0.85 * long), (head, long)),
        line((head, long), (0.0, long)),
    ]
    image = np.full((512, 8, 3), _glaze(rng), np.uint8)
    image[:6] = (206, 214, 218)  # the lens
    image[77:84] = image[142:150] = (24, 24, 26)
    image[190:440:12] = image[191:440:12] = image[192:440:12] = image[190:440:12] // 2
    return (Part(lathe(profile), image, 0.35, 0.5),)


FLASHLIGHT_TILT_DEG = 90 - float(np.degrees(np.arcsin((0.021 - 0.014) / (0.85 * 0.17))))
CUP_TILT_DEG = 90 - float(np.degrees(np.arcsin((0.0445 - 0.029) / 0.108)))
"""Angle between the axis of a lying cup and the vertical, in degrees. A lying cup touches the ground with its lid and
its foot.
"""


def shampoo(rng: np.random.Generator) -> Parts:
    """Create a flat oval bottle with a screw cap, 19 cm high."""
    size_m, half_m, tall = (0.066, 0.038), 0.019, 0.155
    shoulder = arc((-0.012, tall - 0.012), 0.012, 0, 80, 8)
    body = tub(
        size_m,
        half_m,
        [
            line((-half_m, 0.0), (-0.003, 0.0)),
            line((-0.003, 0.0), (0.0, 0.004)),
            np.vstack([line((0.0, 0.004)), shoulder, line((-half_m, tall + 0.001))]),
        ],
    )
    cap = lathe([line((0.013, tall - 0.008), (0.013, tall + 0.032)), line((0.013, tall + 0.032), (0.0, tall + 0.032))])
    colours = palette(rng, dark=0.2)
    return Part(body, _round_bottle(colours, rng), 0.35, 0.6), Part(cap, plain_card(colours[2]), 0.3, 0.6)


def glue_bottle(rng: np.random.Generator) -> Parts:
    """Create a glue bottle with a pointed cap, 14 cm high."""
    colours = palette(rng, dark=0.1)
    half_m = 0.017
    side = line((0.0, 0.0), (0.0, 0.098), (-0.008, 0.108), (-half_m, 0.110))
    body = tub((0.058, 2 * half_m), half_m, [line((-half_m, 0.0), (0.0, 0.0)), side])
    tip = lathe(
        [
            line((0.0125, 0.1), (0.0125, 0.112)),
            line((0.0125, 0.112), (0.009, 0.12)),
            line((0.009, 0.12), (0.003, 0.142)),
            line((0.003, 0.142), (0.0, 0.142)),
        ]
    )
    return Part(body, _round_bottle(colours, rng), 0.25, 0.5), Part(tip, plain_card(colours[2]), 0.25, 0.5)


def _round_bottle(colours: Palette, rng: np.random.Generator) -> Image:
    """Draw a printed texture for a bottle from `meshes.tub`. The first image row is at the foot of the bottle."""
    return np.ascontiguousarray(wrap(rng, colours)[::-1])


def _decorated(colour: Colour, rng: np.random.Generator) -> Image:
    """Draw glaze of one colour, with or without bands or text."""
    image = np.full((256, 1024, 3), colour, np.uint8)
    kind, ink = int(rng.integers(4)), _glaze(rng)
    if kind == 0:
        image[60:90] = image[180:200] = ink
    elif kind == 1:
        for x in (256, 768):
            write(image, "MUG", (x, 130), (200, 14), ink)
    elif kind == 2:
        image[170:] = ink
    return image


def _glaze(rng: np.random.Generator) -> Colour:
    """Return a random colour of glaze. The colour is white with a probability of 30 %."""
    if rng.uniform() < 0.3:
        return 238, 234, 222
    return palette(rng, dark=0.5)[0]
