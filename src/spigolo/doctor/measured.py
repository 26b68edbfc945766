"""Checks of the measured depth: negative values, missing depth, and the unit."""

from __future__ import annotations

import math

import numpy as np

from spigolo.doctor.findings import Finding, fine, note, warning
from spigolo.doctor.local_planes import fit_local_planes
from spigolo.frames.frame import Camera, DepthMap, Frame
from spigolo.frames.nominal import NOMINAL
from spigolo.stages.depth import find_gaps, missing_mask, sampling_holes

MISSING, UNIT, REACH = "missing depth", "depth unit", "reach of depth"

FEW_BEYOND = 0.001
"""If at least this share of the pixels has a depth that no camera can measure, a warning is given. If fewer pixels have
such a depth, only a note is given.
"""

FEW_VALID = 0.02
"""Minimum share of pixels with measured depth in a frame. If fewer pixels have measured depth, a warning is given."""
MUCH_MISSING = 0.2
HOLES = 0.02
"""Sampling holes are gaps in depth that are one or two pixels wide. Sampling holes are reported if they contain more
than this share of the pixels.
"""

SCALES = {
    0.001: "stored millimetres",
    0.00025: "RealSense L515",
    0.000125: "eighths of a millimetre",
    0.0002: "TUM",
    0.0001: "0.1 mm",
}
"""Common depth units of cameras and data sets, in metres per unit."""
PLAUSIBLE = math.log(3.0)
"""A depth unit is advised only if it makes the median depth similar to `TABLE_M`. Similar means that the median depth
is less than 3 times as large, and more than a third as large, as `TABLE_M`. The constant is the logarithm of 3.
"""
CLOSEST_M, CLOSE_UNIT_M = 0.07, 1e-4
"""CLOSEST_M: minimum working distance of a RealSense D405, in metres. CLOSE_UNIT_M: depth unit of a RealSense D405, in
metres.
"""
SAME_VIEW = 0.05
NEAR_M, FAR_M = 0.2, 6.0
"""Minimum and maximum plausible median depth of a frame, in metres. A median depth outside of the range gives a
warning, or only a note if the camera may be a close-range camera.
"""
TABLE_M = 0.8
"""Typical distance of a table from the camera, in metres. The advice on a wrong depth unit assumes that the median
depth is near `TABLE_M`.
"""
COARSE_UNIT_M = 0.004
"""If the unit of the stored depth is at least this large, in metres, a warning is given. Cameras store depth in units
of 0.1 to 1 mm, and some drivers in units of 2 mm.
"""
FINEST_TICK_M = 1e-4
ROOM_M = 3.0
FINE_NOISE_PER_M = 2.5e-4
"""Minimum of the depth noise of a real camera divided by the squared distance, in 1/m. If a frame with a median depth
above `ROOM_M` has less noise, a warning about the depth unit is given.
"""


def check_negative(frame: Frame) -> Finding:
    """Check that no depth is negative. Negative values can result from a subtraction, a wrong integer type or a wrong
    coordinate axis.
    """
    if frame.negative_depth:
        return warning(
            "negative depth",
            f"expected depth of 0 or more, found {frame.negative_depth} negative pixels:"
            " store the Z coordinate (forward), as unsigned integers or as floating-point metres",
        )
    return fine("negative depth", "no pixel has negative depth")


def check_reach(frame: Frame) -> Finding:
    """Check for depths that no camera can measure. Return a warning if at least the share `FEW_BEYOND` of the pixels
    has a depth that no camera can measure.
    """
    found = frame.out_of_reach
    if found is not None:
        sentence = f"expected missing depth as 0, found that {found}: store 0 in pixels without a measurement"
        return note(REACH, sentence) if found.share < FEW_BEYOND else warning(REACH, sentence)
    return fine(REACH, "no pixel has the largest value of its type, or a depth beyond the reach of cameras")


def check_missing(depth: DepthMap, filled: DepthMap) -> list[Finding]:
    """Report the share of missing depth at the image border, in large gaps and in small gaps, and the share of sampling
    holes. Sampling holes are at most two pixels wide and form a grid if depth was registered to a larger colour image.

    filled: depth map (H, W) in metres, in which small gaps are in-painted. Without in-painting, sampling holes would
    connect all gaps with the image border.
    """
    missing = missing_mask(depth)
    share = float(missing.mean())
    if 1 - share < FEW_VALID:
        return [
            warning(
                MISSING,
                f"expected depth in most of the frame, found {share:.1%} missing: check that the depth stream is on,"
                " that the scene is within the range of the camera, and that 0 means missing depth",
            )
        ]
    gaps = find_gaps(filled)
    border, large = float(gaps.area_px[gaps.on_border].sum() / depth.size), float(missing_mask(filled).mean())
    say = note if share > MUCH_MISSING else fine
    inside = f"{large - border:.1%} in large holes inside, {share - large:.1%} in small holes"
    findings = [say(MISSING, f"{share:.1%} of the depth is missing: {border:.1%} at the image border, {inside}")]
    holes = sampling_holes(missing).mean()
    if holes > HOLES:
        why = "probably because depth was registered to a larger colour image. In-painting fills these holes"
        findings.append(note("sampling holes", f"{holes:.1%} of the frame is in holes of one or two pixels, {why}"))
    return findings


