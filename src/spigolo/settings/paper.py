"""Parameters of the paper's method, with one class for each stage of the method. The module `settings.additions`
contains the parameters of our additions.

The text of each field names the origin of its default value. The paper is Toscana & Rosa 2016. The words "authors'
code" mean the code that the authors of the paper published. A default value is our choice if the paper gives no value
(docs/paper.md). Lengths and areas in pixels refer to a 640x480 image. Parameters that are areas, and the lengths in
`Inpainting`, are scaled with the image size. Lengths of other stages are scaled only if `Additions.lengths_grow` is
set.
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
    """Depth smoothing with a radius that depends on depth (equations 5-8, after Holzer and others 2012). To the method
    of Holzer and others, the paper adds that the mean is computed only over valid pixels (equation 8).
    """

    mean: Literal["valid", "plain", "none"] = "valid"
    """Kind of mean over the smoothing window of a pixel. With `valid`, pixels without depth are ignored (equation 8).
    With `plain`, pixels without depth count as 0 (equation 5). With `none`, the depth map is not smoothed.
    """
    error_per_m: Positive = 0.0028
    """Depth error divided by the squared distance (alpha), 1/m. With a larger depth error, the depth map is smoothed
    more. The default comes from the authors' code.
    """
    radius_per_error_px_m: Annotated[Positive, Grows()] = 1500.0
    """Smoothing radius divided by the depth error (beta), px/m. With a larger radius, the depth map is smoothed more.
    The default comes from the authors' code.
    """
    step_factor: Positive = 18.0
    """Minimum depth difference between neighbouring pixels that counts as a depth step, as a multiple of the depth
    error. The depth map is not smoothed across depth steps. The default comes from the authors' code.
    """
    max_radius_px: Length_px = 10
    """Maximum smoothing radius, in pixels. With a larger radius, creases between objects are smoothed more, so that
    equation 18 detects fewer creases. The default is our choice.
    """
    skip_steps: bool = True
    """Exclude pixels on a depth step from the mean over the smoothing window. The field `skip_steps` has no effect if
    `mean` is `plain`. The default comes from the authors' code.
    """


class Inpainting(Settings):
    """Filling of small gaps without depth (paper, section III-E). Large shadows (missing depth next to objects) are not
    filled. The default limits are our choice.
    """

    sampling_holes: bool = True
    """Fill holes that are at most two pixels wide before larger gaps. In a depth map that was registered to a larger
    colour image, such small holes form a grid.
    """
    max_area_px2: Area_px2 = 400.0
    """Maximum area of a gap in the depth map that is filled, px^2 at 640x480."""
    max_radius_px: Annotated[Positive, Field(le=1000), Grows(always=True)] = 6.0
    """Maximum radius of the largest circle inside a gap in the depth map that is filled, px at 640x480. With a larger
    radius, wider gaps are filled.
    """
    step_m: NotNegative = 0.03
    """Maximum depth range (largest minus smallest depth) around a gap that does not lie on a depth step, in metres. If
    the depth range around a gap is larger, the gap lies on a depth step. A gap on a depth step is filled with the
    largest depth around the gap.
    """
    step_share: Share = 0.03
    """Maximum depth range (largest minus smallest depth) around a gap that does not lie on a depth step, as a share of
    the distance. If the depth range around a gap is larger, the gap lies on a depth step. The maximum depth range is
    max(`step_m`, `step_share` * distance).
    """


class DepthConfig(Settings):
    """Smoothing, in-painting and comparison of depth (equations 5-9)."""

    smoothing: Smoothing = Smoothing()
    """Smoothing of sensor noise in the depth map (equations 5-8)."""
    inpainting: Inpainting | None = None
    """Filling of small gaps without depth. If None, gaps are not filled. The paper does not fill gaps with its first
    cost function.
    """
    depth_range: Positive | None = None
    """Depth difference between neighbouring pixels that has the value 1 in equation 9, in metres. If None, the largest
    minus the smallest depth of each frame is used. Larger values reduce the influence of depth on the edge weights. The
    default comes from the authors' code.
    """


class ColorConfig(Settings):
    """Colour difference between neighbouring pixels (equation 4)."""

    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Sigma of the Gaussian smoothing of the RGB image, in pixels. With a sigma of 0, the image is not smoothed. With a
    larger sigma, more noise is suppressed. The default comes from the authors' code, which smooths the HSV image
    instead of the RGB image.
    """
    k_dv: Positive = 4.5
    """Weight of the difference in brightness (V of HSV). With a larger weight, brightness has more influence on the
    colour difference. The default comes from the paper.
    """
    k_ds: NotNegative = 0.1
    """Weight of the difference in hue and saturation (H and S of HSV). The default comes from the paper."""


