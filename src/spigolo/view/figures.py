"""The paper's Figures 2 to 5, drawn for frames of the user."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.errors import CameraError
from spigolo.frames.frame import Camera, Color, DepthMap, Frame
from spigolo.objects.segmentation import Segmentation
from spigolo.pipeline import segment
from spigolo.settings.config import Config
from spigolo.settings.presets import SHELF, TABLE
from spigolo.stages.depth import missing_mask, prepare_depth, smooth
from spigolo.stages.edges import EdgeMaps, find_edges
from spigolo.stages.saliency import fine_grained_saliency, power_law
from spigolo.view.overlay import depth_picture, tile

Window = tuple[int, int, int, int]
"""Rectangular part (y0, x0, y1, x1) of an image in pixels, y1 and x1 exclusive."""

MISSING_BLUE = (0, 0, 110)
DETAIL_SHARE = 5
"""Width of the image divided by the width of a detail that is drawn enlarged. The height of the image, divided by the
height of the detail, has the same value.
"""
TURN_DEG = 55.0
"""Angle between the viewing direction of the camera and that of the side view of a point cloud, in degrees."""
CURVED = 2
"""Number of enlarged objects in Figure 4."""


def figure2(frame: Frame, config: Config = TABLE) -> Color:
    """Draw the results of two smoothing methods next to missing depth: equation 5 on the left, and equation 8 on the
    right.

    The rows show the smoothed depth map, its point cloud from the side, and an enlarged detail. The enlarged detail is
    the part of the image in which the two smoothed depth maps differ most. Equation 5 counts missing depth as 0, and
    equation 8 ignores missing depth. Pixels on depth steps are part of the mean in both maps.
    """
    if frame.camera is None:
        raise CameraError("expected intrinsics for the clouds of Figure 2, got a frame without a camera")
    config = config.at_size(frame.shape)
    original = smooth(frame.depth, config.depth.smoothing.replace(mean="plain", skip_steps=False))
    modified = smooth(frame.depth, config.depth.smoothing.replace(mean="valid", skip_steps=False))
    spot = _detail(np.abs(original - modified), frame.shape)
    wide = _around(spot, 2.0, frame.shape)
    pictures: dict[str, Color] = {}
    for name, depth, letters in (("eq. 5", original, "ace"), ("eq. 8", modified, "bdf")):
        pictures[f"({letters[0]}) depth, {name}"] = _blue_where_missing(depth)
        pictures[f"({letters[1]}) cloud from the side, {name}"] = side_view(depth, frame.color, frame.camera, wide)
        detail = _within(_cut(depth, spot), _cut(modified, spot))
        pictures[f"({letters[2]}) detail, {name}"] = _enlarge(_blue_where_missing(detail), frame.shape)
    return tile({title: pictures[title] for title in sorted(pictures)}, columns=2)


def figure3(frame: Frame, config: Config = SHELF) -> Color:
    """Draw the colour image, the saliency map, and the saliency map after it is raised to a power (equation 10)."""
    config = config.at_size(frame.shape)
    saliency = fine_grained_saliency(frame.color, config.saliency)
    pictures = {
        "colour": frame.color,
        "(a) saliency": _grey(saliency),
        f"(b) saliency after the power law, exponent {config.saliency.power:g}": _grey(
            power_law(saliency, config.saliency.power)
        ),
    }
    return tile(pictures, columns=3)


def figure4(frame: Frame, config: Config = TABLE) -> Color:
    """Draw boundaries with and without internal boundaries, which are convex edges inside objects. Also draw the Canny
    edges and the boundaries of two objects, enlarged.

    The two objects have the largest shares of Canny pixels that are not boundaries. Canny pixels that are not
    boundaries are common on printed patterns and curved surfaces.

    config: preset that finds the objects and the boundaries.
    """
    found = segment(frame, config)
    config = config.at_size(frame.shape)
    with_internal = config.edges.replace(sign_rule="none")
    depth = prepare_depth(frame.depth, config.depth)
    internal = find_edges(frame.color, depth, frame.camera, with_internal)
    edges = find_edges(frame.color, depth, frame.camera, config.edges)
    pictures = {
        "(a) final edges with internal boundaries": _lines(internal.final),
        "(b) final edges (eq. 20)": _lines(edges.final),
    }
    for k, window in enumerate(_busiest(found, edges)):
        for letter, title, mask in (("ce"[k], "Canny", edges.canny), ("df"[k], "final edges", edges.final)):
            pictures[f"({letter}) {title}"] = _enlarge(_lines(_cut(mask, window)), frame.shape)
    return tile(pictures, columns=2)


def figure5(results: Mapping[str, tuple[Frame, Segmentation]]) -> Color:
    """Draw the segmented objects of each frame. All images are resized to the size of the first frame.

    results: frame and segmentation result, indexed by the title of the image.
    """
    shape = next(iter(results.values()))[0].shape
    pictures = {
        f"{name}, {result.preset}: {len(result)} objects": _enlarge(result.overlay(), shape)
        for name, (frame, result) in results.items()
    }
    return tile(pictures, columns=min(len(pictures), 3))


def side_view(depth: DepthMap, color: Color, camera: Camera, window: Window) -> Color:
    """Draw the points of a rectangular part of a depth map as seen from the side, on a white background."""
    y0, x0, y1, x1 = window
    inside = np.zeros(depth.shape, bool)
    inside[y0:y1, x0:x1] = True
    inside &= depth > 0
    picture = np.full((*depth.shape, 3), 255, np.uint8)
    points = camera.back_project(depth, inside).astype(np.float64)
    if len(points) < 3:
        return picture
    middle = np.median(points, axis=0)
    near = np.abs(points - middle).max(axis=1) < 4 * np.median(np.abs(points - middle).max(axis=1))
    points, tint = (points - middle)[near], color[inside][near]
    turn = np.deg2rad(TURN_DEG)
    across = np.cos(turn) * points[:, 0] - np.sin(turn) * points[:, 2]
    away = np.sin(turn) * points[:, 0] + np.cos(turn) * points[:, 2]
    height, width = depth.shape
    reach = np.percentile(np.abs(np.stack([across / width, points[:, 1] / height])), 99.5, axis=1).max()
    scale = 0.47 / max(reach, 1e-9)
    order = np.argsort(-away)
    u = np.round(width / 2 + scale * across[order]).astype(int)
    v = np.round(height / 2 + scale * points[order, 1]).astype(int)
    for dy, dx in ((0, 0), (0, 1), (1, 0), (1, 1)):
        seen = (u + dx >= 0) & (u + dx < width) & (v + dy >= 0) & (v + dy < height)
        picture[v[seen] + dy, u[seen] + dx] = tint[order][seen]
    return picture


def _detail(difference: npt.NDArray[np.float32], shape: tuple[int, int]) -> Window:
    """Return the position of the detail with the largest mean value in a map (H, W)."""
    height, width = max(shape[0] // DETAIL_SHARE, 1), max(shape[1] // DETAIL_SHARE, 1)
    means = cv2.blur(np.minimum(difference, 0.05), (width, height))
    y, x = np.unravel_index(int(means.argmax()), means.shape)
    y0, x0 = int(np.clip(y - height // 2, 0, shape[0] - height)), int(np.clip(x - width // 2, 0, shape[1] - width))
    return y0, x0, y0 + height, x0 + width


def _around(window: Window, factor: float, shape: tuple[int, int]) -> Window:
    """Enlarge a rectangle by a factor about its centre, and clip it to an image of size (H, W)."""
    y0, x0, y1, x1 = window
    grow_y, grow_x = round((factor - 1) * (y1 - y0) / 2), round((factor - 1) * (x1 - x0) / 2)
    return max(y0 - grow_y, 0), max(x0 - grow_x, 0), min(y1 + grow_y, shape[0]), min(x1 + grow_x, shape[1])


def _busiest(result: Segmentation, edges: EdgeMaps) -> list[Window]:
    """Return rectangles around the objects with the largest shares of Canny pixels that are not boundaries."""
    removed = edges.canny & ~edges.final
    ranked = sorted(result, key=lambda o: np.count_nonzero(removed & o.mask) / o.area_px, reverse=True)
    return [_around(o.box_px, 1.3, removed.shape) for o in ranked[:CURVED]]


def _cut(image: npt.NDArray[Any], window: Window) -> npt.NDArray[Any]:
    y0, x0, y1, x1 = window
    return np.ascontiguousarray(image[y0:y1, x0:x1])


def _enlarge(picture: Color, shape: tuple[int, int]) -> Color:
    """Scale an image to the largest size that fits into (H, W) with the same aspect ratio, and fill the rest with
    white.
    """
    scale = min(shape[0] / picture.shape[0], shape[1] / picture.shape[1])
    height, width = max(int(scale * picture.shape[0]), 1), max(int(scale * picture.shape[1]), 1)
    out = np.full((*shape, 3), 255, np.uint8)
    top, left = (shape[0] - height) // 2, (shape[1] - width) // 2
    out[top : top + height, left : left + width] = cv2.resize(picture, (width, height), interpolation=cv2.INTER_NEAREST)
    return out


def _within(depth: DepthMap, like: DepthMap) -> DepthMap:
    """Limit the values of a depth map to the range of another depth map, so that both are drawn with the same colour
    scale. Missing depth stays 0.
    """
    if not like.any():
        return depth
    low, high = np.percentile(like[like > 0], [1, 99])
    return np.where(depth > 0, np.clip(depth, low, high), np.float32(0)).astype(np.float32)


def _blue_where_missing(depth: DepthMap) -> Color:
    """Return a depth map as a colour image, with missing depth in dark blue."""
    picture = depth_picture(depth)
    picture[missing_mask(depth)] = MISSING_BLUE
    return picture


def _grey(values: npt.NDArray[np.float32]) -> Color:
    return np.repeat(np.round(values * 255).astype(np.uint8)[..., None], 3, axis=2)


def _lines(mask: npt.NDArray[np.generic]) -> Color:
    """Return a mask (H, W) as an image (H, W, 3), white on black."""
    return np.repeat((np.asarray(mask) > 0).astype(np.uint8)[..., None] * np.uint8(255), 3, axis=2)
