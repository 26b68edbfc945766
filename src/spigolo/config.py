"""Every number of the method, one frozen model per stage.

Each field says its unit, its range and where its value comes from: "paper" (printed in Toscana & Rosa 2016),
"authors' release" (a fact about the code they published), "our choice" (the paper is silent, see docs/paper.md).
Lengths and areas in pixels are those of a 640x480 image; areas (`_px2`) scale with the number of pixels.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, model_validator

from spigolo.errors import ConfigError
from spigolo.parameters import Length_px, NotNegative, Parameters, Positive, Share, Stage, parse_toml

VGA_PX2 = 640 * 480
"""The image size that pixel areas are given for."""


class Smoothing(Stage):
    """Depth-dependent smoothing of Holzer et al. 2012 and the paper's mean over valid pixels (eqs. 5-8)."""

    mean: Literal["valid", "plain", "none"] = "valid"
    """`valid` leaves missing pixels out of the mean (eq. 8), `plain` counts them as zeros (eq. 5), `none` leaves
    the depth as it came."""
    error_per_m: Positive = 0.0028
    """alpha: depth error per squared distance, 1/m (authors' release)."""
    radius_per_error_px_m: Positive = 1500.0
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
    inpainting: Inpainting | None = None
    """None fills nothing (the paper's way with the first cost function)."""
    depth_range: Positive | None = None
    """Depth difference in metres that counts as 1 in eq. 9; None takes the range of each frame (authors' release)."""
    noise_per_m: NotNegative = 0.0
    """Differences up to this times the squared distance count as none in eq. 9, 1/m: depth comes in steps, and the
    borders of those steps would stay in a large region of equal depths (our addition; the paper has 0)."""


class Color(Stage):
    """The colour difference (eq. 4)."""

    sigma_px: NotNegative = 0.8
    """Gaussian smoothing of RGB before HSV; 0 smooths nothing (authors' release, there after HSV)."""
    k_dv: Positive = 4.5
    """Weight of the value difference (paper)."""
    k_ds: NotNegative = 0.1
    """Weight of the hue and saturation difference (paper)."""


class Saliency(Stage):
    """Centre-surround saliency of Montabone & Soto 2010 and the power law (eq. 10)."""

    surrounds_px: tuple[Annotated[int, Field(ge=1, le=10_000)], ...] = (12, 24, 48, 28, 56, 112)
    """Half-sizes sigma 2^s of the surrounds, for sigma in {3, 7} and s in {2, 3, 4} (Montabone's own code)."""
    power: Positive = 4.0
    """Exponent of eq. 10 (paper)."""


class DepthContours(Stage):
    """Boundaries found in the depth map alone and joined to the final map (our addition, not in the paper).

    Shadows are filled with the farther side of their row for this purpose only, so that the contour of an object
    stands where its shadow begins, and does not depend on a colour edge.
    """

    max_shadow_px: Length_px = 60
    """Widest shadow that is filled so."""
    step_offset_px: Annotated[int, Field(ge=1, le=100)] = 2
    """Where depth is compared on both sides of a pixel."""
    step_m: NotNegative = 0.015
    """Least bend of the depth that makes a step."""
    step_per_m: NotNegative = 0.012
    """The same per squared distance, 1/m, so that noise far away makes no step; the larger of both holds."""
    crease_offset_px: Annotated[int, Field(ge=1, le=100)] = 5
    """Where the three points of a concave crease are sampled."""
    crease_low_deg: Annotated[float, Field(ge=0, le=180)] = 30.0
    """Smallest angle of a crease."""
    crease_high_deg: Annotated[float, Field(ge=0, le=180)] = 140.0
    """Largest angle of a crease; 0 looks for no creases."""


class Edges(Stage):
    """Canny on Scharr gradients, and which of its pixels are boundaries of objects (eqs. 12-20)."""

    canny_low: Share = 0.05
    """Low threshold as a share of the frame's largest gradient (authors' release)."""
    canny_high: Share = 0.075
    """High threshold as a share of the frame's largest gradient (authors' release)."""
    canny_floor: NotNegative = 60.0
    """Least low threshold in units of the Scharr gradient, so that a plain frame shows no noise (our choice);
    the high one keeps its ratio to the low."""
    step_offset_px: Annotated[int, Field(ge=1, le=100)] = 7
    """epsilon_rho: where depth is sampled on both sides (authors' release)."""
    step_m: Positive = 0.03
    """t_rho: depth difference that makes a depth boundary (authors' release)."""
    signed_step: bool = False
    """True compares the signed difference as printed in eq. 13; it misses edges seen from the near side."""
    missing_is_boundary: bool = False
    """True counts a missing sample as a depth step; by default missing depth is no evidence."""
    contact_offset_px: Annotated[int, Field(ge=1, le=100)] = 5
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
    blur_px: Annotated[int, Field(ge=1, le=99)] = 7
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


class Support(Stage):
    """The largest plane of the frame, and what stands on it (our addition, not in the paper)."""

    min_height_m: Positive = 0.008
    """What rises less above the plane belongs to it."""
    noise_per_m: NotNegative = 0.0056
    """The same per squared distance, 1/m: twice the depth error; the larger of both holds."""
    min_above: Share = 0.6
    """Least share of a region's measured pixels that must stand above the plane."""
    min_share: Share = 0.15
    """A plane with a smaller share of the measured pixels supports nothing."""
    contour: bool = True
    """Join the border of what stands above the plane to the final map, where the cost reads that."""
    stacked_share: Positive | None = None
    """Take the largest plane that lies above the largest one and along it, if it has at least this share of that one's
    pixels: the table in place of the floor below it. None takes the largest."""


