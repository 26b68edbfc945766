"""Checks of a frame: image size, depth unit, missing depth, alignment and intrinsics. The checks also recommend a cost
function, which computes the weights of graph edges in the segmentation.
"""

from spigolo.doctor.checkup import diagnose
from spigolo.doctor.findings import Diagnosis, Finding, Severity

__all__ = ["Diagnosis", "Finding", "Severity", "diagnose"]
