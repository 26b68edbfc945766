"""Mean boundary value along the border of each region, and score of each region. The paper defines no score
(docs/score.md).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from spigolo.kernels import moments
from spigolo.stages.cues import Cues
from spigolo.stages.graph import Graph
from spigolo.stages.regions import Regions

SUPPORTED_SHARE = 3000 / (640 * 480)
"""Number of a region's measured pixels, divided by the number of image pixels, at which the factor 1 - exp(-measured /
`SUPPORTED_SHARE`) of the region's score is 63 %.
"""


def contour_cue(cues: Cues, graph: Graph) -> npt.NDArray[np.float32]:
    """Return a map (H, W) of boundary values from 0 to 1. If the cost function reads no boundary map, the values are
    computed from the edge weights.
    """
    return weight_contour(graph) if cues.boundary is None else cues.boundary


def weight_contour(graph: Graph) -> npt.NDArray[np.float32]:
    """Return a map (H, W) of boundary values from 0 to 1 that is computed from the edge weights of a graph.

    The value of a pixel is the larger weight of two graph edges: that to its right neighbour and that to its lower
    neighbour. The values of all pixels are divided by their 95th percentile and clipped to 1.
    """
    right, down = graph.weights[:2]
    largest = np.where(np.isinf(right), np.float32(0), right)
    np.maximum(largest, down, out=largest, where=np.isfinite(down))
    strong = float(np.percentile(largest, 95))
    return np.asarray(np.clip(largest / strong, 0, 1) if strong > 0 else largest, np.float32)


def contour_strength(regions: Regions, contour: npt.NDArray[np.float32]) -> npt.NDArray[np.float64]:
    """Return the mean value (R,) of the map `contour` (H, W) along the border of each region. The result is 0 for
    regions without neighbours.
    """
    sums = np.zeros((regions.count, 2))
    moments.sum_contours(regions.labels, contour, sums)
    return np.asarray(sums[:, 1] / np.maximum(sums[:, 0], 1))


def region_score(
    contour: npt.NDArray[np.float64], measured: npt.NDArray[np.float64], above: npt.NDArray[np.float64] | None
) -> npt.NDArray[np.float64]:
    """Return the score (R,) of each region, from 0 to 1. A high score means that the region is probably a whole object.

    The score is contour * (1 - exp(-measured / 0.0098)) * above, with the three arguments of this function. The score
    is high for a large region that lies above the support plane and has high boundary values along its border.

    - contour: mean boundary value (R,) along each region's border.
    - measured: number (R,) of each region's measured pixels, divided by the number of image pixels.
    - above: share (R,) of each region's measured pixels that lie above the support plane. The value is None if the
      frame has no support plane.
    """
    score = contour * (1 - np.exp(-measured / SUPPORTED_SHARE))
    return np.asarray(np.clip(score if above is None else score * above, 0, 1), np.float64)
