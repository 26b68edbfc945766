"""The result of a check."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Severity(str, Enum):
    """OK: as expected. NOTE: worth knowing, or not to be judged. WARNING: mend this first."""

    OK = "ok"
    NOTE = "note"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Finding:
    """The result of one check.

    check: its name. sentence: a short statement. A warning says what was expected, what was found and how to mend it.
    """

    check: str
    severity: Severity
    sentence: str
    judged: bool = True
    """False if the frame lacks the evidence for this check."""


@dataclass(frozen=True, slots=True)
class Diagnosis:
    """All findings of a frame, in the order of the checks."""

    findings: tuple[Finding, ...]

    @property
    def warnings(self) -> tuple[Finding, ...]:
        """The findings to mend first."""
        return tuple(f for f in self.findings if f.severity is Severity.WARNING)

    @property
    def unjudged(self) -> tuple[Finding, ...]:
        """The checks that lacked evidence."""
        return tuple(f for f in self.findings if not f.judged)

    @property
    def advice(self) -> str:
        """Which cost function fits the frame, and why."""
        return next((f.sentence for f in self.findings if f.check == COST), "")


COST, INTRINSICS = "cost function", "intrinsics"


def fine(check: str, sentence: str) -> Finding:
    """A finding that is as expected."""
    return Finding(check, Severity.OK, sentence)


def note(check: str, sentence: str, *, judged: bool = True) -> Finding:
    """A finding worth knowing. judged: False where the frame lacks the evidence."""
    return Finding(check, Severity.NOTE, sentence, judged)


def warning(check: str, sentence: str) -> Finding:
    """A finding to mend."""
    return Finding(check, Severity.WARNING, sentence)
