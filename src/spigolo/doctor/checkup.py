"""Function `diagnose`, which runs all checks on a frame."""

from __future__ import annotations

from importlib import metadata

from spigolo.doctor.alignment import check_alignment
from spigolo.doctor.findings import COST, INTRINSICS, Diagnosis, Finding, Severity, fine, note, warning
from spigolo.doctor.intrinsics import check_focal_length, check_intrinsics
from spigolo.doctor.measured import check_missing, check_negative, check_reach, check_unit
from spigolo.doctor.planarity import PLANARITY, check_planarity, check_support
from spigolo.doctor.steps import check_saturated, check_steps
from spigolo.frames.frame import Camera, DepthMap, Frame, check_frame
from spigolo.settings.paper import AutoCost, Inpainting
from spigolo.stages.depth import inpaint_small_gaps, missing_mask, missing_share

CV2_WHEELS = (
    "opencv-python",
    "opencv-python-headless",
    "opencv-contrib-python",
    "opencv-contrib-python-headless",
)
SMALL_PX = 160
"""Minimum width and height of an image, in pixels. In smaller images, objects are only a few pixels large."""
WITHOUT_INTRINSICS = (
    "expected intrinsics, got none: results in metres, the support plane and contact boundaries are left out. Give"
    " --camera. With an estimate such as 60deg, far more objects are found than without intrinsics"
)
AFTER_UNIT = "not checked, because the unit of depth is probably wrong"
BORDER = 0.1
"""If holes that reach the image border cover more than this share of the frame, the advice on the cost function
mentions the share.
"""


def diagnose(frame: Frame) -> Diagnosis:
    """Run all checks on a frame and return the findings, without printing. The checks take about 0.3 s for 640x480
    pixels.

    A check that is not possible with this frame returns a note. If a frame has no depth, the checks that need depth are
    left out.
    """
    check_frame(frame)
    camera: Camera | None = frame.camera
    filled = inpaint_small_gaps(frame.depth, Inpainting().at_size(frame.shape))
    findings = [check_wheels(), check_size(frame), check_negative(frame), check_reach(frame)]
    findings += check_missing(frame.depth, filled)
    if not (frame.depth > 0).any():
        return Diagnosis((*findings, note(COST, "no cost function can be recommended: the frame has no depth")))
    unit = check_unit(frame, filled)
    findings += [unit, check_steps(frame.depth), check_saturated(frame.depth)]
    findings.append(check_alignment(frame.color, filled))
    if camera is None:
        findings.append(warning(INTRINSICS, WITHOUT_INTRINSICS))
    else:
        findings += [check_intrinsics(camera), check_focal_length(filled, camera)]
        wrong_unit = unit.severity is Severity.WARNING
        findings.append(note(PLANARITY, AFTER_UNIT, judged=False) if wrong_unit else check_planarity(filled, camera))
        if not wrong_unit:
            findings.append(check_support(frame.depth, camera))
    return Diagnosis((*findings, advise_cost(filled)))


def check_wheels() -> Finding:
    """Check that only one OpenCV wheel is installed. Several wheels overwrite each other's files in the folder cv2."""
    present = [name for name in CV2_WHEELS if _is_installed(name)]
    if len(present) < 2:
        return fine("opencv", f"one OpenCV wheel: {', '.join(present) or 'not from pip'}")
    keep = "opencv-contrib-python-headless" if any("contrib" in name for name in present) else "opencv-python-headless"
    return warning(
        "opencv",
        f"expected one OpenCV wheel, found {', '.join(present)}, which overwrite each other's files:"
        f" pip uninstall -y {' '.join(present)} && pip install {keep}",
    )


def check_size(frame: Frame) -> Finding:
    """Check that the images of a frame are not too small."""
    height, width = frame.depth.shape
    if min(height, width) < SMALL_PX:
        return note(
            "size", f"{width}x{height}: in an image smaller than {SMALL_PX} px, objects are only a few pixels large"
        )
    return fine("size", f"colour and depth have {width}x{height} pixels")


def advise_cost(filled: DepthMap) -> Finding:
    """Return a finding that recommends the cost function that `AutoCost` chooses for a frame. filled: depth map (H, W)
    in metres, in which small gaps are in-painted.
    """
    auto, inside = AutoCost(), missing_share(filled)
    elsewhere = float(missing_mask(filled).mean()) - inside
    where = f"{inside:.1%} of the frame lacks depth inside the working range"
    left_out = f"; {elsewhere:.0%} in holes that reach the image border is not counted" if elsewhere > BORDER else ""
    if inside <= auto.max_missing:
        why = f"{where}, and up to {auto.max_missing:.0%} counts as full depth"
        return fine(COST, f"cost.kind = auto chooses the second cost function (depth and boundaries): {why}{left_out}")
    why = f"{where}, and more than {auto.max_missing:.0%} counts as large shadows"
    return fine(COST, f"cost.kind = auto chooses the first cost function (colour, depth and saliency): {why}{left_out}")


def _is_installed(name: str) -> bool:
    try:
        metadata.version(name)
    except metadata.PackageNotFoundError:
        return False
    return True
