"""Benchmark report with all time and memory measurements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from spigolo import __version__
from spigolo.batch.engine import one_thread
from spigolo.frames.frame import Frame
from spigolo.lab.bench.contestants import CONFIGS, Comparison, compare, everybody
from spigolo.lab.bench.figures import Summary, summarise
from spigolo.lab.bench.peers import Peers, open_peers
from spigolo.lab.bench.resources import (
    Latency,
    Memory,
    Throughput,
    measure_latency,
    measure_memory,
    measure_throughput,
)
from spigolo.lab.bench.scaling import SIZES, Growth, Size, study
from spigolo.lab.bench.stages import time_stages
from spigolo.lab.bench.startup import Startup, measure_startup
from spigolo.lab.bench.timing import Sample, Tell, run_rounds, silent
from spigolo.lab.machine import Machine, this_machine
from spigolo.settings.presets import PRESETS

MAIN = "OBJECTS 4c"
"""Name of the configuration used to measure throughput and latency."""
STAGED = tuple(name for name in CONFIGS if name.endswith(f"{PRESETS[name.split()[0]].partition.connectivity}c"))
"""Names of the configurations whose time is measured by stage: the presets with their own connectivity."""


@dataclass(frozen=True, slots=True)
class Plan:
    """Numbers of repetitions in a benchmark."""

    rounds: int = 15
    """Number of timed runs of each function, and of each stage of the segmentation."""
    size_rounds: int = 5
    """Number of timed runs at each image size."""
    sizes: tuple[Size, ...] = SIZES
    """Image sizes (width, height) at which the CPU time is measured."""
    frames: int = 60
    """Number of frames per thread in each measurement of throughput."""
    repeats: int = 3
    """Number of measurements of the throughput and of the start-up time."""
    latency: int = 0
    """Number of frames in the measurement of latency. If `latency` is 0, the latency is not measured."""
    cold: bool = False
    """True to also measure the start-up time of a process that must first compile the kernels (Numba functions)."""


QUICK = Plan(rounds=3, size_rounds=2, sizes=SIZES[:2], frames=8, repeats=1)


@dataclass(frozen=True, slots=True)
class Contest:
    """Times of all timed functions on one frame."""

    frame: str
    width: int
    height: int
    comparisons: list[Comparison]
    samples: dict[str, list[Sample]]
    """Measured times, indexed by the name of the timed function."""

    @property
    def summaries(self) -> dict[str, Summary]:
        """Return the median and minimum time of each timed function."""
        return {name: summarise(taken) for name, taken in self.samples.items()}


@dataclass(frozen=True, slots=True)
class Report:
    """Results of a benchmark.

    The field `contests` holds measurements on all frames. Only the first frame is used to measure the values of all
    other fields.
    """

    machine: Machine
    plan: Plan
    peers: dict[str, dict[str, str]]
    """Versions of the modules in each Python environment, indexed by interpreter and module."""
    missing: list[str]
    """One message for each missing package, which no Python environment contains."""
    contests: list[Contest]
    growth: dict[str, Growth]
    """CPU times at several image sizes, indexed by the name of the timed function."""
    stages: dict[str, dict[str, list[Sample]]]
    """Times of each stage of the segmentation, indexed by configuration and stage."""
    memory: dict[str, Memory]
    """Memory use in bytes per pixel, indexed by configuration."""
    throughput: Throughput
    latency: Latency | None
    startup: Startup

    def to_json(self) -> dict[str, Any]:
        """Return all measurements as a dictionary for `json.dumps`.

        Each element of `contests` also has the key `summaries` with the median and minimum time of each timed function.
        """
        values = asdict(self)
        for contest, out in zip(self.contests, values["contests"], strict=True):
            out["summaries"] = {name: asdict(summary) for name, summary in contest.summaries.items()}
        return values


def bench(
    frames: Mapping[str, Frame], plan: Plan | None = None, python: Path | None = None, tell: Tell = silent
) -> Report:
    """Measure the time and memory of spigolo, and the time of other libraries, on one or more frames.

    Parameters
    ----------
    frames
        Frames to segment, indexed by name.
    plan
        Numbers of repetitions, see `Plan`.
    python
        Python interpreter of the environment with the other libraries, see `open_peers`.
    tell
        Progress callback, see `Tell`.

    """
    plan = Plan() if plan is None else plan
    machine = this_machine(spigolo=__version__)
    with one_thread(), open_peers(python) as peers:
        contests = [_contest(name, frame, plan, peers, tell) for name, frame in frames.items()]
        first = next(iter(frames.values()))
        return Report(
            machine=machine,
            plan=plan,
            peers=peers.versions,
            missing=peers.missing,
            contests=contests,
            growth=study(first, plan.sizes, plan.size_rounds, peers, tell),
            stages=time_stages(first, {name: CONFIGS[name] for name in STAGED}, plan.rounds, tell),
            memory={name: measure_memory(first, config) for name, config in CONFIGS.items()},
            throughput=measure_throughput(first, CONFIGS[MAIN], plan.frames, plan.repeats, tell),
            latency=measure_latency(first, CONFIGS[MAIN], plan.latency, tell) if plan.latency else None,
            startup=measure_startup(first, plan.repeats, plan.cold, tell),
        )


def _contest(name: str, frame: Frame, plan: Plan, peers: Peers, tell: Tell) -> Contest:
    samples = run_rounds(everybody(frame, peers, name), plan.rounds, tell, name)
    height, width = frame.shape
    return Contest(name, width, height, compare(samples), samples)
