"""Images that show objects over the colour image, depth maps, boundaries or regions."""

from __future__ import annotations

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Camera, Color, DepthMap
from spigolo.objects.drawing import FONT, INK, draw_numbers, palette
from spigolo.objects.segmentation import Segmentation
from spigolo.pipeline import Trace

BOX_EDGES = ((0, 1), (0, 2), (0, 4), (1, 3), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 6), (5, 7), (6, 7))


def draw_boxes(picture: Color, result: Segmentation, camera: Camera | None) -> Color:
    """Return a copy of an image in which the edges of the oriented boxes of all objects are drawn. Without intrinsics,
    no boxes are drawn.
    """
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
    draw_numbers(drawn, {o.label: o.mask for o in result})  # numbers are drawn last, so that no line hides them
    return drawn


def depth_picture(depth: DepthMap) -> Color:
    """Return a depth map (H, W) as a colour image: near pixels are red, far pixels blue, and missing pixels black.

    The colour scale is linear in 1 / depth, from the 1st to the 99th percentile of 1 / depth.
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


def boundary_picture(trace: Trace) -> Color:
    """Draw boundaries over the Canny edges. If the cost function uses saliency instead of boundaries, draw the saliency
    map.

    Contours from the depth map are white. Canny edges that are depth or contact boundaries are orange. The remaining
    Canny edges are grey.
    """
    if trace.edges is None:
        level = np.round(trace.cues.delta_sal * 255).astype(np.uint8)
        return np.repeat(level[..., None], 3, axis=2)
    picture = np.full((*trace.edges.canny.shape, 3), 30, np.uint8)
    picture[trace.edges.canny] = 110
    if trace.contours is not None and trace.contours.contours is not None:
        picture[trace.contours.contours] = 235
    picture[trace.edges.final] = (255, 150, 30)
    return picture


def region_picture(labels: npt.NDArray[np.int32]) -> Color:
    """Return a label image (H, W) as a colour image with one colour for each label."""
    return np.asarray(palette(int(labels.max(initial=0)) + 1)[labels])


def tile(pictures: dict[str, Color], columns: int) -> Color:
    """Return a grid of images with titles. All images are scaled to the size of the first image.

    pictures: images (H, W, 3), indexed by title.
    """
    shape = next(iter(pictures.values())).shape[:2]
    titled = [_titled(fitted(picture, shape), title) for title, picture in pictures.items()]
    titled += [np.full_like(titled[0], 255)] * (-len(titled) % columns)
    rows = [np.hstack(titled[k : k + columns]) for k in range(0, len(titled), columns)]
    return np.vstack(rows)


def fitted(picture: Color, shape: tuple[int, ...]) -> Color:
    """Scale an image to the size (H, W) without interpolation."""
    if picture.shape[:2] == shape:
        return picture
    return np.asarray(cv2.resize(picture, shape[::-1], interpolation=cv2.INTER_NEAREST), np.uint8)


def _titled(picture: Color, title: str) -> Color:
    height = max(24, picture.shape[0] // 18)
    strip = np.full((height, picture.shape[1], 3), 255, np.uint8)
    cv2.putText(strip, title, (6, round(height * 0.72)), FONT, height / 42, INK, 1, cv2.LINE_AA)
    return np.pad(np.vstack([strip, picture]), ((2, 2), (2, 2), (0, 0)), constant_values=255)
