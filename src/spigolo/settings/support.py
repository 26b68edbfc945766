"""Parameters of the support plane, of the warning of packed objects, and of flat objects."""

from __future__ import annotations

import math
from typing import Annotated

from pydantic import Field, model_validator

from spigolo.settings.parameters import Area_px2, NotNegative, Offset_px, Positive, Settings, Share

Finite = Annotated[float, Field(allow_inf_nan=False)]


class Facing(Settings):
    """Conditions for the direction of the support plane's normal. Objects can stand only on a plane that faces up."""

    up: tuple[Finite, Finite, Finite] | None = None
    """Upward direction in the camera's frame (X right, Y down, Z forward), of any length. If None, the camera is
    assumed to stand upright and to look horizontally or downwards.
    """
    max_tilt_deg: Annotated[float, Field(ge=0, le=90)] = 30.0
    """Maximum angle between the normal of the support plane and the upward direction `up`, in degrees. A larger angle
    accepts steeper planes.
    """
    max_roll_deg: Annotated[float, Field(ge=0, le=90)] = 40.0
    """Maximum angle between the normal of the support plane and the Y-Z plane of the camera's frame, in degrees. A
    plane with a larger angle faces sideways. A plane that faces sideways is accepted only if at least the share
    `min_share_sideways` of the measured pixels lies on it. The limit `max_roll_deg` is used only if the upward
    direction `up` is None.
    """
    max_down_deg: Annotated[float, Field(ge=0, le=90)] = 20.0
    """Maximum angle of the support plane's normal below the X-Z plane of the camera's frame, in degrees. A plane with a
    larger angle faces down, such as a ceiling, and is never used as support plane. The limit `max_down_deg` is used
    only if the upward direction `up` is None.
    """
    min_share_sideways: Share = 0.5
    """Minimum share of the frame's measured pixels on a plane that faces sideways. A sideways plane with at least this
    share of the pixels is accepted, because the camera is probably mounted on its side. The limit `min_share_sideways`
    is used only if the upward direction `up` is None.
    """

    @model_validator(mode="after")
    def _up_points_somewhere(self) -> Facing:
        if self.up is not None and not 1e-6 < math.hypot(*self.up) < math.inf:
            raise ValueError(
                f"expected a direction as additions.support.facing.up, such as [0, -1, 0], got {list(self.up)}"
            )
        return self


class Support(Settings):
    """Detection of the support plane of a frame, and of the pixels that lie above this plane. By default, the support
    plane is the largest plane in the frame.
    """

    min_height_m: Positive = 0.008
    """Minimum height of an object pixel above the support plane, in metres. Pixels with a smaller height count as
    pixels of the plane. With a larger minimum height, more low objects are not found.
    """
    noise_factor: NotNegative | None = None
    """Minimum height of an object pixel above the support plane, as a multiple of the noise of the plane. The noise is
    the standard deviation of the heights of the plane's pixels. If the height computed from the noise is lower than
    `min_height_m`, it replaces `min_height_m`. The step height `Ledge.step_m` is lowered by the same factor as
    `min_height_m`. If None, the minimum height is always `min_height_m`.
    """
    lowest_m: Positive = 0.004
    """Lower limit of the minimum object height that is computed from `noise_factor`, in metres. With a larger limit,
    more low objects are not found.
    """
    noise_per_m: NotNegative = 0.0056
    """Minimum height of an object pixel above the support plane, divided by the squared distance of the pixel, 1/m. The
    minimum height is max(`min_height_m`, `noise_per_m` * distance^2). The default of `noise_per_m` is twice the depth
    error `Smoothing.error_per_m`.
    """
    min_above: Share = 0.6
    """Minimum share of a region's measured pixels that lie above the support plane. Regions with a smaller share of
    pixels above the plane are rejected.
    """
    min_share: Share = 0.15
    """Minimum share of the frame's measured pixels that lie on the support plane. A plane on which fewer pixels lie is
    never used as support plane.
    """
    contour: bool = True
    """Add the outlines of the pixels above the support plane to the boundary map."""
    stacked_share: Positive | None = None
    """Minimum size of a plane that lies above the largest plane and is parallel to it, as a share of the largest
    plane's size. The size of a plane is its number of pixels. An upper plane of at least this size, such as a table
    above the floor, becomes the support plane. If None, planes above the largest plane are not searched.
    """
    facing: Facing | None = None
    """Exclude planes on which nothing can stand, such as ceilings and side walls. If None, planes of any direction are
    accepted.
    """
    min_things: Share | None = None
    """Minimum share of the frame's measured pixels that stand on the support plane. A pixel stands on a plane if it is
    less than 0.3 m above the plane and the plane surrounds it on at least three sides. Few pixels stand on the wall of
    a bin, for example. If too few pixels stand on the largest plane, the largest other plane with at least this share
    of standing pixels is used. If None, the pixels that stand on a plane are not counted.
    """
    max_below: Share | None = None
    """Maximum number of points below the support plane, divided by the number of points on or below the plane. Only
    points that the plane surrounds in the image are counted. If too many points lie below the support plane, it is
    replaced by a parallel plane below it. For example, a plane on the upper side of a heap of objects is replaced by
    the table. If None, the points below the plane are not counted.
    """
    near_roi: NotNegative | None = None
    """Width of a margin around the region of interest, as a share of the height and width of this region. The support
    plane is searched only inside the region of interest and its margin. If None, the support plane is searched in the
    whole frame.
    """
    within_reach: bool = False
    """Use only pixels with a depth of at most `Rejection.max_distance_m` to find the support plane."""
    opaque: bool = False
    """Exclude a plane if many points behind it are visible, such as the plane of the front edges of a shelf. Instead of
    an excluded plane, the next largest plane is used. If more than 40 % of the depth is missing, a plane is also
    excluded if more points lie below it than on it.
    """


