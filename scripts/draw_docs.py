"""Draw the pictures of the docs from the bundled scene: `python scripts/draw_docs.py [--out DIR] [NAME ...]`.

The first is that of `spigolo demo`. Others compare presets, additions and faults of the input. The rest show an open
choice or an addition next to its other reading.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt

import spigolo as sp
from spigolo.frames.files import write_bytes
from spigolo.frames.frame import Color, DepthMap
from spigolo.settings import EdgesConfig, Inpainting, Smoothing
from spigolo.stages.depth import inpaint_small_gaps, smooth
from spigolo.stages.edges import EdgeMaps, find_edges
from spigolo.view.overlay import boundary_picture, depth_picture, draw_boxes, region_picture, tile

SCENE = Path(sp.__file__).parent / "demo_scene"
IMAGES = Path(__file__).resolve().parents[1] / "docs" / "images"
QUALITY = 88
MOST_BYTES = 200_000

Window = tuple[int, int, int, int]
"""(y0, x0, y1, x1), the last two exclusive."""
BOX_CORNER, CEREAL, RIGHT_HALF = (72, 66, 172, 186), (60, 70, 220, 240), (95, 230, 330, 600)
LEFT_HALF = (100, 92, 320, 352)
CEREAL_TO_CAN = (60, 85, 265, 355)
BOXES = (150, 380, 310, 570)
BOXES_ON_THEIR_SIDE = (65, 105, 225, 280)

NOISE_PER_M = 0.0028
"""The noise floor of OBJECTS, 1/m."""

GROUND, CANNY, STEP, CONTACT = (30, 30, 30), (110, 110, 110), (255, 150, 30), (60, 220, 90)


def main() -> None:
    parser = argparse.ArgumentParser(description="Draw the pictures of the docs from the bundled scene.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"default: all of {', '.join(PICTURES)}")
    parser.add_argument("--out", type=Path, default=IMAGES, help="folder to write to")
    arguments = parser.parse_args()
    frame = sp.read_frame(SCENE / "rgb.png", SCENE / "depth.png", SCENE / "camera.json")
    for name in arguments.names or PICTURES:
        write_jpeg(arguments.out / f"{name}.jpg", PICTURES[name](frame))


def demo(frame: sp.Frame) -> Color:
    """The picture of `spigolo demo`, smaller."""
    run = sp.trace(frame)
    result = run.segmentation
    pictures = {
        "colour": frame.color,
        "depth (black: missing)": depth_picture(frame.depth),
        "boundaries of objects": boundary_picture(run),
        f"{len(result)} objects with their boxes": draw_boxes(result.overlay(), result, frame.camera),
    }
    picture = tile(pictures, columns=2)
    size = 1000, round(picture.shape[0] * 1000 / picture.shape[1])
    return np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), np.uint8)


def mean_of_windows(frame: sp.Frame) -> Color:
    """Eq. 5 against eq. 8 at a shadow."""
    plain, valid = (smooth(frame.depth, Smoothing(mean=mean)) for mean in ("plain", "valid"))
    depths = {"measured": frame.depth, "plain mean (eq. 5)": plain, "mean of valid pixels (eq. 8)": valid}
    pictures = {title: zoom(grey(depth), BOX_CORNER, 4) for title, depth in depths.items()}
    pictures["colour"] = zoom(frame.color, BOX_CORNER, 4)
    pictures["plain - measured (dark: nearer)"] = zoom(change(plain, frame.depth), BOX_CORNER, 4)
    pictures["valid - measured"] = zoom(change(valid, frame.depth), BOX_CORNER, 4)
    return tile(pictures, columns=3)


def sign_of_step(frame: sp.Frame) -> Color:
    """Eq. 13 with the absolute and with the signed difference."""
    choices = {"absolute step": EdgesConfig(), "signed step (as printed)": EdgesConfig(signed_step=True)}
    return edge_choice(frame, BOXES, choices)


def missing_samples(frame: sp.Frame) -> Color:
    """Eq. 13 where a sample is missing."""
    choices = {
        "missing samples: no evidence": EdgesConfig(),
        "missing samples: a boundary": EdgesConfig(missing_is_boundary=True),
    }
    return edge_choice(frame, CEREAL, choices)


def sign_rule(frame: sp.Frame) -> Color:
    """Eq. 19 with both rules, of the scene as a camera on its side sees it."""
    height, width = frame.shape[::-1]
    camera = sp.Camera(525, 525, (width - 1) / 2, (height - 1) / 2, width, height)
    turned = sp.Frame(np.rot90(frame.color), np.rot90(frame.depth), camera)
    choices = {
        'sign_rule = "tangent"': EdgesConfig(),
        'sign_rule = "x" (as printed)': EdgesConfig(sign_rule="x"),
    }
    return edge_choice(turned, BOXES_ON_THEIR_SIDE, choices)


def texture_edges(frame: sp.Frame) -> Color:
    """Canny's edges and what eq. 20 leaves of them."""
    edges = edge_maps(frame, EdgesConfig())
    canny = np.where(edges.canny[..., None], np.uint8(235), np.uint8(30)) * np.ones(3, np.uint8)
    final = np.where(edges.final[..., None], np.uint8(235), np.uint8(30)) * np.ones(3, np.uint8)
    pictures = {
        "colour": frame.color,
        f"E_E: {int(edges.canny.sum())} px": canny,
        f"E_F: {int(edges.final.sum())} px": final,
    }
    return tile({title: zoom(picture, CEREAL_TO_CAN, 2) for title, picture in pictures.items()}, columns=3)


