"""Area of the support plane that a region surrounds. The rule `settings.Rim` uses the surrounded area to separate the
rims of bins and trays from objects.
"""

from __future__ import annotations

import cv2
import numpy as np

from spigolo.additions.plane import Plane, support_mask
from spigolo.frames.camera import Camera
from spigolo.frames.frame import DepthMap, Mask
from spigolo.settings.support import Support


def surrounded_support(region: Mask, plane: Plane, depth: DepthMap, camera: Camera, config: Support) -> float:
    """Return the area of the support plane inside the convex hull of a region, divided by the area of the region.

    - region: mask (H, W) of the region. Pixels of the region itself are not counted as support plane.
    - depth: depth map (H, W) in metres, 0 where missing.
    """
    outlines, _ = cv2.findContours(region.view(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    if not outlines:
        return 0.0
    hull = np.zeros(region.shape, np.uint8)
    cv2.fillConvexPoly(hull, cv2.convexHull(np.vstack(outlines)), 1)
    floor = support_mask(plane, depth, camera, config) & ~region
    return float(np.count_nonzero(hull.view(np.bool_) & floor) / np.count_nonzero(region))
