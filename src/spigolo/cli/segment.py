"""Commands `segment`, `trace` and `doctor`, which process frames of the user."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

from spigolo.cli import DONE, SOME_FAILED
from spigolo.cli.inputs import Frames, Index, Inputs, Out, configure, split_flags
from spigolo.cli.opening import first_frame, opened
from spigolo.cli.region import NO_REGION, RegionFlags
from spigolo.errors import SpigoloError
from spigolo.frames.frame import MAX_PIXELS
from spigolo.sources.base import counted

if TYPE_CHECKING:
    from spigolo.frames.frame import Frame
    from spigolo.frames.roi import Roi
    from spigolo.objects.segmentation import Segmentation
    from spigolo.settings.config import Config
    from spigolo.sources.base import Source
    from spigolo.stream import Segmenter


def segment(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    check: bool = True,
    max_pixels: int = MAX_PIXELS,
    ids: bool = False,
    frames: Frames = None,
    out: Out = Path("spigolo-out"),
) -> int:
    """Segment frames and write labels.png, objects.json and overlay.png for each frame.

    labels.png has 16 bits. Read labels.png with cv2.IMREAD_UNCHANGED. Without IMREAD_UNCHANGED, OpenCV converts
    labels.png from 16 bits to 8 bits, and all labels below 256 become 0.

    Examples: `spigolo segment rgb.png depth.png --camera camera.json`, or `spigolo segment recordings/ --camera
    kinect-v1 --preset TABLE --partition.gamma 0.004`.

    Parameters
    ----------
    inputs
        A colour image and a depth image of the same size, several such pairs, or folders. A folder contains one frame
        (rgb.png and depth.png), or a subfolder with these two images for each frame. A folder can also contain the
        folders rgb/ and depth/, in which the two images of a frame have the same file name. A ROS bag (.bag, .db3,
        .mcap), a camera (realsense:) or a data set (dataset:FOLDER) is accepted too. Each field of the preset can also
        be set with a flag, such as `--partition.gamma 0.004`. `spigolo presets OBJECTS` lists the fields.
    camera
        Intrinsics of the camera. Give a file, four numbers fx,fy,cx,cy such as 927.2,927.4,651.3,349.6, a camera name
        such as kinect-v1, or a guess of the horizontal field of view such as 60deg. Supported files are JSON, YAML, a
        3x3 matrix in a .txt, .npy or .mat file, and COLMAP's cameras.txt. Default: camera.json next to the images or in
        a folder above them. Without intrinsics, results in metres are left out.
    preset
        Name of a preset, or a TOML file. Use OBJECTS for your own data, and SHELF, TABLE or CLUTTER for the paper's
        data sets.
    depth_scale
        Metres per unit of the depth image: 0.001 for millimetres. Default: the depth scale in the camera file.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    check
        Print the warnings of `spigolo doctor` for each frame.
    max_pixels
        Maximum number of pixels of an image. A larger limit requires more memory, about 100 bytes for each pixel.
    ids
        Give each object an id. An object keeps its id from frame to frame, even if the object is missing in up to 15
        consecutive frames.
    frames
        Number of frames after which the program stops, for cameras and recordings. Default: all frames.
    out
        Output folder. With several frames, the results of each frame are in a subfolder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, segment)
    wanted = region.read(max_pixels)
    with opened(words, camera, depth_scale, max_pixels, quiet=check) as source:
        from spigolo.stream import Segmenter

        run = Segmenter(config, ids=ids)
        return (_one if source.count == 1 else _many)(source, run, wanted, check, frames, out)


def _one(source: Source, run: Segmenter, wanted: Roi | None, check: bool, _: int | None, out: Path) -> int:
    """Segment the only frame of a source and write its results."""
    frame = first_frame(source)
    result = _segmented(frame, run, wanted, check, out)
    from spigolo.cli import show

    if source.intrinsics:
        print(f"intrinsics: {source.intrinsics}")
    show.print_result(result, out)
    if frame.undistorted:
        print(f"the camera has distortion: the labels belong to {out / 'undistorted.png'}, not to the input image")
    return DONE


def _many(source: Source, run: Segmenter, wanted: Roi | None, check: bool, limit: int | None, out: Path) -> int:
    """Segment all frames of a source and write their results. A frame that fails does not stop the run."""
    from spigolo.cli import show

    source.on_broken = _print_error
    failed = without = bent = done = 0
    for frame in show.progress(source, "segmenting"):
        try:
            result = _segmented(frame, run, wanted, check, out / frame.name)
            without += frame.camera is None
            bent += frame.undistorted
            done += 1
            print(f"{frame.name}: {counted(len(result), 'object')}")
        except SpigoloError as error:
            failed += 1
            _print_error(frame.name, error)
        if limit is not None and done + failed >= limit:
            break
    report = source.report()
    failed += report.broken
    show.print_without_intrinsics(without, done)
    if bent:
        told = f"{counted(bent, 'frame')} with lens distortion"
        print(f"{told}: the labels belong to undistorted.png, not to the input image")
    total = done + failed if source.count is None or report.tolerance_ms is not None else source.count
    if report.tolerance_ms is not None or report.pace is not None:
        print(f"{source.name}: {report}")
    print(f"segmenting: {run.pace}")
    print(f"{done} of {counted(total, 'frame')} written to {out} ({run.config.name} {run.config.digest})")
    return SOME_FAILED if failed else DONE