def check_unit(frame: Frame, filled: DepthMap) -> Finding:
    """Check that depth is in metres. The check judges the median depth, the unit of the stored depth values and the
    depth noise.

    filled: depth map (H, W) in metres, in which small gaps are in-painted. The noise is measured in `filled`.
    """
    depth = frame.depth
    median = float(np.median(depth[depth > 0]))
    mend = unit_advice(median, frame.unit_m)
    if CLOSEST_M <= median < NEAR_M and sees_close(frame):
        return note(
            UNIT, f"median depth {median:.3f} m, as close as a RealSense D405 measures: if the scene is farther, {mend}"
        )
    if not NEAR_M <= median <= FAR_M:
        return warning(
            UNIT,
            f"expected a median depth of {NEAR_M:g} to {FAR_M:g} m, found {median:.3g} m:"
            f" if the scene has another distance, {mend}",
        )
    unit = stored_unit_m(depth)
    if unit >= COARSE_UNIT_M:
        return warning(
            UNIT,
            f"expected depth in units of at most 1 or 2 mm, found whole multiples of {unit * 1e3:.0f} mm with a median"
            f" of {median:.3g} m: {mend}",
        )
    noise = noise_per_m(filled)
    if median > ROOM_M and noise is not None and noise < FINE_NOISE_PER_M:
        return warning(
            UNIT,
            f"expected depth noise of centimetres at a median depth of {median:.3g} m, found"
            f" {noise * median**2 * 1e3:.1f} mm, as in a near scene: unless the frame is rendered, {mend}",
        )
    return fine(UNIT, f"median depth {median:.2f} m")


def unit_advice(median_m: float, unit_m: float | None) -> str:
    """Return advice on how to correct a wrong depth unit. unit_m: assumed metres per stored unit, None for
    floating-point depth.
    """
    listed = "; ".join(f"{name}: {scale:g}" for scale, name in SCALES.items())
    guessed = f"multiply depth_scale by {guess_factor(median_m):g} (common values: {listed})"
    if guess_factor(median_m) == 1:
        guessed = f"compare depth_scale with the unit of the camera (common values: {listed})"
    if unit_m is None:
        return guessed
    off = {scale: abs(math.log(median_m * scale / unit_m / TABLE_M)) for scale in SCALES if scale != unit_m}
    near = sorted((scale for scale in off if off[scale] < PLAUSIBLE), key=off.__getitem__)[:2]
    if not near:
        return guessed
    choices = " or ".join(f"{s:g} ({SCALES[s]}; {median_m * s / unit_m:.2g} m)" for s in near)
    return f"multiply depth_scale by {near[0] / unit_m:g}: depth_scale {choices}"


def guess_factor(median_m: float) -> float:
    """Return the power of ten that, multiplied by the median depth, gives the value closest to `TABLE_M`."""
    return float(10.0 ** np.round(np.log10(TABLE_M / median_m)))


def sees_close(frame: Frame) -> bool:
    """Return True if a frame may come from a close-range camera: depth in units of 0.1 mm, or the field of view of a
    RealSense D405.
    """
    if frame.unit_m is not None and abs(frame.unit_m / CLOSE_UNIT_M - 1) < 0.01:
        return True
    camera = frame.camera
    modes = (Camera(*mode) for mode in NOMINAL["realsense-d405"])
    return camera is not None and any(
        abs(camera.width / camera.height / (mode.width / mode.height) - 1) < SAME_VIEW
        and abs(camera.fx / camera.width / (mode.fx / mode.width) - 1) < SAME_VIEW
        for mode in modes
    )


def stored_unit_m(depth: DepthMap) -> float:
    """Return the largest unit, in metres, of which all depths are whole multiples. The unit is at least 0.1 mm.

    If depth in millimetres was multiplied by ten by mistake, the unit is 10 mm. No camera uses a depth unit of 10 mm.
    The returned unit is 0.1 mm for most floating-point depth maps, and for depth maps with fewer than 20 different
    values.
    """
    ticks = np.unique(np.rint(depth[depth > 0] / FINEST_TICK_M).astype(np.int64))
    return float(np.gcd.reduce(ticks)) * FINEST_TICK_M if len(ticks) >= 20 else FINEST_TICK_M


def noise_per_m(filled: DepthMap) -> float | None:
    """Return the depth noise on smooth surfaces, divided by the squared distance, in 1/m. The returned value is None if
    every square of 7x7 pixels contains missing depth.

    For one sensor, depth noise divided by the squared distance is nearly constant. If all depth values are ten times
    too large, the result is ten times too small.
    """
    planes = fit_local_planes(filled)
    return float(np.percentile(planes.residual[planes.whole], 25)) if planes.whole.any() else None
