"""Count how often an object changes its id while a rendered camera moves: `python -m spigolo.lab.studies.tracking`.

A camera moves around each table of the family `table` like a hand-held one, at 20 degrees per second and 30 frames per
second. Ground truth is exact. A true object is found in a frame if one mask has an IoU of at least 0.5 with it, one to
one. Its id changes if that mask has another id than the mask that found the object before. Such a change is the
identity switch of MOT metrics. The share is relative to the finds that had an earlier find. Every third or sixth frame
simulates a lower frame rate. `labels` uses the labels of each frame, sorted by score, as ids.
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
"""Turn of the camera around the table per frame, degrees."""
SWEEP_DEG = 12.0
"""Turn at which the camera reverses, degrees."""


@dataclass(frozen=True)
class Count:
    """Finds of true objects over a sequence, and changes of their ids."""

    objects: int
    """Number of true objects that were found at least once."""
    present: int
    """Number of true objects, summed over frames."""
    found: int
    """Number of true objects that were found, summed over frames."""
    again: int
    """Number of finds whose object had been found before."""
    switches: int
    """Number of finds whose id differs from that of the last find."""
    ids: int
    """Number of different ids of true objects."""

    @property
    def share(self) -> float:
        """Return the share of finds at which the id changed."""
        return self.switches / max(self.again, 1)


def sequence(scene: str, count: int, seed: int = 0) -> Iterator[Sample]:
    """Yield the frames of a camera that moves around a table, and their ground truth."""
    rng = np.random.default_rng([seed, list(TABLES).index(scene)])
    stage = table_stage(scene, rng)
    quick = replace(stage.lighting, lamp_samples=6, sky_samples=10)
    sway = np.zeros(4)
    for k in range(count):
        sway = 0.9 * sway + rng.normal(0, (0.002, 0.002, 0.003, 0.15))
        view = _carried(stage.view, k, sway)
        yield record(replace(stage, view=view, lighting=quick), f"{scene}_{k:03d}", rng).sample


def _carried(view: View, k: int, sway: npt.NDArray[np.float64]) -> View:
    """Return a view after k frames: swept back and forth, with sway in x, y, distance (m) and pitch (degrees)."""
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
    """Return the masks that find true objects, indexed by the object's name."""
    found = {}
    for instance in sample.instances:
        truth = sample.labels == instance.label
        ious = {o.label: np.sum(o.mask & truth) / np.sum(o.mask | truth) for o in result}
        best = max(ious, key=lambda label: ious[label], default=None)
        if best is not None and ious[best] >= FOUND_IOU:  # above 0.5 only one true object can match
            found[instance.model] = result[[o.label for o in result].index(best)]
    return found


def count(samples: Sequence[Sample], results: Sequence[sp.Segmentation], by_label: bool = False) -> Count:
    """Count the finds and the changes of ids. by_label: use the label of each frame's mask as id."""
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
    """Return the results with ids, and the median time of the tracker, ms."""
    tracker, followed, took_ms = Tracker(), [], []
    for result in results:
        start = time.perf_counter()
        followed.append(tracker.follow(result))
        took_ms.append(1000 * (time.perf_counter() - start))
    return followed, float(np.median(took_ms))


def report(scene: str, samples: Sequence[Sample]) -> Iterator[str]:
    """Yield the rows of a scene at 30, 10 and 5 frames per second."""
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
    parser.add_argument("--frames", type=int, default=30, help="frames of each scene")
    parser.add_argument("--seed", type=int, default=0)
    own = parser.parse_args()
    print("| scene | frames/s | frames | objects | found | id changes | of labels | tracker, ms |")
    print("|---|---|---|---|---|---|---|---|")
    for scene in TABLES:
        for row in report(scene, list(sequence(scene, own.frames, own.seed))):
            print(row, flush=True)


if __name__ == "__main__":
    main()
