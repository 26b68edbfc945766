"""Pictures that compare results of the preset OBJECTS with and without one of our additions to the paper's method."""

from __future__ import annotations

import warnings

import spigolo as sp
from pictures import scenes
from pictures.layout import smaller, support_picture, zoom
from spigolo.frames.frame import Color
from spigolo.settings.additions import NEED_SUPPORT
from spigolo.view.overlay import boundary_picture, region_picture, tile

LEFT_HALF = (100, 92, 320, 352)
NO_SUPPORT = {f"additions.{name}": None for name in ("support", *NEED_SUPPORT)}
"""Changes of a preset that switch off the support plane and all additions that require it."""
NOISE_PER_M = 0.0028
"""Value of the parameter `Additions.noise_per_m` in the preset OBJECTS, in 1/m."""


def additions(frame: sp.Frame) -> Color:
    """Draw the objects that the preset OBJECTS finds with all additions to the paper's method, without some additions,
    and without any addition.
    """
    configs = {"all additions": sp.OBJECTS}
    for name, off in {
        "no contours": {"additions.contours": None},
        "no support plane": NO_SUPPORT,
        "no joining": {"additions.joining": None},
        "no refinement": {"additions.refinement": None},
        "none of them": {"additions": None},
    }.items():
        configs[name] = sp.OBJECTS.replace(**off)
    results = {name: sp.segment(frame, config) for name, config in configs.items()}
    return tile({f"{name}: {len(r)} objects": smaller(r.overlay()) for name, r in results.items()}, columns=3)


def depth_contours(frame: sp.Frame) -> Color:
    """Draw boundaries and regions with and without depth contours.

    The support plane is switched off, because it also adds contours at the feet of objects.
    """
    with_them = sp.OBJECTS.replace(**NO_SUPPORT)
    pictures = {}
    for title, config in {
        "without": with_them.replace(**{"additions.contours": None}),
        "with depth contours": with_them,
    }.items():
        run = sp.trace(frame, config)
        pictures[f"{title}: boundaries"] = zoom(boundary_picture(run), LEFT_HALF, 2)
        pictures[f"{title}: regions"] = zoom(region_picture(run.regions.labels), LEFT_HALF, 2)
    return tile(pictures, columns=2)


def support_plane(frame: sp.Frame) -> Color:
    """Draw the support plane, and the objects that the preset OBJECTS_1 finds with and without the support plane."""
    found = sp.segment(frame, sp.PRESETS["OBJECTS_1"])
    without = sp.segment(frame, sp.PRESETS["OBJECTS_1"].replace(**NO_SUPPORT))
    return tile(
        {
            f"without: {len(without)} objects": without.overlay(),
            "the plane (result.support)": support_picture(found),
            f"with it: {len(found)} objects": found.overlay(),
        },
        columns=3,
    )


def noise_floor(frame: sp.Frame) -> Color:
    """Draw regions with and without the noise floor of equation 9. The merging of regions is switched off, because
    merging also removes most borders at depth quantisation steps.
    """
    pictures = {}
    for title, config in {
        "noise_per_m = 0": sp.OBJECTS.replace(additions={"noise_per_m": 0.0, "merging": None}),
        f"noise_per_m = {NOISE_PER_M}": sp.OBJECTS.replace(additions={"noise_per_m": NOISE_PER_M, "merging": None}),
    }.items():
        regions = sp.trace(frame, config).regions
        pictures[f"{title}: {regions.count} regions"] = region_picture(regions.labels)
    return tile(pictures, columns=2)


def merging() -> Color:
    """Draw the regions of a near table with noisy depth, with and without the merging of regions."""
    frame = scenes.groceries()
    pictures = {"colour": frame.color}
    for title, config in {
        "without merging": sp.OBJECTS.replace(**{"additions.merging": None}),
        "with merging": sp.OBJECTS,
    }.items():
        regions = sp.trace(frame, config).regions
        pictures[f"{title}: {regions.count} regions"] = region_picture(regions.labels)
    return tile({title: smaller(picture) for title, picture in pictures.items()}, columns=3)


def ledge() -> Color:
    """Draw the objects found among low boxes far from the camera, with and without the rule that keeps low objects."""
    flat = scenes.flat_boxes((9, 10, 11, 12, 13, 15), distance_m=0.9)
    config = sp.OBJECTS.replace(additions={"flats": None})
    without = sp.segment(flat.frame, config.replace(**{"additions.rules.ledge": None}))
    found = sp.segment(flat.frame, config)
    return tile(
        {
            "colour, heights in mm": zoom(flat.labelled(), flat.window, 1),
            f"without ledge: {len(without)} objects": zoom(without.overlay(), flat.window, 1),
            f"with ledge: {len(found)} objects": zoom(found.overlay(), flat.window, 1),
        },
        columns=3,
    )


def flats() -> Color:
    """Draw the objects found among very low boxes, with and without the search for flat objects."""
    flat = scenes.flat_boxes((1, 4, 6, 7, 8, 9), distance_m=0.9)
    without = sp.segment(flat.frame, sp.OBJECTS.replace(additions={"flats": None}))
    found = sp.segment(flat.frame)
    return tile(
        {
            "colour, heights in mm": zoom(flat.labelled(), flat.window, 1),
            f"without flats: {len(without)} objects": zoom(without.overlay(), flat.window, 1),
            f"with flats: {len(found)} objects": zoom(found.overlay(), flat.window, 1),
        },
        columns=3,
    )


def packing() -> Color:
    """Draw a layer of packed boxes that causes a warning, and the same layer with one higher box."""
    layer, raised = scenes.packed_layer(0.0), scenes.packed_layer(0.05)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        packed = sp.segment(layer)
    assert len(told) == 1 and "packed" in str(told[0].message)
    found = sp.segment(raised)
    return tile(
        {
            "packed boxes": smaller(layer.color),
            f"the support (green): {len(packed)} objects, a warning": smaller(support_picture(packed)),
            f"one box 5 cm higher: {len(found)} object": smaller(found.overlay()),
        },
        columns=3,
    )
