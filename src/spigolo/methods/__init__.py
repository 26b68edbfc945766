"""Segmentation methods for comparison, including ours. Each takes a frame and returns a segmentation.

    import spigolo as sp

    sp.METHODS["rao2010"](frame)  # with its own parameters
    sp.METHODS["rao2010"].replace(k=200)(frame)

All methods return the same type, and their regions are judged by the same rules. `segment_around` is `mishra2009`,
which segments around a given point instead of a whole frame.
"""

from __future__ import annotations

from spigolo.methods.abramov2012 import Abramov2012, AbramovConfig
from spigolo.methods.baseline import Baseline, Division, MethodConfig
from spigolo.methods.felzenszwalb2004 import Felzenszwalb2004, FelzenszwalbConfig
from spigolo.methods.mishra2009 import FixationConfig, segment_around
from spigolo.methods.mishra2012 import Mishra2012, SimpleConfig
from spigolo.methods.protocol import Method
from spigolo.methods.rao2010 import Rao2010, RaoConfig
from spigolo.methods.toscana2016 import Toscana2016

__all__ = [
    "METHODS",
    "Abramov2012",
    "AbramovConfig",
    "Baseline",
    "Division",
    "Felzenszwalb2004",
    "FelzenszwalbConfig",
    "FixationConfig",
    "Method",
    "MethodConfig",
    "Mishra2012",
    "Rao2010",
    "RaoConfig",
    "SimpleConfig",
    "Toscana2016",
    "segment_around",
]

METHODS: dict[str, Method] = {
    method.name: method for method in (Toscana2016(), Felzenszwalb2004(), Rao2010(), Abramov2012(), Mishra2012())
}
"""Methods with default parameters, indexed by name. `replace` returns a method with other parameters."""
