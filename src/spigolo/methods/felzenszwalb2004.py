"""Felzenszwalb & Huttenlocher 2004, *Efficient Graph-Based Image Segmentation*.

This method uses only colour. Edge weights are computed by equation 1, and pixels are merged into regions by equations 2
and 3.
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
    """Parameters of the method `felzenszwalb2004`. Colours range from 0 to 255."""

    sigma_px: NotNegative = 0.8
    """Standard deviation of the Gaussian smoothing of colour, in pixels. With the value 0, colour is not smoothed. The
    default is that of the paper.
    """
    k: NotNegative = 800.0
    """Threshold gamma of equation 3, in colour levels times pixels. Larger values make larger regions. The paper uses
    values from 150 to 500. Of several values tested on real frames, the default gave the best segmentation.
    """
    k_xy: NotNegative = 0.0
    """Weight of the pixel coordinates in equation 1: the colour difference with the same effect as a distance of one
    pixel. With 0, edge weights depend only on colour, as in the paper of Felzenszwalb & Huttenlocher 2004. The paper of
    Toscana & Rosa 2016 gives the weight 1.
    """
    connectivity: Literal[4, 8] = 8
    """Number of neighbours of a pixel, 4 or 8. The paper uses 8 neighbours."""
    min_size_px2: Area_px2 = 1500.0
    """Minimum area of a region, px^2. Each smaller region is merged with the neighbouring region to which its graph
    edge of lowest weight leads.
    """


@dataclass(frozen=True)
class Felzenszwalb2004(Baseline[FelzenszwalbConfig]):
    """Segmentation by merging pixels with small colour differences."""

    name = "felzenszwalb2004"
    config: FelzenszwalbConfig = field(default_factory=FelzenszwalbConfig)

    def graph(self, frame: Frame) -> Graph:
        """Eq. 1. Return the graph whose edge weights are colour differences of neighbouring pixels."""
        features = color_features(frame.color, self.config.sigma_px)
        return feature_graph(features, self.config.connectivity, self.config.k_xy)

    def divide(self, frame: Frame) -> Division:
        """Return the regions of a frame. Pixels are merged into regions by comparing edge weights with internal
        differences (equations 2, 3).
        """
        graph = self.graph(frame)
        config = self.config.at_size(frame.shape)
        return Division(partition(graph, config.k, config.min_size_px2), weight_contour(graph))
