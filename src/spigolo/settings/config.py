"""Every number of the method, one frozen model per stage; those of our additions stand in `additions`.

Each field says its unit, its range and where its value comes from: "paper" (printed in Toscana & Rosa 2016),
"authors' release" (a fact about the code they published), "our choice" (the paper is silent, see docs/paper.md).
Lengths and areas in pixels are those of a 640x480 image; areas (`_px2`) grow with the image, and lengths where
`lengths_grow` is set. Those of in-painting and of `Wall` go with areas and always grow.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from spigolo.errors import ConfigError
from spigolo.settings.additions import DepthContours, Joining, Support, Wall
from spigolo.settings.parameters import (
    Grows,
    Length_px,
    NotNegative,
    Offset_px,
    Parameters,
    Positive,
    Share,
    Stage,
    parse_toml,
)

VGA_PX2 = 640 * 480
"""The image size that pixel areas are given for."""


class Smoothing(Stage):
    """Depth-dependent smoothing of Holzer et al. 2012 and the paper's mean over valid pixels (eqs. 5-8)."""

    mean: Literal["valid", "plain", "none"] = "valid"
    """`valid` leaves missing pixels out of the mean (eq. 8), `plain` counts them as zeros (eq. 5), `none` leaves
    the depth as it came."""
    error_per_m: Positive = 0.0028
    """alpha: depth error per squared distance, 1/m (authors' release)."""
    radius_per_error_px_m: Annotated[Positive, Grows()] = 1500.0
    """beta: smoothing radius per depth error, px/m (authors' release)."""
    step_factor: Positive = 18.0
    """A difference of this many depth errors between neighbours is a depth step (authors' release)."""
    max_radius_px: Length_px = 10
    """Largest radius; wider windows round off the creases that eq. 18 measures (our choice)."""
    skip_steps: bool = True
    """Leave pixels on a depth step out of every mean (authors' release); not with `plain`."""


class Inpainting(Stage):
    """Small gaps are filled, large shadows stay missing (paper, section III-E; limits are our choice)."""

    sampling_holes: bool = True
    """Close holes of one or two pixels first, wherever they are connected to, as a map warped to a larger colour
    image shows a grid of them."""
    max_area_px2: NotNegative = 400.0
    """Largest gap that is filled."""
    max_radius_px: Positive = 6.0
    """Largest inscribed radius of a gap that is filled."""
    step_m: NotNegative = 0.03
    """A rim that spans more than this crosses a depth step: the gap gets the far value, never a ramp."""
    step_share: Share = 0.03
    """The same as a share of the distance; the larger of both holds."""


class Depth(Stage):
    """What happens to depth before it is compared."""

    smoothing: Smoothing = Smoothing()
    """Evens out the noise of the sensor (eqs. 5-8)."""
    inpainting: Inpainting | None = None
    """None fills nothing (the paper's way with the first cost function)."""
    depth_range: Positive | None = None
    """Depth difference in metres that counts as 1 in eq. 9; None takes the range of each frame (authors' release)."""
    noise_per_m: NotNegative = 0.0
    """Differences up to this times the squared distance count as none in eq. 9, 1/m: depth comes in steps, and the
    borders of those steps would stay in a large region of equal depths (our addition; the paper has 0)."""


class Color(Stage):
    """The colour difference (eq. 4)."""

    sigma_px: Annotated[NotNegative, Grows()] = 0.8
    """Gaussian smoothing of RGB before HSV; 0 smooths nothing (authors' release, there after HSV)."""
    k_dv: Positive = 4.5
    """Weight of the value difference (paper)."""
    k_ds: NotNegative = 0.1
    """Weight of the hue and saturation difference (paper)."""


class Saliency(Stage):
    """Centre-surround saliency of Montabone & Soto 2010 and the power law (eq. 10)."""

    surrounds_px: Annotated[tuple[Annotated[int, Field(ge=1, le=10_000)], ...], Grows()] = (12, 24, 48, 28, 56, 112)
    """Half-sizes sigma 2^s of the surrounds, for sigma in {3, 7} and s in {2, 3, 4} (Montabone's own code)."""
    power: Positive = 4.0
    """Exponent of eq. 10 (paper)."""


