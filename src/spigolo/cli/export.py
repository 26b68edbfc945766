"""Command `export`, which writes results in formats of other programs, and command `view`, which writes a recording for
Rerun.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from spigolo.cli import DONE, SOME_FAILED
from spigolo.cli.inputs import Distance_m, Frames, Inputs, Out, configure, split_flags
from spigolo.cli.opening import opened
from spigolo.cli.region import NO_REGION, RegionFlags
from spigolo.errors import ConfigError, FileError, SpigoloError
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.base import SizedSource, counted

if TYPE_CHECKING:
    from spigolo.frames.roi import Roi
    from spigolo.objects.segmentation import Segmentation
    from spigolo.sources.base import Source
    from spigolo.stream import Segmenter

Format = Literal["coco", "bop", "yolo", "labels", "contact-graspnet", "workspace-mask", "ply", "pcd"]
SUFFIX = {"yolo": ".txt", "labels": ".png", "contact-graspnet": ".npz", "workspace-mask": ".png"}
"""File suffix of each format that writes one file for each frame. Formats without an entry write a folder for each
frame, or one file for all frames.
"""
WHOLE = ("coco", "bop")
"""Formats that write one file for all frames."""
CLOUDS = ("ply", "pcd")
"""Formats that write a point cloud for each object."""
DRAWN = ("coco", "bop", "yolo", "labels", "workspace-mask")
"""Formats that refer to pixels of an image that is not part of the output."""
Writer = Callable[..., Any]


def export(
    *inputs: Inputs,
    format: Format,
    out: Out,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    max_pixels: int = MAX_PIXELS,
    frames: Frames = None,
    trim_m: Distance_m = None,
) -> int:
    """Segment frames and write the objects in a format that other programs read.

    Examples: `spigolo export recordings/ --format coco --out instances.json`, or `spigolo export rgb.png depth.png
    --camera camera.json --format contact-graspnet --out scene.npz`.

    Parameters
    ----------
    inputs
        Source of the frames: images, folders, a recording, a data set or a camera, in the forms that `spigolo segment`
        accepts. Each field of the preset can also be set with a flag, such as `--partition.gamma 0.004`.
    format
        File format. The formats `coco` and `bop` write one JSON file for all frames. For each frame, `yolo` writes a
        text file, `labels` writes a 16-bit PNG, and `workspace-mask` writes a 1-bit PNG. The format `contact-graspnet`
        writes an .npz file with depth, K, rgb and segmap for each frame. The formats `ply` and `pcd` write a point
        cloud for each object.
    out
        File or folder to write. For `coco` and `bop`, give the JSON file. For `ply` and `pcd`, give a folder. With
        several frames, the clouds of each frame are in a subfolder. For other formats, give a folder. For a single
        frame, a file name with suffix is accepted, too.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    preset
        Preset for the segmentation: the name of a preset, such as OBJECTS, or a TOML file.
    depth_scale
        Metres per unit of the depth image. Default: the value that the source gives.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    max_pixels
        Maximum number of pixels of an image. Larger images are rejected, to limit memory.
    frames
        Number of frames after which the program stops. Default: all frames.
    trim_m
        For `ply` and `pcd`: maximum distance, in metres, of a point from the oriented box of its object. Points farther
        from the box count as flying pixels and are left out. Default: all measured points are written.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, export)
    write = _writer(format, trim_m)
    with opened(words, camera, depth_scale, max_pixels) as source:
        from spigolo.stream import Segmenter

        suffix = ".json" if format in WHOLE else SUFFIX.get(format, "")
        target = _Target(out, source, suffix, format in WHOLE, alone=1 in (source.count, frames))
        pictures = (out.parent if target.single else out) / "undistorted" if format in DRAWN else None
        results = _Results(source, Segmenter(config), region.read(max_pixels), frames, pictures)
        if format in WHOLE:
            write(results, target.path(""))
        else:
            _write_each(results, write, target)
    print(f"{source.name}: {source.report()}")
    if results.undistorted:
        bent = counted(results.undistorted, "frame")
        print(f"{bent} with lens distortion: the results belong to the images in {pictures}, not to the input images")
    written = f"{counted(results.objects, 'object')} of {counted(results.done, 'frame')} written to {out}"
    print(f"{written} ({config.name} {config.digest})")
    return SOME_FAILED if results.failed or source.report().broken else DONE


