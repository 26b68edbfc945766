"""Several methods on one frame, as the paper's last figure has them."""

from __future__ import annotations

from collections.abc import Mapping

from spigolo.frames.frame import Color, Frame
from spigolo.objects.segmentation import Segmentation
from spigolo.view.overlay import region_picture, tile


def comparison(frame: Frame, answers: Mapping[str, tuple[Segmentation, float]], ours: str) -> Color:
    """The frame, each method's regions with its objects and time, and ours with its objects highlighted.

    answers: of each method by name, its answer and its seconds. ours: the name whose objects are highlighted.
    """
    pictures = {"colour": frame.color}
    for name, (answer, seconds) in answers.items():
        objects, time = len(answer), f"{1e3 * seconds:.0f} ms" if seconds < 1 else f"{seconds:.1f} s"
        pictures[f"{name}: {objects} objects, {time}"] = region_picture(answer.regions.labels)
    result = answers[ours][0]
    pictures[f"{ours}: its {len(result)} objects"] = result.overlay()
    return tile(pictures, columns=4 if len(pictures) > 6 else 3)