def soft_boundary(frame: sp.Frame) -> Color:
    """Eq. 23 on a soft and on a thin map."""
    pictures = {}
    for name in ("soft", "thin"):
        run = sp.trace(frame, sp.TABLE.replace(**{"edges.boundary": name}))
        cue = np.round(run.cues.delta_bound * 255).astype(np.uint8)
        pictures[f"{name}: the cue"] = zoom(cv2.cvtColor(cue, cv2.COLOR_GRAY2RGB), RIGHT_HALF, 1.5)
        pictures[f"{name}: regions of TABLE"] = zoom(region_picture(run.regions.labels), RIGHT_HALF, 1.5)
    return tile(pictures, columns=2)


def larger_end(frame: sp.Frame) -> Color:
    """Eq. 23 with the larger of both ends and with the first one, on a thin map.

    Of the preset that is 8-connected: on a 4-connected grid no edge slips diagonally through a thin line.
    """
    pictures = {}
    for ends, title in (("max", "larger of both ends"), ("i", "first end, as printed")):
        run = sp.trace(frame, sp.PRESETS["OBJECTS_1"].replace(**{"edges.boundary": "thin", "cost.ends": ends}))
        pictures[f"{title}: {run.regions.count} regions"] = region_picture(run.regions.labels)[40:420]
    return tile(pictures, columns=2)


def depth_contours(frame: sp.Frame) -> Color:
    """Boundaries and regions with and without depth contours.

    The support plane is off, because it closes feet too. Joining is off, because it requires the plane.
    """
    with_them = sp.OBJECTS.replace(additions={"joining": None, "support": None})
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
    """Objects with and without the support plane, and the plane. The preset has no rule for walls."""
    found = sp.segment(frame, sp.PRESETS["OBJECTS_1"])
    without = sp.segment(frame, sp.PRESETS["OBJECTS_1"].replace(**{"additions.support": None}))
    plane = (frame.color * np.float32(0.45)).astype(np.uint8)
    assert found.support is not None
    plane[found.support] = (0.6 * frame.color[found.support] + 0.4 * np.array(CONTACT)).astype(np.uint8)
    return tile(
        {
            f"without: {len(without)} objects": without.overlay(),
            "the plane (result.support)": plane,
            f"with it: {len(found)} objects": found.overlay(),
        },
        columns=3,
    )


def noise_floor(frame: sp.Frame) -> Color:
    """Regions with and without the noise floor of eq. 9. Merging is off, because it removes most of the bands."""
    pictures = {}
    for title, config in {
        "noise_per_m = 0": sp.OBJECTS.replace(additions={"noise_per_m": 0.0, "merging": None}),
        f"noise_per_m = {NOISE_PER_M}": sp.OBJECTS.replace(additions={"noise_per_m": NOISE_PER_M, "merging": None}),
    }.items():
        regions = sp.trace(frame, config).regions
        pictures[f"{title}: {regions.count} regions"] = region_picture(regions.labels)
    return tile(pictures, columns=2)


def presets(frame: sp.Frame) -> Color:
    """Objects of each preset."""
    pictures = {"colour": frame.color}
    for name, config in (("OBJECTS", sp.OBJECTS), ("TABLE", sp.TABLE), ("CLUTTER", sp.CLUTTER), ("SHELF", sp.SHELF)):
        result = sp.segment(frame, config)
        pictures[f"{name}: {len(result)} objects"] = result.overlay()
    pictures["depth (black: missing)"] = depth_picture(frame.depth)
    return tile({title: smaller(picture) for title, picture in pictures.items()}, columns=3)


def additions(frame: sp.Frame) -> Color:
    """Objects with all additions, and with one of them left out."""
    configs = {"all additions": sp.OBJECTS}
    for name, off in {
        "no contours": {"additions.contours": None},
        "no support, no joining": {"additions.support": None, "additions.joining": None},
        "no joining": {"additions.joining": None},
        "no refinement": {"additions.refinement": None},
        "none of them": {"additions": None},
    }.items():
        configs[name] = sp.OBJECTS.replace(**off)
    results = {name: sp.segment(frame, config) for name, config in configs.items()}
    return tile({f"{name}: {len(r)} objects": smaller(r.overlay()) for name, r in results.items()}, columns=3)


