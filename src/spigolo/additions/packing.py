"""Warning if a layer of packed objects was mistaken for the support plane (`settings.Packing`)."""

from __future__ import annotations

import cv2
import numpy as np

from spigolo.additions.plane import Plane, support_mask, things_on
from spigolo.errors import warn
from spigolo.frames.frame import Camera, DepthMap
from spigolo.settings.additions import Additions
from spigolo.settings.support import Packing, Support
from spigolo.stages.edges import EdgeMaps

PART = 32
"""A pixel of the support plane counts as close to an image edge if a square around the pixel contains an edge pixel.
The side length of the square is the image width divided by `PART`.
"""
OUTLINE_PX = 9
"""Side length in pixels of the square by which the mask of the support plane is eroded. After the erosion, image edges
at the outline of the mask are not counted.
"""


def warn_of_packing(
    edges: EdgeMaps | None, depth: DepthMap, camera: Camera | None, plane: Plane | None, config: Additions
) -> None:
    """Warn if the support plane looks like a layer of packed objects: it is large and has many image edges, but few
    objects.
    """
    support, rule = config.support, config.packing
    if rule is None or support is None or edges is None or plane is None or camera is None:
        return
    if is_packed(edges, depth, camera, plane, support, rule):
        warn(
            "the largest plane is covered with image edges, and almost no object stands on the plane. If the plane"
            " consists of packed objects, they were used as the support and are not returned. Objects with faces in one"
            " plane are not separated. Give a region of interest, or set additions.support.facing.up if the support is"
            " another plane"
        )


def is_packed(edges: EdgeMaps, depth: DepthMap, camera: Camera, plane: Plane, support: Support, rule: Packing) -> bool:
    """Return True if the support plane is large, has many image edges, and almost no objects stand on it."""
    if things_on(plane, depth, camera, support) > rule.max_things:
        return False
    on = support_mask(plane, depth, camera, support)
    count = np.count_nonzero(on)
    if count == 0 or count < rule.min_share * np.count_nonzero(depth):
        return False
    inner = cv2.erode(on.view(np.uint8), np.ones((OUTLINE_PX, OUTLINE_PX), np.uint8))
    size = max(depth.shape[1] // PART, 1)
    within = np.asarray(inner, np.uint8) > 0
    near = cv2.dilate((within & edges.canny).view(np.uint8), np.ones((size, size), np.uint8))
    return bool(np.count_nonzero(within & (near > 0)) >= rule.min_edges * max(int(np.count_nonzero(within)), 1))
