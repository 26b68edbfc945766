"""Objects drawn over the colour image, and frames as pictures."""

from __future__ import annotations

import colorsys

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, Color, DepthMap
from spigolo.objects.segmentation import ObjectMask, Segmentation
from spigolo.stages.cues import Cues

GOLDEN_RATIO = 0.618034
FONT = cv2.FONT_HERSHEY_SIMPLEX
WHITE, INK = (255, 255, 255), (20, 20, 20)
BOX_EDGES = ((0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7))


def palette(count: int) -> npt.NDArray[np.uint8]:
    """Colours (count, 3) RGB that differ well from their neighbours in number."""
    hues = [(0.02 + k * GOLDEN_RATIO) % 1.0 for k in range(count)]
    colors = [colorsys.hsv_to_rgb(h, 0.75 if k % 2 else 0.9, 1.0 if k % 2 else 0.92) for k, h in enumerate(hues)]
    return np.round(np.array(colors, np.float64).reshape(-1, 3) * 255).astype(np.uint8)


def overlay(result: Segmentation, color: Color) -> Color:
    """The colour image (H, W, 3) with the background dimmed, each object tinted, outlined and numbered."""
    picture = (color * np.float32(0.45)).astype(np.uint8)
    colors = palette(len(result))
    scale = _scale(color)
    for o in result:
        mask, tint = o.mask, colors[o.label - 1]
        picture[mask] = (0.6 * color[mask] + 0.4 * tint).astype(np.uint8)
        outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
        cv2.drawContours(picture, outlines, -1, tint.tolist(), max(1, round(2 * scale)), cv2.LINE_AA)
    _number_all(picture, result)
    return picture


def draw_boxes(picture: Color, result: Segmentation, camera: Camera | None) -> Color:
    """A copy of an overlay with the oriented box of each object as a wire frame; without intrinsics there is none."""
    drawn = picture.copy()
    if camera is None:
        return drawn
    for o, tint in zip(result, palette(len(result)), strict=True):
        box = o.oriented_box()
        if box is None:
            continue
        x, y, z = box.corners_m().T
        if z.min() <= 0:
            continue
        corners = np.stack([x / z * camera.fx + camera.cx, y / z * camera.fy + camera.cy], axis=1)
        for a, b in BOX_EDGES:
            ends = [tuple(int(v) for v in np.round(corners[k])) for k in (a, b)]
            cv2.line(drawn, ends[0], ends[1], INK, 3, cv2.LINE_AA)
            cv2.line(drawn, ends[0], ends[1], tint.tolist(), 1, cv2.LINE_AA)
    _number_all(drawn, result)  # no line may hide a number
    return drawn


def depth_picture(depth: DepthMap) -> Color:
    """Depth (H, W) in colours, near = red, far = blue, missing = black.

    Colours follow 1 / Z, as the camera's resolution does, between the 1st and 99th percentile.
    """
    valid = depth > 0
    if not valid.any():
        return np.zeros((*depth.shape, 3), np.uint8)
    closeness = 1 / np.where(valid, depth, np.inf)
    far, near = np.percentile(closeness[valid], [1, 99])
    level = np.clip((closeness - far) / max(near - far, 1e-6), 0, 1)
    picture = cv2.cvtColor(cv2.applyColorMap((level * 255).astype(np.uint8), cv2.COLORMAP_TURBO), cv2.COLOR_BGR2RGB)
    picture[~valid] = 0
    return np.asarray(picture, np.uint8)


def boundary_picture(cues: Cues) -> Color:
    """Boundaries in white and orange over the other Canny edges in grey; saliency where the cost reads that instead.

    White: from the depth map alone; orange: Canny edges that are depth or contact boundaries.
    """
    if cues.edges is None:
        level = np.round(cues.delta_sal * 255).astype(np.uint8)
        return np.repeat(level[..., None], 3, axis=2)
    picture = np.full((*cues.depth.shape, 3), 30, np.uint8)
    picture[cues.edges.canny] = 110
    if cues.edges.contours is not None:
        picture[cues.edges.contours] = 235
    picture[cues.edges.depth_boundary | cues.edges.contact_boundary] = (255, 150, 30)
    return picture


def region_picture(labels: npt.NDArray[np.int32]) -> Color:
    """A label image (H, W) with a colour for each label."""
    return np.asarray(palette(int(labels.max(initial=0)) + 1)[labels])


def tile(pictures: dict[str, Color], columns: int) -> Color:
    """Pictures of one size in a grid, each with its title."""
    titled = [_titled(picture, title) for title, picture in pictures.items()]
    titled += [np.full_like(titled[0], 255)] * (-len(titled) % columns)
    rows = [np.hstack(titled[k : k + columns]) for k in range(0, len(titled), columns)]
    return np.vstack(rows)


def _titled(picture: Color, title: str) -> Color:
    height = max(24, picture.shape[0] // 18)
    strip = np.full((height, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(strip, title, (6, round(height * 0.72)), FONT, height / 42, INK, 1, cv2.LINE_AA)
    return np.pad(np.vstack([strip, picture]), ((2, 2), (2, 2), (0, 0)), constant_values=255)


def _scale(picture: Color) -> float:
    return float(max(picture.shape[0] / 480, 0.5))


def _number_all(picture: Color, result: Segmentation) -> None:
    for o, tint in zip(result, palette(len(result)), strict=True):
        _number(picture, o, tint, _scale(picture))


def _number(picture: Color, o: ObjectMask, tint: npt.NDArray[np.uint8], scale: float) -> None:
    """The label in a disc at the innermost pixel, which lies on the object even where its centroid does not."""
    inside = cv2.distanceTransform(np.pad(o.mask, 1).astype(np.uint8), cv2.DIST_L2, 3)
    y, x = np.unravel_index(int(inside.argmax()), inside.shape)
    center = int(x) - 1, int(y) - 1
    text, size = str(o.label), 0.45 * scale
    (width, height), _ = cv2.getTextSize(text, FONT, size, 1)
    cv2.circle(picture, center, round(11 * scale), tint.tolist(), -1, cv2.LINE_AA)
    cv2.circle(picture, center, round(11 * scale), WHITE, 1, cv2.LINE_AA)
    cv2.putText(picture, text, (center[0] - width // 2, center[1] + height // 2), FONT, size, INK, 1, cv2.LINE_AA)
