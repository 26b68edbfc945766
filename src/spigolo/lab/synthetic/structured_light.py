"""Model of a structured-light depth camera, similar to the first Kinect.

A structured-light camera measures depth by triangulation. A projector next to the camera projects a pattern. A surface
at depth Z has the disparity ``d = fx * baseline / Z``. The model simulates projector shadows, missing depth on dark,
glossy or steep surfaces, disparity noise, and quantisation of the disparity.

Camera frame: x to the right, y down, Z forward. The projector is at ``x = +baseline_m``, so shadows are to the left of
objects.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

__all__ = ["StructuredLight", "projector_shadow", "simulate_structured_light"]

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

# A pixel covers about one projector column on each side, so smaller disparity steps cast no shadow.
_SHADOW_TOLERANCE_PX = 1.5
_TURNED_AWAY = 0.95


@dataclass(frozen=True)
class StructuredLight:
    """Parameters of the depth camera model."""

    baseline_m: float = 0.075
    """Distance between projector and camera, metres."""
    noise_px: float = 0.12
    """Standard deviation of the disparity noise, in pixels."""
    slant_noise_px: float = 0.0
    """Additional disparity noise on a slanted surface with a disparity gradient of 1, in pixels."""
    noise_radius_px: float = 1.2
    """Standard deviation of the Gaussian filter that smooths the disparity noise, in pixels."""
    disparity_step_px: float = 0.125
    """Quantisation step of the disparity, in pixels."""
    dark_brightness: float = 0.11
    """Minimum brightness (mean of RGB, 0..1) at which depth is measured. Darker pixels have missing depth."""
    shiny_brightness: float = 0.985
    """Maximum brightness (mean of RGB, 0..1) at which depth is measured. Pixels that are brighter than this maximum
    have missing depth.
    """
    steepest_angle_deg: float = 75.0
    """Maximum angle between viewing ray and surface normal at which depth is measured, in degrees."""
    rim_jump_px: float = 1.0
    """Maximum disparity difference between neighbouring pixels on one surface, in pixels. A larger difference of
    disparity counts as a depth discontinuity.
    """
    rim_loss: float = 0.35
    """Strength of the depth loss at depth discontinuities, 0..1. With a strength of 0.5, half of the pixels next to a
    depth discontinuity have missing depth.
    """
    nearest_m: float = 0.40
    """Minimum measurable depth, metres."""
    furthest_m: float = 4.5
    """Maximum measurable depth, metres."""
    edge_jitter_px: float = 0.0
    """Standard deviation of the random displacement of depth discontinuities relative to the colour image, in
    pixels.
    """
    patch_px: float = 1.5
    """Standard deviation of the Gaussian filter that smooths the irregular outlines of missing depth, in pixels."""
    margin_px: tuple[int, int, int, int] = (0, 0, 0, 0)
    """Width in pixels of the image border without depth: top, right, bottom, left."""

    def at_noise_level(self, level: float) -> StructuredLight:
        """Return the camera model with noise similar to real cameras.

        Parameters
        ----------
        level
            Factor by which the noise is multiplied, 1 = typical first Kinect. Real cameras have noise levels from 0.5
            to 2. A noise level below 1 also reduces the quantisation step.

        """
        return replace(
            self,
            noise_px=0.05 * level,
            slant_noise_px=0.7 * level,
            noise_radius_px=1.6,
            disparity_step_px=0.125 * min(level, 1.0),
        )


def simulate_structured_light(
    depth_m: npt.ArrayLike,
    rgb: npt.NDArray[np.uint8],
    fx_px: float,
    rng: np.random.Generator,
    sensor: StructuredLight | None = None,
    gloss: npt.NDArray[np.floating[Any]] | None = None,
) -> npt.NDArray[np.float32]:
    """Simulate the depth map (H, W) of a structured-light camera from a noise-free depth map. Missing depth is 0.

    Parameters
    ----------
    depth_m
        Noise-free depth map (H, W), metres. Pixels without a surface are 0 or not finite.
    rgb
        Colour image (H, W, 3), 8 bit.
    fx_px
        Focal length in pixels. The principal point is assumed to be the image centre.
    rng
        Random number generator.
    sensor
        Camera parameters, by default similar to the first Kinect.
    gloss
        Gloss of the surface at each pixel (H, W), 0 = matt, 1 = mirror. Depth of a glossy surface is measured only if
        the surface faces the camera.

    """
    sensor = sensor or StructuredLight()
    ideal = np.asarray(depth_m, dtype=np.float64)
    if ideal.ndim != 2 or rgb.shape != (*ideal.shape, 3):
        raise ValueError(f"depth {ideal.shape} and colour {rgb.shape} must be (H, W) and (H, W, 3)")
    valid = np.isfinite(ideal) & (ideal > 0)
    disparity_px = np.zeros_like(ideal)
    disparity_px[valid] = fx_px * sensor.baseline_m / ideal[valid]

    # All noise is drawn even if it is not used, so that random numbers do not depend on the scene.
    raggedness, rim_noise, measuring_noise = (
        correlated_noise(ideal.shape, radius, rng) for radius in (sensor.patch_px, 1.8, sensor.noise_radius_px)
    )
    lost = ~valid | projector_shadow(disparity_px)
    lost |= _unlit(rgb, raggedness, sensor)
    lost |= _steep(ideal, fx_px, raggedness, sensor, np.zeros_like(ideal) if gloss is None else gloss)
    lost |= _ragged_rim(disparity_px, rim_noise, sensor)
    if sensor.edge_jitter_px > 0:
        disparity_px, lost = _strayed(disparity_px, lost, sensor.edge_jitter_px, rng)
    lost |= _outside(ideal.shape, raggedness, sensor)

    noisy_px = disparity_px + _noise_level_px(disparity_px, sensor) * measuring_noise
    step_px = sensor.disparity_step_px
    measured_px = np.round(noisy_px / step_px) * step_px
    lost |= measured_px < step_px
    measured_m = fx_px * sensor.baseline_m / np.where(lost, 1.0, measured_px)
    lost |= (measured_m < sensor.nearest_m) | (measured_m > sensor.furthest_m)
    return np.where(lost, 0.0, measured_m).astype(np.float32)


def _noise_level_px(disparity_px: FloatArray, sensor: StructuredLight) -> FloatArray | float:
    """Return the standard deviation of the disparity noise at each pixel (H, W), in pixels.

    Noise is higher on slanted surfaces. On a slanted surface, the image window that the camera matches with the
    projected pattern contains different disparities.
    """
    if sensor.slant_noise_px == 0:
        return sensor.noise_px
    across, down = (_smooth_step(disparity_px[..., None], axis)[..., 0] for axis in (1, 0))
    return np.hypot(sensor.noise_px, sensor.slant_noise_px * np.hypot(across, down))


def projector_shadow(disparity_px: FloatArray) -> BoolArray:
    """Return the mask (H, W) of the pixels that are visible to the camera but not lit by the projector.

    disparity_px: disparity map (H, W), 0 = no surface.

    A pixel in column u with disparity d is lit by projector column u - d. If several pixels of a row have the same
    projector column, only the nearest pixel is lit.
    """
    height, width = disparity_px.shape
    seen = disparity_px > 0
    margin = int(np.ceil(disparity_px.max(initial=0.0))) + 2
    column = np.arange(width) - disparity_px + margin
    row_start = np.arange(height)[:, None] * (width + margin + 2)
    left = row_start + np.floor(column).astype(np.int64)
    nearest_px = np.zeros(height * (width + margin + 2))
    # Each pixel covers two projector columns. Otherwise slanted surfaces would have gaps between adjacent pixels.
    for index in (left, left + 1):
        np.maximum.at(nearest_px, index[seen], disparity_px[seen])
    in_front_px = np.minimum(nearest_px[left], nearest_px[left + 1])
    shadow: BoolArray = seen & (in_front_px > disparity_px + _SHADOW_TOLERANCE_PX + _own_rise_px(disparity_px))
    return shadow


def _own_rise_px(disparity_px: FloatArray) -> FloatArray:
    """Return, for each pixel (H, W), the change of disparity over two projector columns on the same surface, in pixels.

    On a steep surface, one projector column covers many pixels of different disparity. The returned value is a
    tolerance: it prevents nearer pixels of a surface from casting a shadow on other pixels of the same surface.
    """
    if disparity_px.shape[1] < 2:
        return np.zeros_like(disparity_px)
    gain = _smooth_step(disparity_px[..., None], 1)[..., 0]
    return np.where(gain < _TURNED_AWAY, 2 * np.abs(gain) / np.maximum(1 - gain, 1 - _TURNED_AWAY), 0.0)


def correlated_noise(shape: tuple[int, ...], radius_px: float, rng: np.random.Generator) -> FloatArray:
    """Return spatially correlated Gaussian noise (H, W) with unit variance.

    radius_px: standard deviation of the smoothing Gaussian filter, pixels, 0 = uncorrelated noise.
    """
    noise = rng.standard_normal(shape)
    if radius_px <= 0:
        return noise
    reach = int(np.ceil(3 * radius_px))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / radius_px) ** 2)
    kernel /= np.sqrt(np.sum(kernel**2))  # normalised to keep the variance
    for axis in (0, 1):
        padding = [(reach, reach) if a == axis else (0, 0) for a in (0, 1)]
        padded = np.pad(noise, padding, mode="wrap")
        length = noise.shape[axis]
        noise = sum(
            (weight * np.take(padded, range(k, k + length), axis=axis) for k, weight in enumerate(kernel)),
            start=np.zeros_like(noise),
        )
    return noise


def _unlit(rgb: npt.NDArray[np.uint8], raggedness: FloatArray, sensor: StructuredLight) -> BoolArray:
    """Return the mask (H, W) of the pixels that have no depth because they are too dark or too bright."""
    brightness = rgb.astype(np.float64).mean(axis=2) / 255.0
    uneven = brightness + 0.02 * raggedness
    unlit: BoolArray = (uneven < sensor.dark_brightness) | (brightness > sensor.shiny_brightness)
    return unlit


def _steep(
    depth_m: FloatArray,
    fx_px: float,
    raggedness: FloatArray,
    sensor: StructuredLight,
    gloss: npt.NDArray[np.floating[Any]],
) -> BoolArray:
    """Return the mask (H, W) of the pixels that have no depth because their surface is too steep.

    The maximum angle between surface normal and viewing ray is smaller for glossy surfaces.
    """
    height, width = depth_m.shape
    if height < 2 or width < 2:
        return np.zeros(depth_m.shape, dtype=np.bool_)
    finite_m = np.where(np.isfinite(depth_m), depth_m, 0.0)
    across = (np.arange(width) - (width - 1) / 2) / fx_px
    down = (np.arange(height)[:, None] - (height - 1) / 2) / fx_px
    points = np.stack([across * finite_m, down * finite_m, finite_m], axis=-1)
    normals = np.cross(_smooth_step(points, 1), _smooth_step(points, 0))
    along_ray = np.abs(np.sum(normals * points, axis=-1))
    lengths = np.linalg.norm(normals, axis=-1) * np.linalg.norm(points, axis=-1)
    angle_deg = np.degrees(np.arccos(np.clip(along_ray / np.maximum(lengths, 1e-12), 0.0, 1.0)))
    steep: BoolArray = angle_deg + 2.0 * raggedness > sensor.steepest_angle_deg * (1.0 - gloss)
    return steep


def _smooth_step(points: FloatArray, axis: int) -> FloatArray:
    """Return the difference between adjacent points of a grid (H, W, K) along one axis.

    Each point has two differences: to the previous point and to the next point. The function returns the difference
    with the smaller change of the last coordinate (depth or disparity). The smaller change avoids a difference across a
    depth discontinuity.
    """
    steps = np.diff(points, axis=axis)
    first, last = np.take(steps, [0], axis=axis), np.take(steps, [-1], axis=axis)
    before = np.concatenate([first, steps], axis=axis)
    after = np.concatenate([steps, last], axis=axis)
    return np.where(np.abs(before[..., -1:]) <= np.abs(after[..., -1:]), before, after)


def _strayed(
    disparity_px: FloatArray, lost: BoolArray, spread_px: float, rng: np.random.Generator
) -> tuple[FloatArray, BoolArray]:
    """Shift depth discontinuities and the outlines of areas without depth by random distances.

    spread_px: standard deviation of the random shift in each direction, in pixels.
    """
    down, across = (np.rint(spread_px * correlated_noise(lost.shape, 2.0, rng)).astype(np.int64) for _ in range(2))
    rows = np.clip(np.arange(lost.shape[0])[:, None] + down, 0, lost.shape[0] - 1)
    columns = np.clip(np.arange(lost.shape[1]) + across, 0, lost.shape[1] - 1)
    # Shifts are applied only at outlines. Within a surface they would add noise.
    strayed_px = disparity_px[rows, columns]
    jumps = np.abs(strayed_px - disparity_px) > 1.0
    return np.where(jumps, strayed_px, disparity_px), lost[rows, columns]


def _outside(shape: tuple[int, ...], raggedness: FloatArray, sensor: StructuredLight) -> BoolArray:
    """Return the mask (H, W) of the border of the colour image that is outside the view of the depth camera."""
    height, width = shape
    top, right, bottom, left = (px or -shape[0] for px in sensor.margin_px)
    down, across = np.arange(height)[:, None] + raggedness, np.arange(width) + raggedness
    if not any(sensor.margin_px):
        return np.zeros(shape, np.bool_)
    return (down < top) | (down >= height - bottom) | (across < left) | (across >= width - right)


def _ragged_rim(disparity_px: FloatArray, rim_noise: FloatArray, sensor: StructuredLight) -> BoolArray:
    """Return a random mask (H, W) of missing depth near depth discontinuities."""
    near_jump = np.zeros(disparity_px.shape, dtype=np.bool_)
    for axis in (0, 1):
        jump = np.abs(np.diff(disparity_px, axis=axis)) > sensor.rim_jump_px
        for before, after in ((0, 1), (1, 0)):
            padding = [(before, after) if a == axis else (0, 0) for a in (0, 1)]
            near_jump |= np.pad(jump, padding)
    one_away = near_jump.copy()
    one_away[1:] |= near_jump[:-1]
    one_away[:-1] |= near_jump[1:]
    one_away[:, 1:] |= near_jump[:, :-1]
    one_away[:, :-1] |= near_jump[:, 1:]
    # Thresholds on Gaussian noise: depth is missing less often at pixels farther from the discontinuity.
    ragged_near = rim_noise > 1.6 - 3.2 * sensor.rim_loss
    ragged_far = rim_noise > 2.4 - 3.2 * sensor.rim_loss
    rim: BoolArray = (near_jump & ragged_near) | (one_away & ragged_far)
    return rim
