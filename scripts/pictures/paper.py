"""Pictures of choices that the paper leaves open, with the results of both choices on the bundled scene."""

from __future__ import annotations

import cv2
import numpy as np

import spigolo as sp
from pictures.layout import CONTACT, Window, zoom
from spigolo.frames.frame import Color, DepthMap
from spigolo.settings import EdgesConfig, Inpainting, Smoothing
from spigolo.stages.depth import inpaint_small_gaps, smooth
from spigolo.stages.edges import EdgeMaps, find_edges
from spigolo.view.overlay import region_picture, tile

BOX_CORNER, CEREAL, RIGHT_HALF = (72, 66, 172, 186), (60, 70, 220, 240), (95, 230, 330, 600)
CEREAL_TO_CAN = (60, 85, 265, 355)
BOXES = (150, 380, 310, 570)
BOXES_ON_THEIR_SIDE = (65, 105, 225, 280)

GROUND, CANNY, STEP = (30, 30, 30), (110, 110, 110), (255, 150, 30)


def mean_of_windows(frame: sp.Frame) -> Color:
    """Draw depth next to a shadow, smoothed with the plain mean of equation 5 and with the mean over valid pixels of
    equation 8. Pixels on depth steps are part of the mean in both maps.
    """
    plain, valid = (smooth(frame.depth, Smoothing(mean=mean, skip_steps=False)) for mean in ("plain", "valid"))
    depths = {"measured": frame.depth, "plain mean (eq. 5)": plain, "mean of valid pixels (eq. 8)": valid}
    pictures = {title: zoom(grey(depth), BOX_CORNER, 4) for title, depth in depths.items()}
    pictures["colour"] = zoom(frame.color, BOX_CORNER, 4)
    pictures["plain - measured (dark: nearer)"] = zoom(change(plain, frame.depth), BOX_CORNER, 4)
    pictures["valid - measured"] = zoom(change(valid, frame.depth), BOX_CORNER, 4)
    return tile(pictures, columns=3)


def sign_of_step(frame: sp.Frame) -> Color:
    """Draw the depth boundaries of equation 13, computed with the absolute and with the signed depth difference."""
    choices = {"absolute step": EdgesConfig(), "signed step (as printed)": EdgesConfig(signed_step=True)}
    return edge_choice(frame, BOXES, choices)


def missing_samples(frame: sp.Frame) -> Color:
    """Draw the depth boundaries of equation 13 if missing depth samples are ignored, and if missing samples count as a
    depth of 0 m.
    """
    choices = {
        "missing samples: ignored": EdgesConfig(),
        "missing samples: 0 m (as printed)": EdgesConfig(missing_is_boundary=True),
    }
    return edge_choice(frame, CEREAL, choices)


def sign_rule(frame: sp.Frame) -> Color:
    """Draw the contact boundaries with both rules for the sign of the angle in equation 19. The scene is rotated by 90
    degrees, as for a camera mounted on its side.
    """
    height, width = frame.shape[::-1]
    camera = sp.Camera(525, 525, (width - 1) / 2, (height - 1) / 2, width, height)
    turned = sp.Frame(np.rot90(frame.color), np.rot90(frame.depth), camera)
    choices = {
        'sign_rule = "tangent"': EdgesConfig(),
        'sign_rule = "x" (as printed)': EdgesConfig(sign_rule="x"),
    }
    return edge_choice(turned, BOXES_ON_THEIR_SIDE, choices)


def texture_edges(frame: sp.Frame) -> Color:
    """Draw the Canny edges, and the Canny edges that equation 20 keeps as boundaries."""
    edges = edge_maps(frame, EdgesConfig())
    canny = np.where(edges.canny[..., None], np.uint8(235), np.uint8(30)) * np.ones(3, np.uint8)
    final = np.where(edges.final[..., None], np.uint8(235), np.uint8(30)) * np.ones(3, np.uint8)
    pictures = {
        "colour": frame.color,
        f"E_E: {int(edges.canny.sum())} px": canny,
        f"E_F: {int(edges.final.sum())} px": final,
    }
    return tile({title: zoom(picture, CEREAL_TO_CAN, 2) for title, picture in pictures.items()}, columns=3)


def soft_boundary(frame: sp.Frame) -> Color:
    """Draw the regions found with the cost function of equation 23, with a soft and with a thin boundary map."""
    pictures = {}
    for name in ("soft", "thin"):
        run = sp.trace(frame, sp.TABLE.replace(**{"edges.boundary": name}))
        cue = np.round(run.cues.delta_bound * 255).astype(np.uint8)
        pictures[f"{name}: the cue"] = zoom(cv2.cvtColor(cue, cv2.COLOR_GRAY2RGB), RIGHT_HALF, 1.5)
        pictures[f"{name}: regions of TABLE"] = zoom(region_picture(run.regions.labels), RIGHT_HALF, 1.5)
    return tile(pictures, columns=2)


def larger_end(frame: sp.Frame) -> Color:
    """Draw the regions found with the cost function of equation 23 and a thin boundary map, once for each value of
    `BoundaryCost.ends`.

    The pictures use the preset OBJECTS_1, in which each pixel has 8 neighbours. On a 4-connected grid, no graph edge
    crosses a thin line diagonally.
    """
    pictures = {}
    for ends, title in (("max", "larger of both ends"), ("i", "first end, as printed")):
        run = sp.trace(frame, sp.PRESETS["OBJECTS_1"].replace(**{"edges.boundary": "thin", "cost.ends": ends}))
        pictures[f"{title}: {run.regions.count} regions"] = region_picture(run.regions.labels)[40:420]
    return tile(pictures, columns=2)


def edge_choice(frame: sp.Frame, window: Window, choices: dict[str, EdgesConfig]) -> Color:
    """Draw a part of the colour image, and the boundaries in this part for each configuration of the edge detection."""
    pictures = {"colour": zoom(frame.color, window, 3)}
    for title, config in choices.items():
        pictures[title] = zoom(edge_picture(edge_maps(frame, config)), window, 3)
    return tile(pictures, columns=3)


def edge_maps(frame: sp.Frame, config: EdgesConfig) -> EdgeMaps:
    """Return the edge maps of the paper, computed from in-painted and smoothed depth as in the preset TABLE."""
    depth = smooth(inpaint_small_gaps(frame.depth, Inpainting()), Smoothing())
    return find_edges(frame.color, depth, frame.camera, config)


def edge_picture(edges: EdgeMaps) -> Color:
    """Draw depth boundaries in orange, other contact boundaries in green, other Canny edges in grey."""
    picture = np.full((*edges.canny.shape, 3), GROUND, np.uint8)
    for mask, ink in ((edges.canny, CANNY), (edges.contact_boundary, CONTACT), (edges.depth_boundary, STEP)):
        picture[mask] = ink
    return picture


def grey(depth: DepthMap) -> Color:
    """Draw depth from 0.7 to 1.3 m in grey. Near pixels are dark, and pixels without depth are blue."""
    level = np.clip((depth - 0.7) / 0.6 * 190 + 45, 20, 235).astype(np.uint8)
    picture = np.repeat(level[..., None], 3, axis=2)
    picture[depth == 0] = (20, 30, 110)
    return picture


def change(smoothed: DepthMap, measured: DepthMap) -> Color:
    """Draw smoothed minus measured depth: -40 mm is black, 0 is grey, and +40 mm is white. Pixels without depth are
    blue.
    """
    level = np.clip((smoothed - measured) / 0.04 * 127 + 128, 0, 255).astype(np.uint8)
    picture = np.repeat(level[..., None], 3, axis=2)
    picture[measured == 0] = (20, 30, 110)
    return picture
