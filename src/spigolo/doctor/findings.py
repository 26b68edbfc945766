"""Findings, which are the results of the checks."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Severity(str, Enum):
    """Severity of a finding. OK: the result is as expected. NOTE: useful information, or a check that is not possible
    with this frame. WARNING: a fault to fix.
    """

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of one check.

    check: name of the check. sentence: result of the check as text. The text of a warning states the expected value,
    the found value and how to fix the fault.
    """

    check: str
    severity: Severity
    sentence: str
    judged: bool = True
    """False if the check is not possible with this frame, for example because the frame has no large plane."""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """Findings of all checks of a frame, in the order in which the checks run."""

    findings: tuple[Finding, ...]

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """Return the findings with the severity WARNING."""
        return tuple(f for f in self.findings if f.severity is Severity.WARNING)

    @property
    def unjudged(self) -> tuple[Finding, ...]:
        """Return the findings of the checks that were not possible with this frame."""
        return tuple(f for f in self.findings if not f.judged)


COST, INTRINSICS = "cost function", "intrinsics"


def fine(check: str, sentence: str) -> Finding:
    """Return a finding with the severity OK."""
    return Finding(check, Severity.OK, sentence)


def note(check: str, sentence: str, *, judged: bool = True) -> Finding:
    """Return a finding with the severity NOTE. judged: False if the check is not possible with this frame, for example
    because the frame has no large plane.
    """
    return Finding(check, Severity.NOTE, sentence, judged)


def warning(check: str, sentence: str) -> Finding:
    """Return a finding with the severity WARNING."""
    return Finding(check, Severity.WARNING, sentence)