class Edges(Stage):
    """Canny on Scharr gradients, and which of its pixels are boundaries of objects (eqs. 12-20)."""

    canny_low: Share = 0.05
    """Low threshold as a share of the frame's largest gradient (authors' release)."""
    canny_high: Share = 0.075
    """High threshold as a share of the frame's largest gradient (authors' release)."""
    canny_floor: NotNegative = 60.0
    """Least low threshold in units of the Scharr gradient, so that a plain frame shows no noise (our choice);
    the high one keeps its ratio to the low."""
    step_offset_px: Offset_px = 7
    """epsilon_rho: where depth is sampled on both sides (authors' release)."""
    step_m: Positive = 0.03
    """t_rho: depth difference that makes a depth boundary (authors' release)."""
    signed_step: bool = False
    """True compares the signed difference as printed in eq. 13; it misses edges seen from the near side."""
    missing_is_boundary: bool = False
    """True counts a missing sample as a depth step; by default missing depth is no evidence."""
    contact_offset_px: Offset_px = 5
    """epsilon_e: where the three points of the contact angle are sampled (authors' release)."""
    contact_low_deg: Annotated[float, Field(ge=0, le=180)] = 56.0
    """t_theta_L (authors' release)."""
    contact_high_deg: Annotated[float, Field(ge=0, le=180)] = 154.0
    """t_theta_H (authors' release)."""
    sign_rule: Literal["tangent", "x", "none"] = "tangent"
    """`tangent` takes the sign of the cross product along the edge and holds for every direction; `x` takes its x
    component as printed in eq. 19, which is zero for upright edges; `none` takes none: internal boundaries stay."""
    boundary: Literal["soft", "thin"] = "soft"
    """`soft` blurs the final map and rescales it to 1, which closes its gaps (authors' release); `thin` is eq. 20."""
    line_px: Offset_px = 1
    """Width of the lines of the final map where the second cost function reads it; 1 is eq. 20 (our addition)."""
    blur_px: Annotated[int, Field(ge=1, le=99), Grows(odd=True)] = 7
    """Width of the Gaussian that makes the map soft, odd (authors' release)."""
    depth_contours: DepthContours | None = None
    """Boundaries from depth alone, joined to the map before it is made soft; None is the paper's method."""

    @model_validator(mode="after")
    def _ordered(self) -> Edges:
        if self.canny_low > self.canny_high or self.contact_low_deg > self.contact_high_deg:
            raise ValueError("a low threshold is above its high one")
        if self.blur_px % 2 == 0:
            raise ValueError("blur_px must be odd")
        return self


Ends = Literal["max", "i"]


class SaliencyCost(Stage):
    """First cost function (eq. 22): colour, depth and saliency; for frames with large shadows."""

    kind: Literal["saliency"] = "saliency"
    """Which cost function a table of a file means."""
    k_x: NotNegative = 1.05
    """Weight of the depth difference (paper)."""
    k_y: NotNegative = 1.5
    """Weight of the colour difference (paper)."""
    k_s: NotNegative = 0.5
    """Weight of the saliency (paper)."""
    ends: Ends = "max"
    """Saliency at the first end of an edge as printed (`i`), or the larger of both ends (our choice)."""


class BoundaryCost(Stage):
    """Second cost function (eq. 23): depth times colour, and the boundary map; for frames with full depth."""

    kind: Literal["boundary"] = "boundary"
    """Which cost function a table of a file means."""
    k_x: NotNegative = 7.5
    """Weight of the depth and colour term (paper)."""
    k_b: NotNegative = 0.66
    """Weight of the boundary (paper)."""
    ends: Ends = "max"
    """Boundary at the first end of an edge as printed (`i`), or the larger of both ends (our choice)."""

    @model_validator(mode="after")
    def _weighs(self) -> BoundaryCost:
        if self.k_x + self.k_b <= 0:
            raise ValueError("k_x and k_b are both zero")
        return self


class AutoCost(Stage):
    """Chooses a cost function for each frame by its missing depth, as the paper does by hand."""

    kind: Literal["auto"] = "auto"
    """Which cost function a table of a file means."""
    full: BoundaryCost = BoundaryCost()
    """For frames whose depth is complete."""
    shadows: SaliencyCost = SaliencyCost()
    """For frames with large shadows."""
    max_missing: Share = 0.03
    """Up to this share of the frame missing inside the working range, `full` is taken (our choice)."""

    def choose(self, missing: float) -> SaliencyCost | BoundaryCost:
        """The cost for a frame of which the share `missing` lacks depth inside the working range."""
        return self.full if missing <= self.max_missing else self.shadows


Cost = Annotated[SaliencyCost | BoundaryCost | AutoCost, Field(discriminator="kind")]


