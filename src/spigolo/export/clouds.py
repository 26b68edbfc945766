"""Export of a coloured point cloud for each object, in metres in the camera's frame."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from spigolo.frames.files import PathLike, write_bytes
from spigolo.objects.segmentation import ObjectMask, Segmentation

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
    """Write a point cloud `object_N.ply` for each object N and return the paths. Raises CameraError without
    intrinsics.

    trim_m: maximum distance, in metres, of a point from the oriented box of its object. Points farther from the box are
    left out.
    """
    return [
        _write(Path(folder) / f"object_{o.label}.ply", PLY_HEADER, o, _records(points, PLY_POINT, colors))
        for o, points, colors in _clouds(result, trim_m)
    ]


def pcd(result: Segmentation, folder: PathLike, trim_m: float | None = None) -> list[Path]:
    """Write a point cloud `object_N.pcd` for each object N and return the paths. Raises CameraError without
    intrinsics.

    trim_m: maximum distance, in metres, of a point from the oriented box of its object. Points farther from the box are
    left out.
    """
    shifts = np.array([16, 8, 0], np.uint32)
    return [
        _write(
            Path(folder) / f"object_{o.label}.pcd",
            PCD_HEADER,
            o,
            _records(points, PCD_POINT, (colors.astype(np.uint32) << shifts).sum(axis=1, dtype=np.uint32)),
        )
        for o, points, colors in _clouds(result, trim_m)
    ]


def _clouds(
    result: Segmentation, trim_m: float | None
) -> Iterator[tuple[ObjectMask, npt.NDArray[np.float32], npt.NDArray[np.uint8]]]:
    """Yield each object with its points (N, 3) in metres and the RGB colours (N, 3) of these points."""
    for o in result:
        points, colors = o.points_m(), result.frame.color[o.mask & (result.frame.depth > 0)]
        box = None if trim_m is None else o.oriented_box()
        if box is not None and trim_m is not None:
            kept = box.contains(points, trim_m)
            points, colors = points[kept], colors[kept]
        yield o, points, colors


def _records(
    points: npt.NDArray[np.float32], kind: np.dtype[np.void], packed: npt.NDArray[np.generic]
) -> npt.NDArray[np.void]:
    out = np.empty(len(points), kind)
    out["xyz"], out["rgb"] = points, packed
    return out


def _write(path: Path, header: str, o: ObjectMask, records: npt.NDArray[np.void]) -> Path:
    write_bytes(path, header.format(label=o.label, count=len(records)).encode() + records.tobytes())
    return path
