"""Images and 3-D scene of the tuning page. The scene shows the point cloud of the frame, and above it one selected
image. The selected image is called the picture.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.frames.frame import Color, Frame, Mask
from spigolo.objects.boxes import OrientedBox
from spigolo.objects.drawing import draw_objects, palette
from spigolo.objects.facts import RegionFacts
from spigolo.objects.segmentation import ObjectMask, Segmentation
from spigolo.view.figure1 import weight_picture
from spigolo.view.overlay import (
    BOX_EDGES,
    boundary_picture,
    depth_picture,
    draw_boxes,
    fitted,
    region_picture,
)
from spigolo.view.tuning_session import Answer, Pixel

Vectors = npt.NDArray[np.float64]

STAGES = ("objects", "objects and boxes", "rejected regions", "boundary map", "weights", "regions", "depth", "colour")
"""Names of the images that the user can select. The selected image is shown in the 3-D scene and is called the picture.
"""
CHOSEN, REFUSED = (255, 214, 10), (235, 64, 52)
"""RGB colours of the selected object or region (yellow), and of rejected regions (red)."""
FAR = 1.6
"""Maximum depth of points in the cloud, as a multiple of the median depth of the frame."""
MOST_POINTS = 80_000
"""Approximate maximum number of points in the cloud."""
GAP = 0.08
"""Vertical distance between the picture and the point cloud, as a share of the height of the picture."""
PORTRAIT = 0.9
"""Maximum width divided by height of a browser window that counts as a phone in portrait format."""
FOV = 0.7
"""Vertical field of view of the camera of the 3-D scene, in radians."""
CLICK = 0.012
"""Maximum angle between the ray of a click and a point of the cloud, in radians. A click does not select points at a
larger angle.
"""


def picture(answer: Answer, stage: str, chosen: RegionFacts | None = None) -> Color:
    """Draw the image named `stage` (one of `STAGES`) for a segmentation result. The object or region that the user has
    selected is outlined.
    """
    drawn = fitted(_stage(answer, stage), answer.run.frame.shape).copy()
    if chosen is not None:
        _outline(drawn, chosen, CHOSEN)
    return drawn


def _stage(answer: Answer, stage: str) -> Color:
    run, result = answer.run, answer.result
    frame = run.frame
    drawn: dict[str, Callable[[], Color]] = {
        "objects": lambda: _objects(result),
        "objects and boxes": lambda: draw_boxes(_objects(result), result, frame.camera),
        "rejected regions": lambda: _rejected(result),
        "boundary map": lambda: boundary_picture(run),
        "weights": lambda: weight_picture(run.graph.weights),
        "regions": lambda: region_picture(result.regions.labels),
        "depth": lambda: depth_picture(frame.depth),
        "colour": lambda: frame.color,
    }
    return drawn[stage]()


def _objects(result: Segmentation) -> Color:
    """Draw `Segmentation.overlay` of a result, but with a brighter background."""
    drawn, behind = result.overlay(), result.labels == 0
    near = cv2.dilate((~behind).astype(np.uint8), np.ones((9, 9), np.uint8)) > 0  # pixels near outlines and numbers
    plain = (0.7 * result.frame.color).astype(np.uint8)
    return np.where((behind & ~near)[..., None], plain, drawn)


def _rejected(result: Segmentation) -> Color:
    """Draw each rejected region in its own colour. Objects keep the colours of the colour image."""
    drawn = draw_objects(result.frame.color, {k: r.mask for k, r in enumerate(result.rejected, start=1)})
    on = result.labels > 0
    drawn[on] = result.frame.color[on]
    return drawn


def _outline(drawn: Color, region: RegionFacts, color: tuple[int, int, int]) -> None:
    """Draw the outline of an object or rejected region into an image, which is changed in place. A rejected region is
    also tinted red.
    """
    mask, width = region.mask, max(2, round(drawn.shape[0] / 160))
    if not isinstance(region, ObjectMask):
        drawn[mask] = (0.55 * drawn[mask] + 0.45 * np.array(REFUSED)).astype(np.uint8)
    outlines, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(drawn, outlines, -1, (20, 20, 20), width + 2, cv2.LINE_AA)
    cv2.drawContours(drawn, outlines, -1, color, width, cv2.LINE_AA)


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """Positions of the picture and the point cloud of a frame in the 3-D scene, in metres.

    The axes of the scene are the axes of the camera: X right, Y down, Z forward.
    """

    size: tuple[float, float]
    """Width and height of the picture, in metres."""
    board: Vectors
    """Centre (3,) of the picture, in metres."""
    middle: Vectors
    """Centre (3,) of the point cloud, in metres."""
    points: npt.NDArray[np.float32]
    """Points (N, 3) of the cloud, in metres. The cloud contains only some of the pixels."""
    rows: npt.NDArray[np.intp]
    """Image row (N,) of each point."""
    columns: npt.NDArray[np.intp]
    """Image column (N,) of each point."""
    shape: tuple[int, int]
    """Size (H, W) of the image in pixels."""

    def pixel_at(self, origin: Vectors, direction: Vectors) -> Pixel | None:
        """Return the pixel (y, x) at which a ray meets the picture or the point cloud. Return None if the ray meets
        neither of them.
        """
        along = (self.board[2] - origin[2]) / direction[2] if direction[2] else -1.0
        x, y = (origin + along * direction - self.board)[:2] / self.size + 0.5
        if along > 0 and 0 <= x < 1 and 0 <= y < 1:
            return int(y * self.shape[0]), int(x * self.shape[1])
        return self._nearest(origin, direction)

    def _nearest(self, origin: Vectors, direction: Vectors) -> Pixel | None:
        away = self.points - origin
        along = away @ (direction / np.linalg.norm(direction))
        apart = np.sqrt(np.maximum((away**2).sum(axis=1) - along**2, 0))
        hit = np.flatnonzero((along > 0) & (apart < CLICK * along))
        if not hit.size:
            return None
        k = hit[np.argmin(along[hit])]
        return int(self.rows[k]), int(self.columns[k])

    def look(self, view: str, aspect: float) -> tuple[Vectors, Vectors]:
        """Return the position (3,) of the camera of the 3-D scene, and the point (3,) at which the camera looks, in
        metres.

        - view: part of the scene that fills the browser window: "picture", "cloud" or "both".
        - aspect: width divided by height of the browser window. On a phone (aspect at most 0.9), the picture is shown
          above the controls.
        """
        (width, height), wanted = self.size, view if len(self.points) else "picture"
        lift = np.zeros(3)
        if wanted == "cloud":
            target, away = self.middle, distance(width, height, aspect)
            lift[:2] = 0.15 * width, -0.55 * height
        elif wanted == "both" and aspect > PORTRAIT:
            target, away = (self.board + self.middle) / 2, distance(width, (2 + GAP) * height, aspect)
        else:
            target, away = self.board, distance(width, height, aspect)
        if aspect <= PORTRAIT:
            seen = 2 * away * np.tan(FOV / 2)
            target = target + np.array([0, 0.47 * seen - height / 2, 0])
        return target + lift - [0, 0, away], target


def distance(width: float, height: float, aspect: float) -> float:
    """Return the distance from the camera at which a rectangle fills the browser window. All lengths are in metres.

    aspect: width divided by height of the browser window.
    """
    return float(1.04 * max(height, width / aspect) / 2 / np.tan(FOV / 2))


def stand_of(frame: Frame) -> Stand:
    """Compute the positions of the picture and the point cloud of a frame. Without intrinsics, the cloud has no
    points.
    """
    height, width = frame.shape
    if frame.camera is None or not (frame.depth > 0).any():
        middle, none = np.array([0, 0, 1.0]), np.zeros(0, np.intp)
        return Stand((1.0, height / width), middle, middle, np.zeros((0, 3), np.float32), none, none, frame.shape)
    chosen = _some(frame)
    points = frame.camera.back_project(frame.depth, chosen).astype(np.float32)
    rows, columns = np.nonzero(chosen)
    camera, away = frame.camera, float(np.median(points[:, 2]))
    size = away * width / camera.fx, away * height / camera.fy
    middle = away * np.array([(width / 2 - camera.cx) / camera.fx, (height / 2 - camera.cy) / camera.fy, 1])
    board = middle - [0, (1 + GAP) * size[1], 0]
    return Stand(size, board, middle, points, rows, columns, frame.shape)


def _some(frame: Frame) -> Mask:
    """Return the mask (H, W) of the pixels that are shown in the point cloud."""
    stride = max(round(np.sqrt(frame.depth.size / MOST_POINTS)), 1)
    chosen = np.zeros(frame.shape, bool)
    chosen[::stride, ::stride] = True
    measured = frame.depth > 0
    return np.asarray(chosen & measured & (frame.depth < FAR * np.median(frame.depth[measured])))


def cloud_colors(answer: Answer, stand: Stand, chosen: RegionFacts | None) -> npt.NDArray[np.uint8]:
    """Return the colours (N, 3) uint8 of the points of the cloud. Points of objects are tinted, points of the selection
    are highlighted, and other points are darkened.
    """
    labels = answer.result.labels[stand.rows, stand.columns]
    color = answer.run.frame.color[stand.rows, stand.columns].astype(np.float32)
    tints = np.vstack([np.zeros((1, 3)), palette(len(answer.result))])
    mixed = np.where((labels > 0)[:, None], 0.45 * color + 0.55 * tints[labels], 0.6 * color)
    if chosen is not None:
        on = answer.result.regions.labels[stand.rows, stand.columns] == chosen.region
        mixed[on] = 0.3 * color[on] + 0.7 * np.array(CHOSEN if isinstance(chosen, ObjectMask) else REFUSED)
    return mixed.astype(np.uint8)


def box_lines(boxes: Sequence[OrientedBox | None]) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.uint8]]:
    """Return the end points (N, 2, 3) in metres, and the colours (N, 2, 3), of all edges of the oriented boxes of all
    objects.
    """
    ends, colors = [], []
    for box, tint in zip(boxes, palette(len(boxes)), strict=True):
        if box is not None:
            corners = box.corners_m()
            ends.append(corners[np.array(BOX_EDGES)])
            colors.append(np.broadcast_to(tint, (len(BOX_EDGES), 2, 3)))
    if not ends:
        return np.zeros((0, 2, 3), np.float32), np.zeros((0, 2, 3), np.uint8)
    return np.concatenate(ends).astype(np.float32), np.concatenate(colors).astype(np.uint8)
