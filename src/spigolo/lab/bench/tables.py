"""Tables of a benchmark report."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from statistics import median

from spigolo.lab.bench.contestants import CONFIGS
from spigolo.lab.bench.figures import PowerLaw, summarise
from spigolo.lab.bench.report import MAIN, Contest, Report
from spigolo.lab.bench.stages import PARTS, STAGES
from spigolo.lab.page import Page, Table, cells, to_markdown

Row = tuple[str, ...]
PAIRED = "Ratios of CPU times, computed in each round. The table gives the median over the rounds."


def tables(report: Report) -> Iterator[Table]:
    """Yield all tables of a benchmark report."""
    yield machine_table(report)
    for contest in report.contests:
        yield times_table(contest)
        yield ratio_table(contest)
        yield parts_table(contest)
    if len(report.contests) > 1:
        yield overall_table(report.contests)
    if report.growth:
        yield growth_table(report)
    yield stage_table(report)
    yield memory_table(report)
    yield rest_table(report)


def machine_table(report: Report) -> Table:
    """Return the table that describes the machine, the package versions and the missing packages."""
    machine = report.machine
    rows = [
        ("processor", f"{machine.cpu}, {machine.cores} cores"),
        ("system", machine.system),
        ("load before", "unknown" if machine.load is None else f"{machine.load:.2f}"),
        ("versions", _versions(machine.versions)),
        *((f"peers in {python}", _versions(versions)) for python, versions in report.peers.items()),
    ]
    return _table("Machine", ("", ""), rows, "\n".join(report.missing), text=2)


def times_table(contest: Contest) -> Table:
    """Return the table with the CPU and wall times of every timed function, in milliseconds."""
    rows = [
        (name, _ms(s.cpu_ms), _ms(s.cpu_min_ms), _ms(s.wall_ms), _ms(s.wall_min_ms))
        for name, s in contest.summaries.items()
    ]
    header = ("ms", "CPU, median", "CPU, minimum", "wall, median", "wall, minimum")
    rounds = len(next(iter(contest.samples.values())))
    return _table(f"{_title(contest)}, one thread, {rounds} rounds", header, rows)


def ratio_table(contest: Contest) -> Table:
    """Return the table of CPU time ratios, with one row per configuration in `CONFIGS` and one column per peer.

    A peer is another method of spigolo, or a segmentation function of another library.
    """
    ratios = {(pair.ours, pair.peer): pair.ratio for pair in contest.comparisons if pair.ours in CONFIGS}
    peers = list(dict.fromkeys(peer for _, peer in ratios))
    rows = [(name, *(f"{ratios[name, peer]:.2f}" for peer in peers)) for name in CONFIGS]
    return _table(f"{_title(contest)}: time relative to ours", ("ours", *peers), rows, PAIRED)


def overall_table(contests: Sequence[Contest]) -> Table:
    """Return the table of CPU time ratios (`Comparison.ratio`): median, minimum and maximum over all frames."""
    ratios: dict[tuple[str, str], list[float]] = {}
    for pair in (pair for contest in contests for pair in contest.comparisons):
        ratios.setdefault((pair.ours, pair.peer), []).append(pair.ratio)
    rows = [(*pair, f"{median(r):.2f}", f"{min(r):.2f}", f"{max(r):.2f}") for pair, r in ratios.items()]
    header = ("ours", "theirs", "time relative to ours, median", "minimum", "maximum")
    return _table(f"All {len(contests)} frames", header, rows, "Statistics over the ratios of the frames.", text=2)


def parts_table(contest: Contest) -> Table:
    """Return the table that compares the time of single steps, such as saliency, with the time of other functions for
    the same step.
    """
    rows = [(pair.ours, pair.peer, f"{pair.ratio:.2f}") for pair in contest.comparisons if pair.ours not in CONFIGS]
    title = f"{_title(contest)}: parts"
    return _table(title, ("ours", "theirs", "time relative to ours"), rows, PAIRED, text=2)


def growth_table(report: Report) -> Table:
    """Return the table of CPU times at each image size, with the exponents of the fitted power laws."""
    sizes = [f"{width}x{height}" for width, height in report.plan.sizes]
    header = ("CPU ms", *sizes, "p of N^p", "p of (N log N)^p", "1080p : VGA")
    rows = [
        (
            name,
            *map(_ms, g.cpu_ms),
            _exponent(g.pixels, len(sizes)),
            _exponent(g.pixels_log, len(sizes)),
            "-" if g.hd_per_vga is None else f"{g.hd_per_vga:.2f}",
        )
        for name, g in report.growth.items()
    ]
    note = (
        f"{report.contests[0].frame} rescaled. After ±: root mean square distance of the times from the fit."
        " Last column: time per pixel at 1920x1080 relative to 640x480."
    )
    return _table("Time against number of pixels", header, rows, note)


def stage_table(report: Report) -> Table:
    """Return the table of median CPU times of each stage, in milliseconds."""
    names = list(report.stages)
    rows = []
    for stage in (s for whole in STAGES for s in (whole, *(part for part, of in PARTS.items() if of == whole))):
        taken = [report.stages[name].get(stage) for name in names]
        label = f"  of these: {stage.removeprefix(f'{PARTS[stage]}: ')}" if stage in PARTS else stage
        rows.append((label, *("-" if t is None else _ms(summarise(t).cpu_ms) for t in taken)))
    sums = [sum(summarise(t).cpu_ms for stage, t in report.stages[name].items() if stage in STAGES) for name in names]
    return _table("Time by stage", ("CPU ms, median", *names), [*rows, ("sum of stages", *map(_ms, sums))])


def memory_table(report: Report) -> Table:
    """Return the table of memory use, in bytes per pixel."""
    rows = []
    for name in CONFIGS:
        m = report.memory[name]
        figures = (m.workspace, m.frame, m.answer, m.workspace + m.frame - m.answer)
        rows.append((name, *(f"{figure:.0f}" for figure in figures)))
    header = (
        "bytes per pixel",
        "workspace, kept",
        "peak per frame, added",
        "result, part of the peak",
        "sum without result",
    )
    return _table("Memory", header, rows, "Temporary arrays inside OpenCV functions are not counted.")


def rest_table(report: Report) -> Table:
    """Return the table of throughput, latency and start-up time."""
    t, s = report.throughput, report.startup
    rows = [
        ("one thread", f"{median(t.one_thread):.1f} frames/s"),
        ("two threads, one Segmenter each", f"{median(t.two_threads):.1f} frames/s, {t.ratio:.2f} times one thread"),
    ]
    if report.latency is not None:
        la = report.latency
        figures = f"median {la.median_ms:.1f} ms, 99 % within {la.p99_ms:.1f} ms, worst {la.worst_ms:.1f} ms"
        rows.append((f"{la.frames} frames in a row", figures))
    rows.append(("new process until its first labels", f"{s.warm_s:.2f} s, of which {s.opencv_s:.2f} s import cv2"))
    if s.cold_s is not None:
        rows.append(("the same, without compiled kernels", f"{s.cold_s:.1f} s"))
    return _table(f"Throughput, latency, start-up ({MAIN})", ("wall time", ""), rows, text=2)


def markdown(report: Report) -> str:
    """Format a benchmark report as Markdown."""
    return to_markdown(Page("Benchmark", list(tables(report))))


def _table(title: str, head: Row, rows: Sequence[Row], note: str = "", text: int = 1) -> Table:
    return Table(head, cells(rows), text, title, note)


def _title(contest: Contest) -> str:
    return f"{contest.frame} {contest.width}x{contest.height}"


def _versions(versions: dict[str, str]) -> str:
    return ", ".join(f"{name} {version}" for name, version in versions.items())


def _ms(value: float) -> str:
    return f"{value:.0f}" if value >= 1000 else f"{value:.1f}"


def _exponent(law: PowerLaw | None, sizes: int) -> str:
    """Format the exponent of a fitted power law with the residual of the fit.

    A power law fitted to only two image sizes always has a residual of 0, so the residual is left out.
    """
    if law is None:
        return "-"
    return f"{law.exponent:.3f} ± {law.residual:.1%}" if sizes > 2 else f"{law.exponent:.3f}"