class Packing(Settings):
    """Conditions for the warning that a layer of packed objects may have been mistaken for the support plane."""

    min_share: Share = 0.6
    """Minimum share of the frame's measured pixels that lie on the support plane. If fewer pixels lie on the support
    plane, no warning of packed objects is given.
    """
    min_edges: Share = 0.9
    """Minimum share of the support plane's pixels that lie close to an image edge. If fewer pixels lie close to an
    image edge, no warning of packed objects is given.
    """
    max_things: Share = 0.02
    """Maximum share of the frame's measured pixels that stand on the support plane, as defined in `Support.min_things`.
    If more pixels stand on the support plane, no warning of packed objects is given.
    """


class Flats(Settings):
    """Flat objects, such as scissors, disks or printed parts, that lie on the support surface.

    A flat object is a patch between edges of the colour image. The mean height of the patch is a few millimetres larger
    than the height of the surface around the patch. The search for flat objects requires `Additions.support`, and a
    cost function that uses the boundary map.
    """

    min_height_m: Positive = 0.005
    """Minimum height of a flat object above the surface around it, in metres. With a smaller minimum height, thinner
    objects are found, but also bumps of an uneven surface.
    """
    noise_factor: NotNegative = 2.0
    """Minimum height of a flat object, as a multiple of the depth noise of the support surface. The larger one of this
    minimum height and `min_height_m` is used.
    """
    band_m: Positive = 0.02
    """Maximum height of a flat object, in metres. The partition into regions finds higher objects."""
    min_cell_px2: Area_px2 = 40.0
    """Minimum area of a cell in px^2. A cell is a connected area between image edges. The height of cells with a
    smaller area is not measured.
    """
    min_area_px2: Area_px2 = 500.0
    """Minimum area of a flat object in px^2. With a smaller minimum area, more objects are found."""
    max_share: Share = 0.08
    """Maximum area of a flat object, as a share of the image."""
    min_ring: Share = 0.95
    """Minimum share of a ring of pixels around a flat object that lies on the support surface. Pixels of other raised
    patches in the ring are not counted.
    """
    gap_px: Offset_px = 3
    """Half of the approximate distance between a flat object and the ring of pixels around it, in pixels. Depth near
    outlines is smeared, so the ring does not begin at the outline of the object.
    """
    ring_px: Offset_px = 11
    """Approximate distance between a flat object and the outer border of the ring of pixels around it, in pixels. The
    ring around a flat object is at least 2 pixels wide.
    """
