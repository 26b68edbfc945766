"""Felzenszwalb & Huttenlocher 2004, *Efficient Graph-Based Image Segmentation*: what the paper starts from.

Colour alone. Weights by eq. 1, regions by eqs. 2 and 3.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from spigolo.frames.frame import Frame
from spigolo.methods.baseline import Baseline, Division, MethodConfig
from spigolo.methods.features import color_features, feature_graph
from spigolo.objects.facts import weight_contour
from spigolo.settings.parameters import Area_px2, NotNegative
from spigolo.stages.graph import Graph
from spigolo.stages.regions import partition


class FelzenszwalbConfig(MethodConfig):
    """Parameters of `felzenszwalb2004`. Colours are 0..255."""

    sigma_px: NotNegative = 0.8
    """Gaussian smoothing of each channel (their paper, section 5). 0 smooths nothing."""
    k: NotNegative = 800.0
    """Threshold gamma of eq. 3, colour difference times pixels. A larger k makes larger regions (their paper: 150 to
    500; ours is the best of a few for whole objects on real frames).
    """
    k_xy: NotNegative = 0.0
    """Weight of a pixel's coordinates in eq. 1. Printed there among the features, which is 1. The cited method has none
    on a grid, because they would add the same to all edges of a direction (our reading).
    """
    connectivity: Literal[4, 8] = 8
    """Neighbours of a pixel (their paper)."""
    min_size_px2: Area_px2 = 1500.0
    """Smaller regions are joined to the neighbour over their lightest edge (found as k was)."""


@dataclass(frozen=True)
class Felzenszwalb2004(Baseline[FelzenszwalbConfig]):
    """Merging of pixels by colour difference."""

    name = "felzenszwalb2004"
    config: FelzenszwalbConfig = field(default_factory=FelzenszwalbConfig)

    def graph(self, frame: Frame) -> Graph:
        """Eq. 1. Its edges weigh the colour difference of their ends."""
        features = color_features(frame.color, self.config.sigma_px)
        return feature_graph(features, self.config.connectivity, self.config.k_xy)

    def divide(self, frame: Frame) -> Division:
        """Regions by internal difference."""
        graph = self.graph(frame)
        config = self.config.at_size(frame.shape)
        return Division(partition(graph, config.k, config.min_size_px2), weight_contour(graph))
