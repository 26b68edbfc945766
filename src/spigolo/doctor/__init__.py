"""Checks of a frame: image size, depth unit, missing depth, alignment and intrinsics. Advice on the cost function."""

from spigolo.doctor.checkup import diagnose
from spigolo.doctor.findings import Diagnosis, Finding, Severity

__all__ = ["Diagnosis", "Finding", "Severity", "diagnose"]