class Wall(Stage):
    """Walls and rims of bins and shelves, which stand as tall as objects do (our addition, not in the paper)."""

    min_hides: Share = 0.15
    """Least share of a region's contour beyond which depth steps back; the image border hides nothing."""
    min_hides_cut: NotNegative = 0.7
    """More is asked of regions that the image cuts off: plus this times the share of their contour on its border.
    Where half of it lies there, none can hide enough."""
    min_height_m: Positive = 0.06
    """Regions less than 5 % of which stand so high above the support are not asked: low objects hide little. Without a
    support all are asked."""
    min_measured: Share = 0.4
    """Nor are those of whose contour a smaller share has depth on both sides."""
    reach_px: Annotated[int, Field(ge=1, le=100)] = 4
    """Where depth is compared on both sides of the contour; grows with the image."""
    step_m: NotNegative = 0.012
    """Least step back, beyond what the region's own slope there explains,"""
    step_share: Share = 0.006
    """plus this share of the distance."""
    max_lean_deg: Annotated[float, Field(ge=0, le=180)] = 48.0
    """Largest angle between a region's mean normal and the line of sight. The faces of a whole object look towards the
    camera on average, three faces of a box at a corner straight at it; the side of a compartment is seen at a slant."""
    leaning_deg: Annotated[float, Field(ge=0, le=180)] = 40.0
    """Beyond this angle already more is asked:"""
    min_hides_leaning: Share = 0.35
    """an object that leans so far stands free, the side of a compartment goes over into its back."""
    max_cut_ratio: Annotated[float, Field(ge=1)] = 3.5
    """Largest length over width of a region that the image cuts off: longer ones are rails, rims or legs."""
    rim_m: Positive = 0.01
    """A level region, 65 % of which lie within this of its median height above the support, may be part of a rim;"""
    max_rim: NotNegative = 1.5
    """it is one if at that height there lie more than so many times its pixels that belong to no object."""


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


class Vessel(Stage):
    """Wall and inside of a cup, bowl or pot. Hollowness: depth of a region's middle behind its chords along image rows,
    as a share of their length; positive where it curves away from the camera.
    """

    min_behind_m: Positive = 0.02
    """Least mean depth step from the wall to the inside."""
    max_hollow_front: float = -0.1
    """Largest hollowness of the wall, which bulges."""
    min_hollow_back: float = -0.11
    """Least hollowness of the inside, which looks flat where its back alone is seen or depth is missing."""
    min_contrast: float = 0.15
    """Least difference of both."""
    top_m: NotNegative = 0.008
    """Both end at one height above the support, within this,"""
    top_share: Share = 0.1
    """or within this share of it."""
    min_solidity: Share = 0.87
    """Least share of their convex hull that both fill together."""
    sure_hollow_back: float = -0.01
    """An inside at least so hollow,"""
    sure_contrast: float = 0.25
    """and by so much more than the wall, is one beyond doubt:"""
    sure_solidity: Share = 0.75
    """then this share is enough."""


class Cap(Stage):
    """The upper face of an object, or the inside of a cup that the camera saw filled."""

    max_gap_m: Positive = 0.02
    """Largest mean depth step between both."""
    min_behind_m: NotNegative = 0.003
    """Least by which the upper one lies behind."""
    top_share: Share = 0.2
    """Both end at one height above the support, within this share of it."""
    min_solidity: Share = 0.93
    """Least share of their convex hull that both fill together."""


class Smooth(Stage):
    """A surface that goes on, flat or convex, where noise looked like a contour."""

    max_gap_m: Positive = 0.025
    """Largest mean depth step across the border."""
    max_bend_m: float = 0.00125
    """Largest mean depth of the border behind the chord of its sides: more is a valley between two objects."""
    max_boundary: Share = 0.75
    """Largest mean boundary along the border."""


class Joining(Stage):
    """Which regions are parts of one object (our addition, not in the paper). None leaves a rule out."""

    vessel: Vessel | None = None
    cap: Cap | None = None
    smooth: Smooth | None = None
    enclosed: Share | None = None
    """Least share of its surroundings that belongs to one object for a region on the plane to be part of it."""
    reach_px: Annotated[int, Field(ge=1, le=100)] = 4
    """Where both sides of a border are sampled."""
    margin_px: Annotated[int, Field(ge=0, le=100)] = 3
    """How far inside a region the ends of its chords are taken: depth at a contour is a mixture."""
    min_border_px: Annotated[int, Field(ge=1)] = 12
    """Shorter borders say nothing."""
    min_measured: Share = 0.5
    """Least share of a border, and of a region, with depth."""
    min_above: Share = 0.5
    """Least share of a region's measured pixels above the support for it to stand there."""
    max_share: Share = 0.25
    """Regions with a larger share of the image are no parts."""


class Config(Parameters):
    """All of the method's parameters. Frozen: `replace` gives a changed copy."""

    name: str = "custom"
    """Name of the preset; `replace` keeps it and `digest` tells the values apart."""
    depth: Depth = Depth()
    color: Color = Color()
    saliency: Saliency = Saliency()
    edges: Edges = Edges()
    cost: Cost = BoundaryCost()
    partition: Partition = Partition()
    joining: Joining | None = None
    """Joins the parts of an object that the partition cut; None is the paper's method."""
    rejection: Rejection = Rejection()

    @model_validator(mode="after")
    def _gamma_of_each_cost(self) -> Config:
        if isinstance(self.cost, AutoCost) != (self.partition.gamma_shadows is not None):
            raise ValueError("partition.gamma_shadows goes with an AutoCost, and only with it")
        if self.joining is not None and self.rejection.support is None:
            raise ValueError("joining needs rejection.support: its rules ask what stands on the plane")
        return self

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
