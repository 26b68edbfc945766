"""The paper's Figure 1, whose seven panels show the results of the stages for one frame."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color
from spigolo.frames.halving import halve_frame
from spigolo.objects.drawing import palette
from spigolo.pipeline import Trace
from spigolo.stages.color import color_points
from spigolo.view.overlay import depth_picture, region_picture, tile

Array = npt.NDArray[np.generic]


def figure1(trace: Trace) -> Color:
    """Draw the results of all stages of one frame in seven panels.

    The panels show (a) colour, (b) depth, (c) smoothed and in-painted depth, (d) edge weights, (e) regions, (f)
    objects, and (g) objects on white.
    """
    frame, result = trace.frame, trace.segmentation
    return tile(
        {
            "(a) colour": frame.color,
            "(b) depth (black: missing)": depth_picture(frame.depth),
            "(c) smoothed and in-painted depth": depth_picture(trace.cues.depth),
            "(d) graph weights": weight_picture(trace.graph.weights),
            f"(e) {trace.regions.count} regions": region_picture(trace.regions.labels),
            f"(f) {len(result)} objects": result.overlay(),
            "(g) the objects": cut_out(result.labels, frame.color),
        },
        columns=4,
    )


def weight_picture(weights: npt.NDArray[np.float32]) -> Color:
    """Draw the largest weight of the graph edges at each pixel. Colours from blue (0) to red show the square root of
    the weight.

    weights: edge weights (P, H, W) of the graph.
    """
    largest = np.where(np.isinf(weights), 0, weights).max(axis=0)
    strong = max(float(np.percentile(largest, 99)), 1e-12)
    level = np.sqrt(np.clip(largest / strong, 0, 1))
    return np.asarray(
        cv2.cvtColor(cv2.applyColorMap((level * 255).astype(np.uint8), cv2.COLORMAP_TURBO), cv2.COLOR_BGR2RGB), np.uint8
    )


def cut_out(labels: npt.NDArray[np.int32], color: Color) -> Color:
    """Draw the pixels of all objects on a white background, and the outline of each object."""
    picture = np.where((labels > 0)[..., None], color, np.uint8(255)).astype(np.uint8)
    for k, tint in enumerate(palette(int(labels.max(initial=0))), start=1):
        outlines, _ = cv2.findContours((labels == k).astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, outlines, -1, tint.tolist(), 2, cv2.LINE_AA)
    return picture


def stages(trace: Trace) -> dict[str, Array]:
    """Return the result arrays of all stages, indexed by name. The command `spigolo trace --stages` writes these arrays
    to files.
    """
    cues = trace.cues
    halved = cues.depth.shape != trace.frame.shape
    frame = halve_frame(trace.frame) if halved else trace.frame
    arrays: dict[str, Array] = {
        "depth": trace.frame.depth,
        "smoothed_depth": cues.depth,
        "color_points": color_points(frame.color, trace.config.at_size(frame.shape).color),
        "weights": trace.graph.weights,
        "regions": trace.regions.labels,
        "labels": trace.segmentation.labels,
    }
    if cues.saliency is not None:
        arrays["saliency"] = cues.saliency
    if trace.edges is not None:
        arrays |= {
            "canny": trace.edges.canny,
            "depth_boundary": trace.edges.depth_boundary,
            "contact_boundary": trace.edges.contact_boundary,
            "final_boundary": trace.edges.final,
            "boundary": cues.delta_bound,
        }
    if trace.contours is not None and trace.contours.contours is not None:
        arrays["depth_contours"] = trace.contours.contours
    if trace.segmentation.support is not None:
        arrays["support"] = trace.segmentation.support
    return arrays