def view(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    max_pixels: int = MAX_PIXELS,
    frames: Frames = None,
    show: bool = False,
    out: Out = Path("spigolo.rrd"),
) -> int:
    """Write a recording for the Rerun viewer, with colour, depth, and the masks, point clouds and boxes of objects over
    time.

    Open the recording with `rerun spigolo.rrd`. Example: `spigolo view recording.mcap --out recording.rrd`.

    Parameters
    ----------
    inputs
        Source of the frames: images, folders, a recording, a data set or a camera, in the forms that `spigolo segment`
        accepts. Each field of the preset can also be set with a flag, such as `--partition.gamma 0.004`.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    preset
        Preset for the segmentation: the name of a preset, such as OBJECTS, or a TOML file.
    depth_scale
        Metres per unit of the depth image. Default: the value that the source gives.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    max_pixels
        Maximum number of pixels of an image. Larger images are rejected, to limit memory.
    frames
        Number of frames after which the program stops. Default: all frames.
    show
        Open the Rerun viewer and send the frames to the viewer, instead of writing a file.
    out
        Recording file (.rrd) to write.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, view)
    from spigolo.view.rerun import Recording

    with opened(words, camera, depth_scale, max_pixels) as source, Recording(source.name, None if show else out) as log:
        from spigolo.stream import Segmenter

        results = _Results(source, Segmenter(config, ids=True), region.read(max_pixels), frames)
        for result in results:
            log.add(result)
    print(f"{source.name}: {source.report()}")
    written = "sent to the viewer" if show else f"written to {out}: open it with `rerun {out}`"
    print(f"{counted(results.done, 'frame')} {written}")
    return SOME_FAILED if results.failed or source.report().broken else DONE


class _Results:
    """Iterator over the segmented frames of a source, which counts frames, objects and failures.

    pictures: folder to which the colour images of frames with lens distortion are written, or None. Raises FileError
    after the last frame if no frame could be segmented.
    """

    def __init__(
        self, source: Source, segmenter: Segmenter, roi: Roi | None, limit: int | None, pictures: Path | None = None
    ) -> None:
        self.source, self.segmenter, self.roi, self.limit, self.pictures = source, segmenter, roi, limit, pictures
        self.done = self.objects = self.failed = self.undistorted = 0
        source.on_broken = _print_error

    def __iter__(self) -> Iterator[Segmentation]:
        from spigolo.cli import show
        from spigolo.doctor import diagnose

        for frame in show.progress(self.source, "segmenting"):
            if not self.done + self.failed:
                show.warn_of(diagnose(frame), frame.name, self.segmenter.config)
            try:
                with show.warnings_of(frame.name):
                    result = self.segmenter(frame, self.roi)
            except SpigoloError as error:
                self.failed += 1
                _print_error(frame.name, error)
                continue
            if self.pictures is not None and frame.undistorted:
                from spigolo.frames.files import write_png

                write_png(self.pictures / f"{frame.name}.png", frame.color)
                self.undistorted += 1
            self.done += 1
            self.objects += len(result)
            yield result
            if self.limit is not None and self.done >= self.limit:
                break
        if not self.done:
            raise FileError(f"no frame of {self.source.name} could be segmented")


class _Target:
    """Files to write: `out` itself, or a file or folder for each frame in the folder `out`.

    - suffix: suffix of the files. The text is empty if the format writes a folder for each frame.
    - whole: True if one file for all frames is written.
    - alone: True for a single frame. Its file is `out` itself, unless `out` is a folder or a name without suffix.

    Raises ConfigError for a file name where a folder is needed, for a folder where a file name is needed, and for
    another suffix than that of the format.
    """

    def __init__(self, out: Path, source: Source, suffix: str, whole: bool, alone: bool) -> None:
        is_file = bool(suffix and out.suffix) and not out.is_dir()
        if (whole or (alone and is_file)) and (out.is_dir() or out.suffix.lower() not in ("", suffix)):
            raise ConfigError(f"expected a file name that ends in {suffix} as --out, got {out}")
        if not whole and not alone and is_file and out.suffix.lower() == suffix:
            raise ConfigError(f"expected a folder as --out for several frames, got the file name {out}")
        self.out, self.suffix, self.single = out, suffix, whole or (alone and (is_file or not suffix))
        sized = source if isinstance(source, SizedSource) else None
        frames = [] if sized is None else [sized.files_of(k) for k in range(len(sized))]
        self._inputs = {os.path.abspath(path) for files in frames for path in files}

    def path(self, name: str) -> Path:
        """Return the path for a frame. Raises FileError if the path is one of the input files."""
        path = self.out if self.single else self.out / f"{name}{self.suffix}"
        if os.path.abspath(path) in self._inputs:
            raise FileError(f"expected an output file, but {path} is an input file: give another --out")
        return path


def _write_each(results: _Results, write: Writer, target: _Target) -> None:
    """Write a file or a folder for each frame.

    If one of several frames cannot be written, the error is printed and the next frame is processed.
    """
    for result in results:
        try:
            write(result, target.path(result.frame.name))
        except SpigoloError as error:
            if target.single:
                raise
            results.failed += 1
            results.done -= 1
            _print_error(result.frame.name, error)


def _writer(format: Format, trim_m: float | None) -> Writer:
    from spigolo import export as room

    found: Writer = getattr(room, format.replace("-", "_"))
    if trim_m is None:
        return found
    if format not in CLOUDS:
        raise ConfigError(f"--trim-m is for the formats {' and '.join(CLOUDS)}, got {format}")
    return partial(found, trim_m=trim_m)


def _print_error(name: str, error: SpigoloError) -> None:
    print(f"spigolo: {name}: {error}", file=sys.stderr)
