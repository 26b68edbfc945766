"""Checks of a frame: sizes, depth unit, missing depth, alignment, intrinsics, and which cost function fits."""

from spigolo.doctor.checkup import diagnose
from spigolo.doctor.findings import Diagnosis, Finding, Severity

__all__ = ["Diagnosis", "Finding", "Severity", "diagnose"]
