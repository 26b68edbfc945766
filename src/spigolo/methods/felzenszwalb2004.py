"""Felzenszwalb & Huttenlocher 2004, *Efficient Graph-Based Image Segmentation*, on which the paper builds.

The method uses only colour. Edge weights follow eq. 1, regions eqs. 2 and 3.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from spigolo.frames.frame import Frame
from spigolo.methods.baseline import Baseline, Division, MethodConfig
from spigolo.methods.features import color_features, feature_graph
from spigolo.objects.scores import weight_contour
from spigolo.settings.parameters import Area_px2, NotNegative
from spigolo.stages.graph import Graph
from spigolo.stages.regions import partition


class FelzenszwalbConfig(MethodConfig):
    """Parameters of `felzenszwalb2004`. Colours are 0..255."""

    sigma_px: NotNegative = 0.8
    """Sigma of the Gaussian smoothing of each channel, px (their paper, section 5). 0 does not smooth."""
    k: NotNegative = 800.0
    """Threshold gamma of eq. 3, colour difference times pixels. Larger values make larger regions. Their paper uses 150
    to 500. Ours was the best of several values for whole objects on real frames.
    """
    k_xy: NotNegative = 0.0
    """Weight of a pixel's coordinates in eq. 1. As printed it is 1. The cited method has no coordinates on a grid, as
    they would add a constant to all edges of one direction (our reading).
    """
    connectivity: Literal[4, 8] = 8
    """Number of neighbours of a pixel (their paper)."""
    min_size_px2: Area_px2 = 1500.0
    """Minimum area of a region, px^2. Smaller regions join a neighbour across their lightest edge (chosen like `k`)."""


@dataclass(frozen=True)
class Felzenszwalb2004(Baseline[FelzenszwalbConfig]):
    """Segmentation by merging pixels with small colour differences."""

    name = "felzenszwalb2004"
    config: FelzenszwalbConfig = field(default_factory=FelzenszwalbConfig)

    def graph(self, frame: Frame) -> Graph:
        """Eq. 1. Return the graph whose edge weights are colour differences."""
        features = color_features(frame.color, self.config.sigma_px)
        return feature_graph(features, self.config.connectivity, self.config.k_xy)

    def divide(self, frame: Frame) -> Division:
        """Divide the frame into regions by internal difference."""
        graph = self.graph(frame)
        config = self.config.at_size(frame.shape)
        return Division(partition(graph, config.k, config.min_size_px2), weight_contour(graph))
