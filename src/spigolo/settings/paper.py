"""Parameters of the paper, one frozen model for each stage. `settings.additions` contains the parameters of our
additions.

The text of each field names the origin of its default value. The paper is Toscana & Rosa 2016. The authors' code is the
code that the authors of the paper published. "Our choice" means that the paper gives no value (docs/paper.md). Lengths
and areas in pixels refer to a 640x480 image. Areas and the lengths of in-painting are scaled with the image. Other
lengths are scaled only if `Additions.lengths_grow` is set.
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
    """Smoothing of Holzer et al. 2012 with a radius that depends on depth (eqs. 5-8). The mean over valid pixels comes
    from the paper.
    """

    mean: Literal["valid", "plain", "none"] = "valid"
    """Mean over the smoothing window. `valid` ignores missing pixels (eq. 8), `plain` counts missing pixels as zeros
    (eq. 5), and `none` does not smooth.
    """
    error_per_m: Positive = 0.0028
    """Depth error alpha per squared distance, 1/m. Larger values smooth more. The default comes from the authors'
    code.
    """
    radius_per_error_px_m: Annotated[Positive, Grows()] = 1500.0
    """Smoothing radius beta per depth error, px/m. Larger values smooth more. The default comes from the authors'
    code.
    """
    step_factor: Positive = 18.0
    """Minimum depth difference between neighbouring pixels at a depth step, as a multiple of the depth error. No
    smoothing window crosses a depth step. The default comes from the authors' code.
    """
    max_radius_px: Length_px = 10
    """Maximum smoothing radius, in pixels. Larger values round off the creases that eq. 18 measures. The default is our
    choice.
    """
    skip_steps: bool = True
    """Leave pixels on a depth step out of every mean, except if `mean` is `plain`. The default comes from the authors'
    code.
    """


class Inpainting(Settings):
    """In-painting of small gaps (paper, section III-E). Large shadows stay missing. The limits are our choice."""

    sampling_holes: bool = True
    """Fill holes of one or two pixels first. A depth map that was warped to a larger colour image has a grid of such
    holes.
    """
    max_area_px2: Area_px2 = 400.0
    """Maximum area of a gap that is filled, px^2 at 640x480. Larger values fill larger gaps."""
    max_radius_px: Annotated[Positive, Grows(always=True)] = 6.0
    """Maximum inscribed radius of a gap that is filled, px at 640x480. Larger values fill wider gaps."""
    step_m: NotNegative = 0.03
    """Minimum depth range along the rim of a gap, m, at which the gap counts as lying on a depth step. Gaps on a depth
    step are filled with the largest depth along the rim.
    """
    step_share: Share = 0.03
    """Minimum depth range along the rim of a gap on a depth step, as a share of the distance. The limit is
    max(`step_m`, `step_share` * distance).
    """


class DepthConfig(Settings):
    """Preparation and comparison of depth (eqs. 5-9)."""

    smoothing: Smoothing = Smoothing()
    """Smoothing of sensor noise (eqs. 5-8)."""
    inpainting: Inpainting | None = None
    """In-painting of small gaps. None fills no gaps, as in the paper with the first cost function."""
    depth_range: Positive | None = None
    """Depth difference that counts as 1 in eq. 9, in metres. If None, it is the depth range of each frame. Larger
    values reduce the influence of depth. The default comes from the authors' code.
    """


class ColorConfig(Settings):
    """Colour difference (eq. 4)."""

    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the RGB image, in pixels. 0 does not smooth. Larger values suppress more
    noise. The default comes from the authors' code, which smooths the HSV image instead.
    """
    k_dv: Positive = 4.5
    """Weight of the difference in value, the brightness of HSV. The default comes from the paper."""
    k_ds: NotNegative = 0.1
    """Weight of the difference in hue and saturation. The default comes from the paper."""


class SaliencyConfig(Settings):
    """Centre-surround saliency of Montabone & Soto 2010 and its power law (eq. 10)."""

    surrounds_px: Annotated[tuple[Annotated[int, Field(ge=1, le=10_000)], ...], Grows()] = (12, 24, 48, 28, 56, 112)
    """Half-sizes of the squares with whose mean a pixel is compared (surrounds), px: sigma 2^s for sigma in {3, 7} and
    s in {2, 3, 4}. The default comes from Montabone's code.
    """
    power: Positive = 4.0
    """Exponent of the power law of saliency (eq. 10). Larger values keep only the most salient pixels. The default
    comes from the paper.
    """


