"""Parameters of the paper, one frozen model for each stage. `settings.additions` has those of our additions.

Each field states its unit, its range and the origin of its value. "Paper": printed in Toscana & Rosa 2016. "Authors'
release": taken from the code that they published. "Our choice": the paper does not say, see docs/paper.md. Lengths and
areas in pixels refer to a 640x480 image. Areas grow with the image. Lengths grow only if `Additions.lengths_grow` is
set, except those of in-painting, which always grow.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from spigolo.settings.parameters import (
    Angle_deg,
    Area_px2,
    Grows,
    Length_px,
    MaxArea_px2,
    NotNegative,
    Offset_px,
    Positive,
    Settings,
    Share,
)


class Smoothing(Settings):
    """Depth-dependent smoothing of Holzer et al. 2012 with the paper's mean over valid pixels (eqs. 5-8)."""

    mean: Literal["valid", "plain", "none"] = "valid"
    """Mean over the smoothing window. `valid` ignores missing pixels (eq. 8), `plain` counts them as zeros (eq. 5), and
    `none` does not smooth.
    """
    error_per_m: Positive = 0.0028
    """Depth error alpha per squared distance, 1/m. Larger values smooth more (authors' release)."""
    radius_per_error_px_m: Annotated[Positive, Grows()] = 1500.0
    """Smoothing radius beta per depth error, px/m. Larger values smooth more (authors' release)."""
    step_factor: Positive = 18.0
    """Minimum depth difference between neighbours at a depth step, as a multiple of the depth error. No window crosses
    a step (authors' release).
    """
    max_radius_px: Length_px = 10
    """Maximum smoothing radius, px. Larger windows round off the creases that eq. 18 measures (our choice)."""
    skip_steps: bool = True
    """Leave pixels on a depth step out of every mean, except if `mean` is `plain` (authors' release)."""


class Inpainting(Settings):
    """In-painting of small gaps (paper, section III-E). Large shadows stay missing. The limits are our choice."""

    sampling_holes: bool = True
    """Fill holes of one or two pixels first. A depth map that was warped to a larger colour image has a grid of
    them.
    """
    max_area_px2: Area_px2 = 400.0
    """Maximum area of a gap that is filled, px^2 at 640x480."""
    max_radius_px: Annotated[Positive, Grows(always=True)] = 6.0
    """Maximum inscribed radius of a gap that is filled, px at 640x480."""
    step_m: NotNegative = 0.03
    """Minimum depth range of a gap's rim, m, at which the gap crosses a depth step. Such a gap gets the far depth."""
    step_share: Share = 0.03
    """Minimum depth range of a gap's rim at a depth step, as a share of the distance. The larger of this limit and
    `step_m` applies.
    """


class DepthConfig(Settings):
    """Preparation and comparison of depth (eqs. 5-9)."""

    smoothing: Smoothing = Smoothing()
    """Smoothing of the sensor noise (eqs. 5-8)."""
    inpainting: Inpainting | None = None
    """In-painting of small gaps. None fills no gaps, as the paper does with the first cost function."""
    depth_range: Positive | None = None
    """Depth difference that counts as 1 in eq. 9, m. None: the depth range of each frame (authors' release)."""


