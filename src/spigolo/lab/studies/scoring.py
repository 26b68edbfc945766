"""Compare the time to score a frame with the time to segment it.

Run `python -m spigolo.lab.studies.scoring FRAMES --presets TABLE`.

Times are CPU times with one thread. Each frame is segmented and scored several times. The first repetition is a warm-up
that is not timed.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import cv2
import numpy as np

import spigolo as sp
from spigolo.lab.datasets import Truth, find_labelled_frames
from spigolo.lab.evaluation import score_row


def main() -> None:
    parser = argparse.ArgumentParser(description="Compare the times to score and to segment a frame.")
    parser.add_argument("frames", type=Path, nargs="+", help="folders of labelled frames, in any supported file layout")
    parser.add_argument("--presets", nargs="+", default=["OBJECTS", "SHELF", "TABLE", "CLUTTER"])
    parser.add_argument("--rounds", type=int, default=3)
    arguments = parser.parse_args()
    cv2.setNumThreads(1)
    read = [e.read_both() for e in find_labelled_frames(arguments.frames) if e.labelling != "none"]
    print("| preset | frames | segmenting | scoring | median ratio | ratio below 0.2 |\n|---|---|---|---|---|---|")
    for name in arguments.presets:
        segmenter = sp.Segmenter(sp.preset(name))
        took = np.array([times(segmenter, *one, arguments.rounds) for one in read])  # shape (frames, rounds, 2)
        segmenting, scoring = 1e3 * np.median(took, axis=(0, 1))
        ratios = np.median(took[..., 1] / took[..., 0], axis=1)
        ratio = f"{np.median(ratios):.2f} | {np.mean(ratios < 0.2):.0%} of the frames"
        print(f"| {name} | {len(took)} | {segmenting:.1f} ms | {scoring:.1f} ms | {ratio} |", flush=True)


def times(segmenter: sp.Segmenter, frame: sp.Frame, truth: Truth | None, rounds: int) -> list[tuple[float, float]]:
    """Return the CPU times of segmentation and of scoring in seconds, one pair of times per repetition."""
    assert truth is not None
    answer = []
    for _ in range(rounds + 1):
        begin = time.process_time()
        result = segmenter(frame)
        done = time.process_time()
        score_row(truth.labels, result.labels, result.regions.labels + 1, truth.ignore, truth.names)
        answer.append((done - begin, time.process_time() - done))
    return answer[1:]


if __name__ == "__main__":
    main()
