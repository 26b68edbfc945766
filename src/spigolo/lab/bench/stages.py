"""Times of each stage of the segmentation, measured with `spigolo.clock.stopwatch`."""

from __future__ import annotations

from collections.abc import Mapping

from spigolo.clock import Times, stopwatch
from spigolo.frames.frame import Frame
from spigolo.lab.bench.timing import LEAST_MS, Sample, Tell, silent
from spigolo.settings.config import Config
from spigolo.stream import Segmenter

STAGES = (
    "support plane", "depth", "edges", "contours", "cues", "colour", "weights", "partition", "merging", "joining",
    "scene", "objects", "flat objects", "outlines",
)  # fmt: skip
"""Names of the stages of `pipeline.trace`, in the order in which they run. An addition that is switched off takes about
0 ms.
"""
PARTS = {"depth: in-painting": "depth", "depth: smoothing": "depth", "saliency": "cues"}
"""Steps of a stage that are also timed separately. The dictionary maps the name of each step to the name of the stage
that contains the step.
"""


def time_stages(
    frame: Frame, configs: Mapping[str, Config], rounds: int, tell: Tell = silent
) -> dict[str, dict[str, list[Sample]]]:
    """Measure the time of each stage of the segmentation `rounds` times, after one warm-up run.

    Return the measured times, indexed by the name of the configuration and the name of the stage.
    """
    segmenters = {name: Segmenter(config) for name, config in configs.items()}
    samples: dict[str, dict[str, list[Sample]]] = {name: {} for name in configs}
    for k in range(rounds + 1):
        for place, (name, segmenter) in enumerate(segmenters.items()):
            tell(f"stages: {name}", (k * len(configs) + place) / ((rounds + 1) * len(configs)))
            with stopwatch() as times:
                segmenter(frame)
            if k > 0:
                _add(samples[name], times)
    return samples


def _add(samples: dict[str, list[Sample]], times: Times) -> None:
    for stage, laps in times.items():
        cpu_ms, wall_ms = (1e3 * sum(part) for part in zip(*laps, strict=True))
        samples.setdefault(stage, []).append(Sample(max(cpu_ms, LEAST_MS), max(wall_ms, LEAST_MS)))