def _segmented(frame: Frame, run: Segmenter, wanted: Roi | None, check: bool, out: Path) -> Segmentation:
    """Check and segment a frame, and write the results."""
    from spigolo.cli import show

    _check(frame, run.config, check)
    with show.warnings_of(frame.name):
        result = run(frame, wanted)
    show.write_result(result, frame, out)
    return result


def _print_error(name: str, error: SpigoloError) -> None:
    print(f"spigolo: {name}: {error}", file=sys.stderr)


def trace(
    *inputs: Inputs,
    camera: str | None = None,
    preset: str = "OBJECTS",
    depth_scale: float | None = None,
    region: RegionFlags = NO_REGION,
    stages: bool = False,
    max_pixels: int = MAX_PIXELS,
    index: Index = None,
    out: Out = Path("spigolo-trace"),
) -> int:
    """Draw the result of each stage for a frame in trace.png: the seven panels of the paper's Figure 1.

    Example: `spigolo trace rgb.png depth.png --camera camera.json --stages`.

    Parameters
    ----------
    inputs
        Source of the frame: a colour and a depth image, a folder with rgb.png and depth.png, a recording or a camera,
        in the forms that `spigolo segment` accepts. Each field of the preset can also be set with a flag, such as
        `--partition.gamma 0.004`.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    preset
        Preset for the segmentation: the name of a preset, such as OBJECTS, or a TOML file.
    depth_scale
        Metres per unit of the depth image. Default: the depth scale in the camera file.
    region
        Region of interest: --roi, --roi-mask or --roi-box.
    stages
        Also write the output array of each stage to stages/NAME.npy.
    max_pixels
        Maximum number of pixels of an image. Larger images are rejected, to limit memory.
    index
        Number of the frame in a folder, recording or data set. The first frame has the number 0. Default: the first
        frame.
    out
        Output folder.

    """
    words, flags = split_flags(inputs)
    config = configure(preset, flags, trace)
    with opened(words, camera, depth_scale, max_pixels) as source:
        frame = first_frame(source, index)
    from spigolo import pipeline
    from spigolo.cli import show
    from spigolo.frames import files as io
    from spigolo.view import figure1

    run = pipeline.trace(frame, config, region.read(max_pixels))
    io.write_png(out / "trace.png", figure1.figure1(run))
    if stages:
        for name, array in figure1.stages(run).items():
            show.write_array(out / "stages" / f"{name}.npy", array)
            print(f"  {name:18s} {array.dtype!s:8s} {array.shape}")
    print(f"written: {out / 'trace.png'}{f' and {out}/stages' if stages else ''} ({config.name} {config.digest})")
    return DONE


def doctor(
    *inputs: str,
    camera: str | None = None,
    depth_scale: float | None = None,
    max_pixels: int = MAX_PIXELS,
    index: Index = None,
) -> int:
    """Check a frame: units, alignment, intrinsics, missing depth, and the choice of the cost function.

    The exit code is 1 if a check gives a warning. Example: `spigolo doctor rgb.png depth.png --camera camera.json`.

    Parameters
    ----------
    inputs
        Source of the frame: a colour and a depth image, a folder with rgb.png and depth.png, a recording or a camera,
        in the forms that `spigolo segment` accepts.
    camera
        Intrinsics of the camera, in any form that `spigolo segment` accepts.
    depth_scale
        Metres per unit of the depth image: 0.001 for millimetres. Default: the depth scale in the camera file.
    max_pixels
        Maximum number of pixels of an image. Larger images are rejected, to limit memory.
    index
        Number of the frame in a folder, recording or data set. The first frame has the number 0. Default: the first
        frame.

    """
    with opened(inputs, camera, depth_scale, max_pixels, quiet=True) as source:
        frame = first_frame(source, index)
    from spigolo.cli import show
    from spigolo.doctor import diagnose

    diagnosis = diagnose(frame)
    show.print_diagnosis(diagnosis)
    return SOME_FAILED if diagnosis.warnings else DONE


def _check(frame: Frame, config: Config, wanted: bool) -> None:
    if wanted:
        from spigolo.cli import show
        from spigolo.doctor import diagnose

        show.warn_of(diagnose(frame), frame.name, config)
