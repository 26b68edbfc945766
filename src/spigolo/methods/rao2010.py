"""Rao et al., 2010, *Grasping Novel Objects with Depth Segmentation*: depth as a fourth channel in addition to R, G, B.

This module implements the segmentation, but not the trained classifier that selects graspable segments. Only a summary
of the paper was available, so details may differ from the paper. The scale of depth, the treatment of missing depth and
the default parameters are our interpretation.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from spigolo.frames.frame import Frame
from spigolo.methods.features import color_features, depth_feature, feature_graph
from spigolo.methods.felzenszwalb2004 import Felzenszwalb2004, FelzenszwalbConfig
from spigolo.settings.parameters import NotNegative
from spigolo.stages.graph import Graph


class RaoConfig(FelzenszwalbConfig):
    """Parameters of the method `rao2010`: the parameters of `felzenszwalb2004` and the scale of depth."""

    levels_per_m: NotNegative = 1200.0
    """Colour difference that corresponds to a depth difference of one metre, in levels of a colour channel. With the
    value 0, depth is ignored.
    """


@dataclass(frozen=True)
class Rao2010(Felzenszwalb2004):
    """Segmentation by merging pixels with small differences of colour and depth.

    The depth difference of an edge is 0 if depth is missing at one of its pixels (our interpretation).
    """

    name = "rao2010"
    config: RaoConfig = field(default_factory=RaoConfig)

    def graph(self, frame: Frame) -> Graph:
        """Return the graph whose edge weights are differences of colour and depth of neighbours (equation 1)."""
        config = self.config
        color = color_features(frame.color, config.sigma_px)
        depth = depth_feature(frame.depth, config.sigma_px, config.levels_per_m)
        return feature_graph(np.concatenate([color, depth[None]]), config.connectivity, config.k_xy)