class SaliencyConfig(Settings):
    """Saliency map: the contrast of each pixel to its surroundings (Montabone & Soto 2010), raised to a power (equation
    10).
    """

    surrounds_px: Annotated[tuple[Annotated[int, Field(ge=1, le=10_000)], ...], Grows()] = (12, 24, 48, 28, 56, 112)
    """Half the side lengths of the squares around a pixel, in pixels. The pixel is compared with the mean grey value of
    each square. The default values are sigma * 2^s with sigma = 3 or 7, and s = 2, 3 or 4. The defaults come from
    Montabone's code.
    """
    power: Positive = 4.0
    """Exponent to which the saliency of each pixel is raised (equation 10). With a larger exponent, only the most
    salient pixels have a high saliency. The default comes from the paper.
    """


class EdgesConfig(Settings):
    """Canny edge detection on Scharr gradients, and selection of the edge pixels on boundaries of objects (equations
    12-20).
    """

    canny_low: Share = 0.05
    """Low threshold of the Canny edge detector, as a share of the frame's largest gradient. A larger threshold gives
    fewer image edges. The default comes from the authors' code.
    """
    canny_high: Share = 0.075
    """High threshold of the Canny edge detector, as a share of the frame's largest gradient. A larger threshold gives
    fewer image edges. The default comes from the authors' code.
    """
    canny_floor: NotNegative = 60.0
    """Minimum of the low threshold of the Canny edge detector, in units of the Scharr gradient. If the low threshold of
    Canny is raised to this minimum, the high threshold is raised by the same factor. In frames without strong image
    edges, a larger minimum gives fewer false edges in noise. The default is our choice.
    """
    step_offset_px: Offset_px = 7
    """Distance epsilon_rho from an edge pixel to the depth samples on both sides of the edge, in pixels. At a diagonal
    edge, the samples are `step_offset_px` rows and columns away. The default comes from the authors' code.
    """
    step_m: Positive = 0.03
    """Minimum depth difference t_rho between both sides of an image edge that counts as a depth boundary, in metres.
    With a larger minimum depth difference, fewer boundaries are found. The default comes from the authors' code.
    """
    signed_step: bool = False
    """Compare the depth difference with its sign with `step_m`, as printed in equation 13. If False, the absolute depth
    difference is compared with `step_m`. If True, edge pixels on the near side of a depth step do not count as boundary
    pixels.
    """
    missing_is_boundary: bool = False
    """Count missing depth as 0 m in equations 12 and 13, as printed. A border between measured and missing depth then
    becomes a depth boundary. If False, missing depth samples are ignored.
    """
    contact_offset_px: Offset_px = 5
    """Distance epsilon_e from an edge pixel to the points on both sides of the edge, from which the contact angle is
    computed, in pixels. At a diagonal edge, the points are `contact_offset_px` rows and columns away. The default comes
    from the authors' code.
    """
    contact_low_deg: Angle_deg = 56.0
    """Minimum angle t_theta_L between the surfaces on both sides of a contact boundary, in degrees. With a larger
    minimum angle, fewer contact boundaries are found. The default comes from the authors' code.
    """
    contact_high_deg: Angle_deg = 154.0
    """Maximum angle t_theta_H between the surfaces on both sides of a contact boundary, in degrees. With a larger
    maximum angle, more contact boundaries are found. The default comes from the authors' code.
    """
    sign_rule: Literal["tangent", "x", "none"] = "tangent"
    """Rule for the sign of the contact angle, which is computed from a cross product. With `tangent`, the sign comes
    from the component of the cross product along the edge, which is correct for all edge directions. With `x`, the sign
    comes from the x component of the cross product, as printed in equation 19. The x component is zero for vertical
    edges. With `none`, the sign is ignored, so that convex edges inside an object also become boundaries.
    """
    boundary: Literal["soft", "thin"] = "soft"
    """Kind of boundary map. With `soft`, the boundaries E_F are blurred, and the map is rescaled to a maximum of 1. The
    blur closes small gaps in the boundaries. With `thin`, the map is the mask E_F of equation 20 without blur. The
    default comes from the authors' code.
    """
    blur_px: Annotated[int, Field(ge=1, le=99), Grows(odd=True)] = 7
    """Width of the Gaussian kernel that blurs the boundaries if `boundary` is `soft`, in pixels. The width of the
    kernel must be odd. A wider kernel closes wider gaps in the boundaries. The default comes from the authors' code.
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
    """First cost function (equation 22), for frames with large shadows. The weight of a graph edge is computed from the
    differences in colour and depth, and from the saliency.
    """

    kind: Literal["saliency"] = "saliency"
    """Name of the first cost function in preset files."""
    k_x: NotNegative = 1.05
    """Weight of the depth difference in equation 22. The default comes from the paper."""
    k_y: NotNegative = 1.5
    """Weight of the colour difference in equation 22. The default comes from the paper."""
    k_s: NotNegative = 0.5
    """Weight of the saliency in equation 22. The default comes from the paper."""
    ends: Ends = "max"
    """Choice of the saliency of a graph edge between two pixels. With `i`, the edge has the saliency of the first
    pixel, as in equation 22. With `max`, the edge has the larger saliency of both pixels. The default is our choice.
    """


class BoundaryCost(Settings):
    """Second cost function (equation 23), for frames with little missing depth. The weight of a graph edge is the
    weighted sum of two terms: the product of depth difference and colour difference, and the boundary value.
    """

    kind: Literal["boundary"] = "boundary"
    """Name of the second cost function in preset files."""
    k_x: NotNegative = 7.5
    """Weight of depth difference times colour difference in equation 23. The default comes from the paper."""
    k_b: NotNegative = 0.66
    """Weight of the boundary map in equation 23. The default comes from the paper."""
    ends: Ends = "max"
    """Choice of the boundary value of a graph edge between two pixels. With `i`, the edge has the boundary value of the
    first pixel, as in equation 23. With `max`, the edge has the larger boundary value of both pixels. The default is
    our choice.
    """

    @model_validator(mode="after")
    def _has_weight(self) -> BoundaryCost:
        if self.k_x + self.k_b == 0:
            raise ValueError("expected k_x or k_b above 0, got 0 for both")
        return self


class AutoCost(Settings):
    """Automatic choice of the cost function for each frame, by the share of missing depth (`max_missing`). In the
    paper, the user chooses the cost function.
    """

    kind: Literal["auto"] = "auto"
    """Name of the automatic choice of the cost function in preset files."""
    full: BoundaryCost = BoundaryCost()
    """Cost function for frames with little missing depth."""
    shadows: SaliencyCost = SaliencyCost()
    """Cost function for frames with large shadows."""
    max_missing: Share = 0.03
    """Maximum share of missing depth in a frame for which the cost function `full` is used. Missing depth at the image
    border or beyond `Rejection.max_distance_m` is not counted. The default is our choice.
    """


Cost = Annotated[SaliencyCost | BoundaryCost | AutoCost, Field(discriminator="kind")]


class Partition(Settings):
    """Merging of pixels into regions, by comparison of edge weights inside and between regions (equations 2 and 3)."""

    gamma: NotNegative = 0.0016
    """Threshold gamma of equation 3, in units of edge weight times pixels. A larger gamma gives larger regions. The
    paper uses 5 (preset SHELF), 0.0016 (TABLE) and 0.001 (CLUTTER).
    """
    gamma_shadows: NotNegative | None = None
    """Threshold gamma of equation 3 for frames with the cost function `AutoCost.shadows`. The weights of the cost
    function `AutoCost.shadows` are larger by orders of magnitude than those of `AutoCost.full`. A larger gamma gives
    larger regions.
    """
    connectivity: Literal[4, 8] = 8
    """Number of neighbouring pixels to which each pixel is connected in the graph. The default comes from the authors'
    code.
    """
    min_size_px2: Area_px2 = 500.0
    """Minimum area of a region, px^2 at 640x480. A smaller region is merged with its most similar neighbouring region.
    The default comes from the authors' code.
    """


class Rejection(Settings):
    """Rules that reject regions (paper, section III-F). A rejection rule with the value None is switched off."""

    max_distance_m: Positive | None = None
    """Maximum distance of a region's centroid from the camera, in metres. Regions beyond this distance are rejected. If
    None, there is no maximum distance. The authors' code uses a maximum distance of 1.8.
    """
    max_lambda1_px2: MaxArea_px2 = None
    """Maximum variance of a region's pixel coordinates along its longer axis (lambda1), px^2. Regions with a larger
    lambda1 are rejected. The authors' code uses a maximum lambda1 of 3800.
    """
    max_lambda2_px2: MaxArea_px2 = None
    """Maximum variance of a region's pixel coordinates along its shorter axis (lambda2), px^2. Regions with a larger
    lambda2 are rejected. The authors' code uses a maximum lambda2 of 950.
    """
    max_eccentricity: Share | None = None
    """Maximum eccentricity sqrt(1 - lambda2 / lambda1) of a region. Regions with a larger eccentricity are rejected.
    The authors' code uses a maximum eccentricity of 0.978.
    """
    max_missing: Share | None = None
    """Maximum share of a region's pixels without depth. Pixels that in-painting filled count as pixels with depth.
    Regions with a larger share of missing depth are rejected. The paper uses a maximum share of 0.3 and no in-painting.
    """
    max_dark: Share | None = None
    """Limit of the share of dark pixels in a region. A pixel is dark if its brightness is at most 23 of 255. A region
    is rejected if its share of dark pixels is equal to the limit or larger. The paper uses a limit of 0.3 for this
    share.
    """