class ColorConfig(Settings):
    """Colour difference (eq. 4)."""

    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Sigma of the Gaussian smoothing of RGB, px. 0 does not smooth (authors' release, which smooths after the
    conversion to HSV).
    """
    k_dv: Positive = 4.5
    """Weight of the difference in value (brightness) (paper)."""
    k_ds: NotNegative = 0.1
    """Weight of the difference in hue and saturation (paper)."""


class SaliencyConfig(Settings):
    """Centre-surround saliency of Montabone & Soto 2010 and its power law (eq. 10)."""

    surrounds_px: Annotated[tuple[Annotated[int, Field(ge=1, le=10_000)], ...], Grows()] = (12, 24, 48, 28, 56, 112)
    """Half-sizes sigma 2^s of the surrounds, px, for sigma in {3, 7} and s in {2, 3, 4} (Montabone's own code)."""
    power: Positive = 4.0
    """Exponent of eq. 10. Larger values keep only the most salient pixels (paper)."""


class EdgesConfig(Settings):
    """Canny on Scharr gradients, and the classification of its pixels as object boundaries (eqs. 12-20)."""

    canny_low: Share = 0.05
    """Low threshold of Canny as a share of the frame's largest gradient (authors' release)."""
    canny_high: Share = 0.075
    """High threshold of Canny as a share of the frame's largest gradient (authors' release)."""
    canny_floor: NotNegative = 60.0
    """Minimum of the low threshold, in units of the Scharr gradient, so that a plain frame shows no noise (our choice).
    The high threshold keeps its ratio to the low one.
    """
    step_offset_px: Offset_px = 7
    """Offset epsilon_rho from an edge to the depth samples on both sides, px (authors' release)."""
    step_m: Positive = 0.03
    """Minimum depth difference t_rho at a depth boundary, m. Larger values keep fewer edges (authors' release)."""
    signed_step: bool = False
    """Compare the signed difference, as printed in eq. 13. Edges that are seen from the near side are then missed."""
    missing_is_boundary: bool = False
    """Count a missing depth sample as a depth step. By default a missing sample is ignored."""
    contact_offset_px: Offset_px = 5
    """Offset epsilon_e of the three points of the contact angle, px (authors' release)."""
    contact_low_deg: Angle_deg = 56.0
    """Minimum contact angle t_theta_L, degrees (authors' release)."""
    contact_high_deg: Angle_deg = 154.0
    """Maximum contact angle t_theta_H, degrees (authors' release)."""
    sign_rule: Literal["tangent", "x", "none"] = "tangent"
    """Sign of the contact angle. `tangent` takes the cross product along the edge and is right for every direction. `x`
    takes the x component as printed in eq. 19, which is zero for upright edges. `none` keeps internal boundaries.
    """
    boundary: Literal["soft", "thin"] = "soft"
    """Kind of boundary map. `soft` blurs E_F and rescales it to a maximum of 1, which closes gaps (authors' release).
    `thin` is eq. 20.
    """
    blur_px: Annotated[int, Field(ge=1, le=99), Grows(odd=True)] = 7
    """Width of the Gaussian that blurs the soft boundary map, px, odd (authors' release)."""

    @model_validator(mode="after")
    def _ordered(self) -> EdgesConfig:
        if self.canny_low > self.canny_high or self.contact_low_deg > self.contact_high_deg:
            raise ValueError("a low threshold is above its high one")
        if self.blur_px % 2 == 0:
            raise ValueError("blur_px must be odd")
        return self


Ends = Literal["max", "i"]


class SaliencyCost(Settings):
    """First cost function (eq. 22): colour, depth and saliency, for frames with large shadows."""

    kind: Literal["saliency"] = "saliency"
    """Kind of the cost function in preset files."""
    k_x: NotNegative = 1.05
    """Weight of the depth difference (paper)."""
    k_y: NotNegative = 1.5
    """Weight of the colour difference (paper)."""
    k_s: NotNegative = 0.5
    """Weight of the saliency (paper)."""
    ends: Ends = "max"
    """Saliency of a graph edge. `i` takes the value at its first end, as printed. `max` takes the larger of both ends
    (our choice).
    """


class BoundaryCost(Settings):
    """Second cost function (eq. 23): depth times colour, plus the boundary map, for frames with full depth."""

    kind: Literal["boundary"] = "boundary"
    """Kind of the cost function in preset files."""
    k_x: NotNegative = 7.5
    """Weight of the depth and colour term (paper)."""
    k_b: NotNegative = 0.66
    """Weight of the boundary map (paper)."""
    ends: Ends = "max"
    """Boundary value of a graph edge. `i` takes the value at its first end, as printed. `max` takes the larger of both
    ends (our choice).
    """

    @model_validator(mode="after")
    def _has_weight(self) -> BoundaryCost:
        if self.k_x + self.k_b == 0:
            raise ValueError("k_x and k_b are both 0")
        return self


class AutoCost(Settings):
    """Automatic choice between both cost functions by the share of missing depth within the working range. The paper
    chooses by hand.
    """

    kind: Literal["auto"] = "auto"
    """Kind of the cost function in preset files."""
    full: BoundaryCost = BoundaryCost()
    """Cost function for frames with complete depth."""
    shadows: SaliencyCost = SaliencyCost()
    """Cost function for frames with large shadows."""
    max_missing: Share = 0.03
    """Maximum share of missing depth within the working range at which `full` is used (our choice)."""


Cost = Annotated[SaliencyCost | BoundaryCost | AutoCost, Field(discriminator="kind")]


class Partition(Settings):
    """Merging by internal difference (eqs. 2, 3)."""

    gamma: NotNegative = 0.0016
    """Threshold gamma of eq. 3, weight times pixels. Larger values give larger regions (paper: 5, 0.0016, 0.001)."""
    gamma_shadows: NotNegative | None = None
    """Threshold gamma of frames with the `shadows` cost of an AutoCost. The weights of that cost function are larger by
    orders of magnitude.
    """
    connectivity: Literal[4, 8] = 8
    """Neighbours of a pixel in the graph (authors' release)."""
    min_size_px2: Area_px2 = 500.0
    """Minimum area of a region, px^2 at 640x480. A smaller region joins its most similar neighbour (authors'
    release).
    """


class Rejection(Settings):
    """Rules that reject regions (paper, section III-F). None switches a rule off."""

    max_distance_m: Positive | None = None
    """Reach: maximum distance of a region's centroid from the camera, m (authors' release: 1.8)."""
    max_lambda1_px2: MaxArea_px2 = None
    """Maximum of the larger eigenvalue of the pixel coordinates' covariance, px^2 (authors' release: 3800)."""
    max_lambda2_px2: MaxArea_px2 = None
    """Maximum of the smaller eigenvalue, px^2 (authors' release: 950)."""
    max_eccentricity: Share | None = None
    """Maximum eccentricity sqrt(1 - lambda2 / lambda1). Larger values keep longer regions (authors' release: 0.978)."""
    max_missing: Share | None = None
    """Maximum share of pixels without depth. Missing depth is counted after in-painting if in-painting is on (paper:
    0.3, without in-painting).
    """
    max_dark: Share | None = None
    """Maximum share of pixels in the three darkest of 32 brightness bins, which are 0..23 of 255 (paper: 0.3)."""
