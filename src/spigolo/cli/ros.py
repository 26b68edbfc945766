"""Command `ros`, which runs the ROS 2 node."""

from __future__ import annotations

from spigolo.cli import DONE
from spigolo.cli.inputs import Inputs, configure, split_flags


def ros(
    *words: Inputs,
    color: str | None = None,
    depth: str | None = None,
    camera_info: str | None = None,
    preset: str = "OBJECTS",
) -> int:
    """Run the ROS 2 node, which segments the images of a camera topic.

    Example: `spigolo ros --color /camera/camera/color/image_raw --depth
    /camera/camera/aligned_depth_to_color/image_raw --camera-info /camera/camera/color/camera_info`.

    The node publishes ~/labels, ~/overlay, ~/markers, ~/cloud, ~/objects and ~/detections, and offers the service
    ~/segment. For each point received on ~/click, the node publishes the mask of the object at this point on ~/mask.
    Every field of the preset is a parameter of the node.

    Parameters
    ----------
    words
        Parameters of the node as flags, such as `--queue 5`, `--continuous false`, `--reliable false` or
        `--partition.gamma 0.004`. Arguments after `--ros-args` are passed to ROS.
    color
        Topic of the colour image. Default: the topic `color`, which can be remapped with ROS arguments.
    depth
        Topic of the depth image, which must be registered to colour. Default: the topic `depth`.
    camera_info
        Topic of the CameraInfo of the colour image. Default: the topic `camera_info`.
    preset
        Name of a preset, or a TOML file. Use OBJECTS for your own data, and SHELF, TABLE or CLUTTER for the paper's
        data sets.

    """
    from spigolo.ros.kinds import find_kinds
    from spigolo.ros.node import run
    from spigolo.ros.parameters import Options
    from spigolo.settings.fields import value_of_text

    at = words.index("--ros-args") if "--ros-args" in words else len(words)
    unnamed, flags = split_flags(words[:at])
    own = {name: value for name, value in flags.items() if name in Options.model_fields}
    fields = {name: value for name, value in flags.items() if name not in own}
    configure(preset, fields, ros)  # reports wrong flags before the node starts
    find_kinds()
    given = {name: value_of_text(value) for name, value in flags.items()}
    topics = {"color": color, "depth": depth, "camera_info": camera_info}
    maps = [word for name, topic in topics.items() if topic for word in ("-r", f"{name}:={topic}")]
    run({"preset": preset, **given}, [*(["--ros-args", *maps] if maps else []), *unnamed, *words[at:]])
    return DONE
