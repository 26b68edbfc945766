"""Texts of the tuning page in Markdown."""

from __future__ import annotations

from spigolo.objects.boxes import OrientedBox
from spigolo.objects.segmentation import ObjectMask, RejectedRegion
from spigolo.view.tuning_session import Answer, Session

HINT = "Click an object or any other region, in the picture or the cloud."
MERGE_HINT = "Now click the region to merge with."


def status(answer: Answer, session: Session) -> str:
    """Return the status text of a result: numbers of objects and rejected regions, time, frame, corrections and
    warnings.
    """
    found = count(len(answer.result), "object")
    frame = answer.run.frame
    known = session.reel.count
    place = f"frame {answer.position + 1}{'' if known is None else f' of {known}'}" if known != 1 else ""
    parts = [part for part in (place, frame.name, f"{len(answer.result.rejected)} rejected") if part]
    lines = [f"### {found} · {answer.wall_s * 1000:.0f} ms", " · ".join(parts)]
    if session.corrections:
        lines.append(f"{count(len(session.corrections), 'correction')} by hand")
    if answer.result.left_out:
        lines.append(f"No intrinsics. Left out: {', '.join(answer.result.left_out)}.")
    return "  \n".join([*lines[:1], "\n" + "  \n".join([*lines[1:], *(f"⚠ {note}" for note in answer.notes)])])


def trouble(error: Exception) -> str:
    """Return the status text for an error."""
    return f"### ⚠ No result\n\n{error}"


def selection(region: ObjectMask | RejectedRegion | None, merging: bool) -> str:
    """Return a text about the selected object or region.

    merging: True if the user must now click a second region.
    """
    if region is None:
        return HINT
    title = f"**Object {region.label}**" if isinstance(region, ObjectMask) else f"**Rejected**: {region.why}"
    return f"{title}  \n{MERGE_HINT if merging else facts(region)}"


def line(region: ObjectMask | RejectedRegion, box: OrientedBox | None) -> str:
    """Return the text of a button in the list of objects or of rejected regions. box: oriented box of the object."""
    if isinstance(region, RejectedRegion):
        return f"{region.reason.value} · {region.area_px} px"
    size = "" if box is None else " · " + " × ".join(f"{100 * v:.0f}" for v in box.size_m) + " cm"
    return f"{region.label} · score {region.score:.2f}{size}"


def facts(region: ObjectMask | RejectedRegion) -> str:
    """Return a text with the most important measurements of a region."""
    parts = [f"{region.area_px} px", f"mean boundary {region.contour:.2f}", f"missing depth {region.missing:.0%}"]
    if region.above is not None:
        parts.append(f"above plane {region.above:.0%}")
    if region.distance_m is not None:
        parts.append(f"{region.distance_m:.2f} m away")
    return " · ".join(parts)


def times(answer: Answer) -> str:
    """Return the time of each stage as a Markdown table."""
    rows = [f"| {name} | {1000 * spent:.1f} |" for name, spent in answer.stages_s.items()]
    head = f"**{answer.wall_s * 1000:.0f} ms** for this frame, without drawing the page."
    return "\n".join([head, "", "| stage | ms |", "|:--|--:|", *rows])


def count(number: int, name: str) -> str:
    """Return a text with a number and a noun. The noun is in the singular or plural."""
    return f"{number} {name}{'' if number == 1 else 's'}"
