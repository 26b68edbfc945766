"""Image that compares several segmentation methods on one frame, as in the paper's Figure 6."""

from __future__ import annotations

from collections.abc import Mapping

from spigolo.frames.frame import Color, Frame
from spigolo.objects.segmentation import Segmentation
from spigolo.view.overlay import region_picture, tile


def comparison(frame: Frame, answers: Mapping[str, tuple[Segmentation, float]], ours: str) -> Color:
    """Draw three kinds of images side by side: the colour image, the regions of each method, and the objects of one
    method. Titles state the number of objects and the time of each method.

    - answers: segmentation result and time in seconds of each method, indexed by method name.
    - ours: name of the method whose objects are drawn.
    """
    pictures = {"colour": frame.color}
    for name, (answer, seconds) in answers.items():
        objects, time = len(answer), f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"
        pictures[f"{name}: {objects} objects, {time}"] = region_picture(answer.regions.labels)
    result = answers[ours][0]
    pictures[f"objects of {ours}: {len(result)}"] = result.overlay()
    return tile(pictures, columns=4 if len(pictures) > 6 else 3)
