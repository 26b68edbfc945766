"""Share of a region's outline that lies on image edges. The rule `settings.Ledge` uses this share to tell flat objects
from noise of the support plane.
"""

from __future__ import annotations

import cv2
import numpy as np

from spigolo.frames.frame import Mask


def share_on_edges(region: Mask, edges: Mask, reach_px: int) -> float:
    """Return the share of a region's outline pixels that are at most `reach_px` rows and columns away from an edge.

    - region: mask (H, W) of the region. Pixels of the region on the image border belong to the outline.
    - edges: mask (H, W) of the Canny edges of the colour image.
    """
    size = 2 * reach_px + 1
    inner = cv2.erode(region.view(np.uint8), np.ones((3, 3), np.uint8), borderValue=0)
    outline = region & (np.asarray(inner) == 0)
    near = np.asarray(cv2.dilate(edges.view(np.uint8), np.ones((size, size), np.uint8))) > 0
    return int(np.count_nonzero(outline & near)) / max(int(np.count_nonzero(outline)), 1)
