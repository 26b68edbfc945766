"""Count identity switches of tracked objects in rendered sequences: `python -m spigolo.lab.studies.tracking`.

In each scene of the family `table`, a simulated hand-held camera moves around the table. The camera moves by 0.7
degrees per frame, at 30 frames per second. To simulate 10 or 5 frames per second, only every third or every sixth frame
is used.

A ground-truth object is found in a frame if a predicted mask has an IoU of at least 0.5 with the object. An identity
switch occurs if the id of an object has changed since the last frame in which the object was found. The share of
identity switches is the number of switches divided by the number of times that an object was found again. For
comparison, the printed column `label changes` counts the switches if the labels of each frame are used as ids. Labels
are numbered in the order of scores, best score first.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

import spigolo as sp
from spigolo.lab.datasets.sample import Sample
from spigolo.lab.synthetic.scene import View
from spigolo.lab.synthetic.staging import record
from spigolo.lab.synthetic.tables import TABLES, table_stage
from spigolo.objects.tracking import Tracker

FOUND_IOU = 0.5
TURN_DEG = 0.7
"""Rotation of the camera around the table per frame, in degrees."""
SWEEP_DEG = 12.0
"""Maximum rotation of the camera to each side, in degrees. At the maximum, the camera starts to move back."""


@dataclass(frozen=True)
class Count:
    """Numbers of found objects and identity switches in a sequence."""

    objects: int
    """Number of ground-truth objects that were found at least once."""
    present: int
    """Number of ground-truth objects in a frame, summed over all frames."""
    found: int
    """Number of ground-truth objects that were found in a frame, summed over all frames."""
    again: int
    """Number of times that an object was found again, after it had been found in an earlier frame."""
    switches: int
    """Number of identity switches: the id of an object has changed since the last frame in which the object was found.
    """
    ids: int
    """Number of different ids that were assigned to ground-truth objects."""

    @property
    def share(self) -> float:
        """Return the number of identity switches, divided by the number of times that an object was found again."""
        return self.switches / max(self.again, 1)


def sequence(scene: str, count: int, seed: int = 0) -> Iterator[Sample]:
    """Render frames of a camera that moves around a table. Yield the frames with ground truth."""
    rng = np.random.default_rng([seed, list(TABLES).index(scene)])
    stage = table_stage(scene, rng)
    quick = replace(stage.lighting, lamp_samples=6, sky_samples=10)
    sway = np.zeros(4)
    for k in range(count):
        sway = 0.9 * sway + rng.normal(0, (0.002, 0.002, 0.003, 0.15))
        view = _carried(stage.view, k, sway)
        yield record(replace(stage, view=view, lighting=quick), f"{scene}_{k:03d}", rng).sample


def _carried(view: View, k: int, sway: npt.NDArray[np.float64]) -> View:
    """Return the camera view in frame k of the motion around the table.

    sway: random displacement of a hand-held camera in x, y and distance (metres), and in pitch (degrees).
    """
    turn = (k * TURN_DEG) % (4 * SWEEP_DEG)
    swept = turn if turn <= SWEEP_DEG else 2 * SWEEP_DEG - turn if turn <= 3 * SWEEP_DEG else turn - 4 * SWEEP_DEG
    x_m, y_m, z_m = view.look_at_m
    return replace(
        view,
        look_at_m=(x_m + sway[0], y_m + sway[1], z_m),
        distance_m=view.distance_m + sway[2],
        pitch_deg=view.pitch_deg + sway[3],
        yaw_deg=view.yaw_deg + swept,
    )


def finds(sample: Sample, result: sp.Segmentation) -> Mapping[str, sp.ObjectMask]:
    """Return the predicted masks that match ground-truth objects, indexed by the name of the ground-truth object."""
    found = {}
    for instance in sample.instances:
        truth = sample.labels == instance.label
        ious = {o.label: np.sum(o.mask & truth) / np.sum(o.mask | truth) for o in result}
        best = max(ious, key=lambda label: ious[label], default=None)
        if best is not None and ious[best] >= FOUND_IOU:  # only one true object can have an IoU above 0.5
            found[instance.model] = result[[o.label for o in result].index(best)]
    return found


def count(samples: Sequence[Sample], results: Sequence[sp.Segmentation], by_label: bool = False) -> Count:
    """Count found objects and identity switches in a sequence. by_label: True to use the label of each mask instead of
    its id.
    """
    last: dict[str, int] = {}
    present = found = again = switches = 0
    ids: set[int] = set()
    for sample, result in zip(samples, results, strict=True):
        present += len(sample.instances)
        for name, mask in finds(sample, result).items():
            one = mask.label if by_label else mask.id
            assert one is not None
            found += 1
            again += name in last
            switches += last.get(name, one) != one
            last[name] = one
            ids.add(one)
    return Count(len(last), present, found, again, switches, len(ids))


def follow(results: Sequence[sp.Segmentation]) -> tuple[list[sp.Segmentation], float]:
    """Track objects through a sequence of segmentations.

    Return the segmentations with ids, and the median tracking time per frame, in milliseconds.
    """
    tracker, followed, took_ms = Tracker(), [], []
    for result in results:
        start = time.perf_counter()
        followed.append(tracker.follow(result))
        took_ms.append(1000 * (time.perf_counter() - start))
    return followed, float(np.median(took_ms))


def report(scene: str, samples: Sequence[Sample]) -> Iterator[str]:
    """Yield the rows of the printed table for one scene: at 30, 10 and 5 frames per second."""
    results = [sp.segment(sample.frame) for sample in samples]
    for rate, step in ((30, 1), (10, 3), (5, 6)):
        followed, took_ms = follow(results[::step])
        own, plain = count(samples[::step], followed), count(samples[::step], results[::step], by_label=True)
        yield (
            f"| {scene} | {rate} | {len(followed)} | {own.objects} | {own.found} of {own.present} | {own.switches}"
            f" ({own.share:.1%}) | {plain.switches} ({plain.share:.1%}) | {took_ms:.1f} |"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=30, help="number of frames per scene")
    parser.add_argument("--seed", type=int, default=0)
    own = parser.parse_args()
    print("| scene | frames/s | frames | objects | found | id changes | label changes | tracker, ms |")
    print("|---|---|---|---|---|---|---|---|")
    for scene in TABLES:
        for row in report(scene, list(sequence(scene, own.frames, own.seed))):
            print(row, flush=True)


if __name__ == "__main__":
    main()