class EdgesConfig(Settings):
    """Canny edge detection on Scharr gradients, and classification of the edge pixels as object boundaries (eqs.
    12-20).
    """

    canny_low: Share = 0.05
    """Low threshold of Canny as a share of the frame's largest gradient. Larger values find fewer edges. The default
    comes from the authors' code.
    """
    canny_high: Share = 0.075
    """High threshold of Canny as a share of the frame's largest gradient. Larger values find fewer edges. The default
    comes from the authors' code.
    """
    canny_floor: NotNegative = 60.0
    """Minimum of Canny's low threshold, in units of the Scharr gradient. Larger values find fewer edges in the noise of
    frames without strong image edges. The high threshold grows by the same factor. The default is our choice.
    """
    step_offset_px: Offset_px = 7
    """Offset epsilon_rho from an image edge to the depth samples on both sides, in pixels. The default comes from the
    authors' code.
    """
    step_m: Positive = 0.03
    """Minimum depth difference t_rho at a depth boundary, in metres. Larger values keep fewer edges. The default comes
    from the authors' code.
    """
    signed_step: bool = False
    """Compare the signed depth difference with `step_m`, as printed in eq. 13, instead of its absolute value. Edge
    pixels on the near side of a depth step are then missed.
    """
    missing_is_boundary: bool = False
    """Count a missing depth sample as a depth step. If False, a missing sample is ignored."""
    contact_offset_px: Offset_px = 5
    """Offset epsilon_e between the three points that measure the contact angle, in pixels. The default comes from the
    authors' code.
    """
    contact_low_deg: Angle_deg = 56.0
    """Minimum contact angle t_theta_L of a contact boundary, in degrees. Larger values find fewer contact boundaries.
    The default comes from the authors' code.
    """
    contact_high_deg: Angle_deg = 154.0
    """Maximum contact angle t_theta_H of a contact boundary, in degrees. Larger values find more contact boundaries.
    The default comes from the authors' code.
    """
    sign_rule: Literal["tangent", "x", "none"] = "tangent"
    """Sign of the contact angle. `tangent` uses the component of the cross product along the edge, which has the
    correct sign for every edge direction. `x` uses the x component, as printed in eq. 19. The x component is zero for
    vertical edges. `none` ignores the sign, so that convex edges inside an object also become boundaries.
    """
    boundary: Literal["soft", "thin"] = "soft"
    """Kind of boundary map. `soft` blurs the boundaries E_F and rescales the map to a maximum of 1, which closes gaps.
    `thin` is eq. 20. The default comes from the authors' code.
    """
    blur_px: Annotated[int, Field(ge=1, le=99), Grows(odd=True)] = 7
    """Width of the Gaussian window that blurs the soft boundary map, an odd number of px. Larger values close wider
    gaps. The default comes from the authors' code.
    """

    @model_validator(mode="after")
    def _ordered(self) -> EdgesConfig:
        if self.canny_low > self.canny_high:
            raise ValueError(f"expected canny_low <= canny_high, got {self.canny_low:g} and {self.canny_high:g}")
        if self.contact_low_deg > self.contact_high_deg:
            low, high = self.contact_low_deg, self.contact_high_deg
            raise ValueError(f"expected contact_low_deg <= contact_high_deg, got {low:g} and {high:g}")
        if self.blur_px % 2 == 0:
            raise ValueError(f"expected an odd number of pixels as blur_px, got {self.blur_px}")
        return self


Ends = Literal["max", "i"]


class SaliencyCost(Settings):
    """First cost function (eq. 22): colour, depth and saliency, for frames with large shadows."""

    kind: Literal["saliency"] = "saliency"
    """Kind of the cost function in preset files."""
    k_x: NotNegative = 1.05
    """Weight of the depth difference. The default comes from the paper."""
    k_y: NotNegative = 1.5
    """Weight of the colour difference. The default comes from the paper."""
    k_s: NotNegative = 0.5
    """Weight of the saliency. The default comes from the paper."""
    ends: Ends = "max"
    """Pixel whose saliency is used for a graph edge: with `i`, the first pixel of the edge, as in eq. 22. With `max`,
    the pixel with the larger saliency. The default is our choice.
    """


