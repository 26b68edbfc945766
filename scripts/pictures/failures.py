"""Pictures of wrong results, caused by faults of the input or limits of the method."""

from __future__ import annotations

import warnings

import numpy as np
import numpy.typing as npt

import spigolo as sp
from pictures import scenes
from pictures.layout import smaller, zoom
from spigolo.frames.frame import Color
from spigolo.view.overlay import tile


def wrong_inputs(frame: sp.Frame) -> Color:
    """Draw the objects that are found in a good frame and in frames with a fault."""
    camera = frame.camera
    assert camera is not None
    shifted = np.roll(frame.depth, 25, axis=1)
    holes = np.where(np.arange(frame.shape[1]) % 32 < 20, np.float32(0), frame.depth)
    frames = {
        "a good frame": frame,
        "depth in wrong units (x 10)": sp.Frame(frame.color, frame.depth * 10, camera),
        "depth 25 px to the right": sp.Frame(frame.color, shifted, camera),
        "no intrinsics": sp.Frame(frame.color, frame.depth, None),
        "two thirds of the depth missing": sp.Frame(frame.color, holes, camera),
        "a frame without its table": sp.Frame(frame.color, np.where(table(frame), 0, frame.depth), camera),
    }
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", sp.errors.UnitWarning)  # the wrong unit is part of the picture
        results = {name: sp.segment(spoilt) for name, spoilt in frames.items()}
    return tile({f"{name}: {len(r)}": smaller(r.overlay()) for name, r in results.items()}, columns=3)


def table(frame: sp.Frame) -> npt.NDArray[np.bool_]:
    """Return the mask (H, W) of background pixels on the support plane."""
    support = sp.segment(frame).support
    assert support is not None
    return support


def touching_objects() -> Color:
    """Draw the objects found in two boxes with flush front faces, and in the same boxes with one box 3 cm behind the
    other.
    """
    pictures = {}
    for title, behind_m in {"flush faces": 0.0, "one box 3 cm behind": 0.03}.items():
        frame = scenes.two_boxes(behind_m)
        result = sp.segment(frame)
        noun = "object" if len(result) == 1 else "objects"
        pictures[title] = zoom(frame.color, scenes.TWO_BOXES, 1)
        pictures[f"{title}: {len(result)} {noun}"] = zoom(result.overlay(), scenes.TWO_BOXES, 1)
    return tile(pictures, columns=4)


def flat_objects() -> Color:
    """Draw the objects found among boxes of several heights. The boxes of the smallest height are not found."""
    flat = scenes.flat_boxes((3, 5, 7, 10, 15, 30), distance_m=0.7)
    result = sp.segment(flat.frame)
    return tile(
        {
            "colour, heights in mm": zoom(flat.labelled(), flat.window, 1),
            f"{len(result)} of {len(flat.heights_mm)} objects": zoom(result.overlay(), flat.window, 1),
        },
        columns=2,
    )