def wrong_inputs(frame: sp.Frame) -> Color:
    """Objects found in inputs with a fault, for the page of symptoms."""
    camera = frame.camera
    assert camera is not None
    shifted = np.roll(frame.depth, 25, axis=1)
    holes = np.where(np.arange(frame.shape[1]) % 32 < 20, np.float32(0), frame.depth)
    frames = {
        "a good frame": frame,
        "depth in wrong units (x 10)": sp.Frame(frame.color, frame.depth * 10, camera),
        "depth 25 px to the right": sp.Frame(frame.color, shifted, camera),
        "no intrinsics": sp.Frame(frame.color, frame.depth, None),
        "two thirds of the depth missing": sp.Frame(frame.color, holes, camera),
        "a frame without its table": sp.Frame(frame.color, np.where(table(frame), 0, frame.depth), camera),
    }
    results = {name: sp.segment(spoilt) for name, spoilt in frames.items()}
    return tile({f"{name}: {len(r)}": smaller(r.overlay()) for name, r in results.items()}, columns=3)


def table(frame: sp.Frame) -> npt.NDArray[np.bool_]:
    """Background pixels on the support plane."""
    support = sp.segment(frame).support
    assert support is not None
    return support


def smaller(picture: Color) -> Color:
    """A picture at half the size, for six in one."""
    return np.asarray(cv2.resize(picture, None, fx=0.6, fy=0.6, interpolation=cv2.INTER_AREA), np.uint8)


def edge_choice(frame: sp.Frame, window: Window, choices: dict[str, EdgesConfig]) -> Color:
    """The colour image and the boundaries of two settings, enlarged."""
    pictures = {"colour": zoom(frame.color, window, 3)}
    for title, config in choices.items():
        pictures[title] = zoom(edge_picture(edge_maps(frame, config)), window, 3)
    return tile(pictures, columns=3)


def edge_maps(frame: sp.Frame, config: EdgesConfig) -> EdgeMaps:
    """The paper's edges on in-painted and smoothed depth, as TABLE has them."""
    depth = smooth(inpaint_small_gaps(frame.depth, Inpainting()), Smoothing())
    return find_edges(frame.color, depth, frame.camera, config)


def edge_picture(edges: EdgeMaps) -> Color:
    """Draw depth boundaries in orange, other contact boundaries in green, other Canny edges in grey."""
    picture = np.full((*edges.canny.shape, 3), GROUND, np.uint8)
    for mask, ink in ((edges.canny, CANNY), (edges.contact_boundary, CONTACT), (edges.depth_boundary, STEP)):
        picture[mask] = ink
    return picture


def zoom(picture: npt.NDArray[np.uint8], window: Window, factor: float) -> Color:
    """A window of a picture, enlarged without smoothing."""
    y0, x0, y1, x1 = window
    part = picture[y0:y1, x0:x1]
    return np.asarray(cv2.resize(part, None, fx=factor, fy=factor, interpolation=cv2.INTER_NEAREST), np.uint8)


def grey(depth: DepthMap) -> Color:
    """Depth from 0.7 to 1.3 m in grey, near = dark, missing = blue."""
    level = np.clip((depth - 0.7) / 0.6 * 190 + 45, 20, 235).astype(np.uint8)
    picture = np.repeat(level[..., None], 3, axis=2)
    picture[depth == 0] = (20, 30, 110)
    return picture


def change(smoothed: DepthMap, measured: DepthMap) -> Color:
    """Difference of depth, black at -40 mm or less, mid-grey at 0, white at +40 mm; missing = blue."""
    level = np.clip((smoothed - measured) / 0.04 * 127 + 128, 0, 255).astype(np.uint8)
    picture = np.repeat(level[..., None], 3, axis=2)
    picture[measured == 0] = (20, 30, 110)
    return picture


def write_jpeg(path: Path, picture: Color) -> None:
    """Write a JPEG that a page can carry, and print its size."""
    done, data = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, QUALITY])
    if not done or data.size > MOST_BYTES:
        raise ValueError(f"{path.name} would have {data.size} bytes, at most {MOST_BYTES} are wanted")
    write_bytes(path, data.tobytes())
    print(f"{path.name}: {picture.shape[1]}x{picture.shape[0]}, {data.size // 1000} kB")


PICTURES: dict[str, Callable[[sp.Frame], Color]] = {
    "demo": demo,
    "presets": presets,
    "additions": additions,
    "wrong-inputs": wrong_inputs,
    "mean-of-windows": mean_of_windows,
    "sign-of-step": sign_of_step,
    "missing-samples": missing_samples,
    "sign-rule": sign_rule,
    "texture-edges": texture_edges,
    "soft-boundary": soft_boundary,
    "larger-end": larger_end,
    "depth-contours": depth_contours,
    "support-plane": support_plane,
    "noise-floor": noise_floor,
}

if __name__ == "__main__":
    main()
