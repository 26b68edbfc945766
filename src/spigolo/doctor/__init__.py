"""Checks of a frame: image size, depth unit, missing depth, alignment and intrinsics. The checks also advise which cost
function fits the frame.
"""

from spigolo.doctor.checkup import diagnose
from spigolo.doctor.findings import Diagnosis, Finding, Severity

__all__ = ["Diagnosis", "Finding", "Severity", "diagnose"]
