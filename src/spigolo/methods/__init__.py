"""Segmentation methods with a common interface, for comparisons. Every method is called with a frame and returns a
Segmentation.

    import spigolo as sp

    sp.METHODS["rao2010"](frame)  # with default parameters
    sp.METHODS["rao2010"].replace(k=200)(frame)

All methods use the same rules to reject regions. The method `mishra2009`, which segments only the object around a given
point, is the function `segment_around`.
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
"""Methods with default parameters, indexed by name. `METHODS[name].replace(...)` returns a method with other
parameters.
"""
