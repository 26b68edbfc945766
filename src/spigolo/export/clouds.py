"""Export of a coloured point cloud for each object, in metres in the camera's frame."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from spigolo.frames.files import PathLike, write_bytes
from spigolo.objects.segmentation import ObjectMask, Segmentation

Points = npt.NDArray[np.float32]
Colors = npt.NDArray[np.uint8]
Encoder = Callable[[int, Points, Colors], bytes]

PLY_POINT = np.dtype([("xyz", "<f4", 3), ("rgb", "u1", 3)])
PCD_POINT = np.dtype([("xyz", "<f4", 3), ("rgb", "<u4")])
PLY_HEADER = """ply
format binary_little_endian 1.0
comment object {label}, camera frame: X right, Y down, Z forward, metres
element vertex {count}
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
end_header
"""
PCD_HEADER = """# .PCD v0.7 - object {label}, camera frame: X right, Y down, Z forward, metres
VERSION 0.7
FIELDS x y z rgb
SIZE 4 4 4 4
TYPE F F F U
COUNT 1 1 1 1
WIDTH {count}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {count}
DATA binary
"""


def ply(result: Segmentation, folder: PathLike, trim_m: float | None = None) -> list[Path]:
    """Write a point cloud `object_N.ply` for each object N and return the paths. Other files `object_N.ply` in the
    folder are removed, because they belong to an earlier result.

    trim_m: maximum distance, in metres, of a point from the oriented box of its object. Points farther from the box are
    left out. Raises CameraError without intrinsics.
    """
    return _write_all(result, Path(folder), ".ply", trim_m, _ply)


def pcd(result: Segmentation, folder: PathLike, trim_m: float | None = None) -> list[Path]:
    """Write a point cloud `object_N.pcd` for each object N and return the paths. Other files `object_N.pcd` in the
    folder are removed, because they belong to an earlier result.

    trim_m: maximum distance, in metres, of a point from the oriented box of its object. Points farther from the box are
    left out. Raises CameraError without intrinsics.
    """
    return _write_all(result, Path(folder), ".pcd", trim_m, _pcd)


def _ply(label: int, points: Points, colors: Colors) -> bytes:
    return PLY_HEADER.format(label=label, count=len(points)).encode() + _records(points, PLY_POINT, colors)


def _pcd(label: int, points: Points, colors: Colors) -> bytes:
    packed = (colors.astype(np.uint32) << np.array([16, 8, 0], np.uint32)).sum(axis=1, dtype=np.uint32)
    return PCD_HEADER.format(label=label, count=len(points)).encode() + _records(points, PCD_POINT, packed)


def _records(points: Points, kind: np.dtype[np.void], packed: npt.NDArray[np.generic]) -> bytes:
    out = np.empty(len(points), kind)
    out["xyz"], out["rgb"] = points, packed
    return out.tobytes()


def _write_all(result: Segmentation, folder: Path, suffix: str, trim_m: float | None, encode: Encoder) -> list[Path]:
    written = []
    for o, points, colors in _clouds(result, trim_m):
        written.append(folder / f"object_{o.label}{suffix}")
        write_bytes(written[-1], encode(o.label, points, colors))
    for path in set(folder.glob(f"object_*{suffix}")) - set(written):
        if path.stem.removeprefix("object_").isdecimal():
            path.unlink()
    return written


def _clouds(result: Segmentation, trim_m: float | None) -> Iterator[tuple[ObjectMask, Points, Colors]]:
    """Yield each object with its points (N, 3) in metres and the RGB colours (N, 3) of these points."""
    for o in result:
        points, colors = o.points_m(), result.frame.color[o.mask & (result.frame.depth > 0)]
        box = None if trim_m is None else o.oriented_box()
        if box is not None and trim_m is not None:
            kept = box.contains(points, trim_m)
            points, colors = points[kept], colors[kept]
        yield o, points, colors