class BoundaryCost(Settings):
    """Second cost function (eq. 23): depth times colour, plus the boundary map, for frames with little missing
    depth.
    """

    kind: Literal["boundary"] = "boundary"
    """Kind of the cost function in preset files."""
    k_x: NotNegative = 7.5
    """Weight of the product of depth difference and colour difference. The default comes from the paper."""
    k_b: NotNegative = 0.66
    """Weight of the boundary map. The default comes from the paper."""
    ends: Ends = "max"
    """Pixel whose boundary value is used for a graph edge: with `i`, the first pixel of the edge, as in eq. 23. With
    `max`, the pixel with the larger boundary value. The default is our choice.
    """

    @model_validator(mode="after")
    def _has_weight(self) -> BoundaryCost:
        if self.k_x + self.k_b == 0:
            raise ValueError("expected k_x or k_b above 0, got 0 for both")
        return self


class AutoCost(Settings):
    """Automatic choice between the two cost functions for each frame, by the share of missing depth (`max_missing`).
    The paper chooses the cost function by hand.
    """

    kind: Literal["auto"] = "auto"
    """Kind of the cost function in preset files."""
    full: BoundaryCost = BoundaryCost()
    """Cost function for frames with little missing depth."""
    shadows: SaliencyCost = SaliencyCost()
    """Cost function for frames with large shadows."""
    max_missing: Share = 0.03
    """Maximum share of missing depth in a frame at which the cost function `full` is used. Missing depth at the image
    border or beyond `Rejection.max_distance_m` does not count. The default is our choice.
    """


Cost = Annotated[SaliencyCost | BoundaryCost | AutoCost, Field(discriminator="kind")]


class Partition(Settings):
    """Merging of pixels into regions by internal difference (eqs. 2, 3)."""

    gamma: NotNegative = 0.0016
    """Threshold gamma of eq. 3, in units of edge weight times pixels. Larger values give larger regions. The paper uses
    5 (preset SHELF), 0.0016 (TABLE) and 0.001 (CLUTTER).
    """
    gamma_shadows: NotNegative | None = None
    """Threshold gamma of eq. 3 for frames with the cost function `AutoCost.shadows`, whose weights are larger by orders
    of magnitude. Larger values give larger regions.
    """
    connectivity: Literal[4, 8] = 8
    """Number of neighbours of a pixel in the graph. The default comes from the authors' code."""
    min_size_px2: Area_px2 = 500.0
    """Minimum area of a region, px^2 at 640x480. A smaller region is merged with its most similar neighbour. The
    default comes from the authors' code.
    """


class Rejection(Settings):
    """Rules that reject regions (paper, section III-F). None switches a rule off."""

    max_distance_m: Positive | None = None
    """Maximum distance of a region's centroid from the camera, in metres. Larger values keep farther regions. If None,
    there is no limit. The authors' code uses 1.8.
    """
    max_lambda1_px2: MaxArea_px2 = None
    """Maximum of the larger eigenvalue of the covariance of a region's pixel coordinates, px^2. Larger values keep
    longer regions. The authors' code uses 3800.
    """
    max_lambda2_px2: MaxArea_px2 = None
    """Maximum of the smaller eigenvalue of the covariance of a region's pixel coordinates, px^2. Larger values keep
    wider regions. The authors' code uses 950.
    """
    max_eccentricity: Share | None = None
    """Maximum eccentricity sqrt(1 - lambda2 / lambda1) of a region. Larger values keep more elongated regions. The
    authors' code uses 0.978.
    """
    max_missing: Share | None = None
    """Maximum share of a region's pixels without depth, counted after in-painting. Larger values keep more regions. The
    paper uses 0.3 without in-painting.
    """
    max_dark: Share | None = None
    """Maximum share of a region's pixels with a brightness from 0 to 23 of 255, the three darkest of 32 bins. Regions
    with exactly this share are rejected too. Larger values keep darker regions. The paper uses 0.3.
    """