class Partition(Stage):
    """Merging by internal difference (eqs. 2, 3)."""

    gamma: NotNegative = 0.0016
    """gamma of eq. 3: weight times pixels (paper: 5, 0.0016, 0.001)."""
    gamma_shadows: NotNegative | None = None
    """gamma for the frames that AutoCost gives to its `shadows` cost, whose weights are larger by orders."""
    connectivity: Literal[4, 8] = 8
    """Neighbours of a pixel (authors' release)."""
    min_size_px2: NotNegative = 500.0
    """Smaller regions are joined to the neighbour they differ from least (authors' release)."""


class Rejection(Stage):
    """Which regions are no objects (paper, section III-F). None switches a rule off."""

    support: Support | None = None
    """Regions that do not stand above the support plane are parts of it, or lie below (our addition)."""
    wall: Wall | None = None
    """Tall regions that hide nothing, lean away or lie in a rim are walls; asks for a support (our addition)."""
    min_contour: Share | None = None
    """Least mean strength of a region's border, of the boundary or, where the cost reads none, of the weights (our
    addition)."""
    max_distance_m: Positive | None = None
    """Out of reach: distance of the centroid from the camera (authors' release: 1.8)."""
    max_lambda1_px2: Positive | None = None
    """Larger eigenvalue of the pixel coordinates' covariance (authors' release: 3800)."""
    max_lambda2_px2: Positive | None = None
    """Smaller eigenvalue (authors' release: 950)."""
    max_length_m: Positive | None = None
    """Length of a rectangle with the region's spread at its distance, in place of the larger eigenvalue wherever
    intrinsics say what a pixel measures (our addition)."""
    max_width_m: Positive | None = None
    """Its width, in place of the smaller one (our addition)."""
    max_eccentricity: Share | None = None
    """sqrt(1 - lambda2 / lambda1) (authors' release: 0.978)."""
    max_missing: Share | None = None
    """Share of pixels without depth, after in-painting where it is on (paper: 0.3, without in-painting)."""
    max_dark: Share | None = None
    """Share of pixels in the first three of 32 brightness bins, 0..23 of 255 (paper: 0.3)."""


class Config(Parameters):
    """All of the method's parameters. Frozen: `replace` gives a changed copy."""

    name: str = "custom"
    """Name of the preset; `replace` keeps it and `digest` tells the values apart."""
    depth: Depth = Depth()
    """What happens to depth before it is compared (eqs. 5-9)."""
    color: Color = Color()
    """How colours are compared (eq. 4)."""
    saliency: Saliency = Saliency()
    """What stands out from its surroundings (eq. 10), where the cost reads it."""
    edges: Edges = Edges()
    """Where boundaries of objects lie (eqs. 12-20), where the cost reads them."""
    cost: Cost = BoundaryCost()
    """What an edge of the graph weighs (eqs. 22, 23)."""
    partition: Partition = Partition()
    """How pixels merge into regions (eqs. 2, 3)."""
    joining: Joining | None = None
    """Joins the parts of an object that the partition cut; None is the paper's method."""
    rejection: Rejection = Rejection()
    """Which regions are no objects (section III-F)."""
    lengths_grow: bool = False
    """Lengths in pixels grow with the image, so that twice the resolution shows the same edges, twice as wide (our
    addition). False takes them as they are: all images of the paper have 640x480 pixels."""

    @model_validator(mode="after")
    def _gamma_of_each_cost(self) -> Config:
        if isinstance(self.cost, AutoCost) != (self.partition.gamma_shadows is not None):
            raise ValueError("partition.gamma_shadows goes with an AutoCost, and only with it")
        if self.joining is not None and self.rejection.support is None:
            raise ValueError("joining needs rejection.support: its rules ask what stands on the plane")
        return self

    def at_size(self, shape: tuple[int, int]) -> Config:
        """The configuration for images (H, W): its lengths in pixels are those of this size, and grow no more."""
        if not self.lengths_grow:
            return self
        factor = math.sqrt(shape[0] * shape[1] / VGA_PX2)
        return self.grown(factor).model_copy(update={"lengths_grow": False})

    def to_toml(self) -> str:
        """The values as TOML; `from_toml` reads them back."""
        import tomli_w

        return tomli_w.dumps(self.model_dump(exclude_none=True))

    @classmethod
    def from_toml(cls, text: str) -> Config:
        """Reads the TOML that `to_toml` writes; a key left out keeps its default, an unknown one is refused."""
        return cls(**parse_toml(text))


def check_config(value: object) -> None:
    """Raises ConfigError for what is no configuration, such as a preset's name."""
    if not isinstance(value, Config):
        raise ConfigError(f"expected a Config such as spigolo.TABLE or spigolo.preset(NAME), got {value!r}")
