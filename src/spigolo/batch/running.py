"""Segmentation of many frames in a run that can be continued after an interruption."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast

from spigolo import __version__
from spigolo.batch.engine import Engine, Lost
from spigolo.batch.jobs import Job
from spigolo.batch.manifest import FILE, Entry, Manifest
from spigolo.batch.places import check_name, place
from spigolo.batch.results import SUFFIXES, Answer, Work
from spigolo.batch.tables import TABLES, read_shards, writer_of
from spigolo.errors import FileError, SpigoloError
from spigolo.frames.files import write_bytes
from spigolo.frames.roi import Roi
from spigolo.settings.config import Config, check_config


@dataclass(frozen=True, slots=True)
class Progress:
    """Numbers of finished and failed frames during a run."""

    total: int
    """Total number of frames."""
    kept: int
    """Number of frames whose files from an earlier run are kept."""
    computed: int
    """Number of frames that this run has segmented."""
    failed: int
    """Number of frames that failed."""


@dataclass(frozen=True, slots=True)
class Summary:
    """Outcome of a run."""

    progress: Progress
    """Numbers of kept, computed and failed frames at the end of the run."""
    objects: int
    """Number of objects in the table."""
    failures: tuple[tuple[str, str], ...]
    """Pairs of frame name and reason of the failure, one pair for each failed frame."""
    warnings: tuple[tuple[str, str], ...]
    """Pairs of frame name and first warning, one pair for each frame with warnings."""
    table: Path
    """Path of the table of all objects."""
    left: tuple[str, ...] = ()
    """Names of frames whose files from an earlier run stay in the folder, although the frames are not part of this run.
    """


def run_batch(
    jobs: Iterable[Job],
    config: Config,
    out: Path,
    engine: Engine,
    *,
    roi: Roi | None = None,
    table: str = "parquet",
    tell: Callable[[Progress], None] | None = None,
) -> Summary:
    """Segment many frames, where each job describes one frame. Write labels/FRAME.png, objects/FRAME.json and one table
    of all objects into a folder.

    Frames with results from an earlier run are skipped if inputs, preset, region of interest and version of spigolo are
    the same. Failed frames are repeated.

    - roi: region of interest in all frames, as for `spigolo.segment`.
    - table: format of the table, "parquet" or "coco".
    - tell: function that is called with the progress after each frame.

    Raises FileError if two jobs have the same name, if the folder is not writable or if another run uses the folder.
    """
    check_config(config)
    file, write = writer_of(table)
    todo = list(jobs)
    twice = [name for name, count in Counter(job.name for job in todo).items() if count > 1]
    if twice:
        raise FileError(f"expected a different name for each frame, got {twice[0]!r} more than once")
    with Manifest(out) as manifest:
        run = _Run(out, Work(config, roi), manifest, len(todo), tell)
        run.clean()
        run.compute([job for job in run.admitted(todo) if not run.keep(job)], engine)
        names = [job.name for job in todo]
        done = [e for e in map(manifest.entries.__getitem__, names) if e.error is None]
        shards = read_shards(place(out, "objects", entry.frame, SUFFIXES["objects"]) for entry in done)
        for other in set(TABLES) - {file}:  # of an earlier run, perhaps with another preset
            (out / other).unlink(missing_ok=True)
        write(shards, out / file, {"version": __version__, "preset": config.name, "digest": config.digest})
        left = sorted(e.frame for e in manifest.entries.values() if e.frame not in set(names) and run.has_files(e))
        manifest.sort(names)
    warned = tuple((entry.frame, entry.warnings[0]) for entry in done if entry.warnings)
    return Summary(
        run.progress, sum(entry.objects for entry in done), tuple(run.failures), warned, out / file, tuple(left)
    )


class _Run:
    """Run that writes the output files, records the outcomes in the manifest and counts the frames."""

    def __init__(
        self, root: Path, work: Work, manifest: Manifest, total: int, tell: Callable[[Progress], None] | None
    ) -> None:
        self.root, self.work, self.manifest, self._tell = root, work, manifest, tell
        self.digest = work.digest
        self.progress = Progress(total, 0, 0, 0)
        self.failures: list[tuple[str, str]] = []

    def clean(self) -> None:
        """Remove temporary files that a killed run left in the folder. All other files in the folder are kept."""
        left = [path for name in (FILE, *TABLES) for path in self.root.glob(f".{name}-*")]
        for folder, suffix in SUFFIXES.items():
            if not (self.root / folder).is_symlink():
                left += (self.root / folder).rglob(f".*{suffix}-*")
        for path in left:
            path.unlink(missing_ok=True)

    def admitted(self, jobs: Sequence[Job]) -> Iterator[Job]:
        """Yield the jobs with a valid name. Jobs with an invalid name are recorded as failed. A name is also invalid if
        it differs from an earlier name only in upper and lower case.
        """
        taken: dict[str, str] = {}
        for job in jobs:
            first = taken.setdefault(job.name.casefold(), job.name)
            try:
                check_name(job.name)
                if first != job.name:
                    raise FileError(f"expected names that differ in more than case, got {first!r} and {job.name!r}")
            except FileError as error:
                self.fail(job.name, Answer(error=str(error)))
            else:
                yield job

    def keep(self, job: Job) -> bool:
        """Return True if the files that an earlier run wrote for a frame are still valid. A frame with valid files is
        counted as kept.
        """
        entry = self.manifest.entries.get(job.name)
        if entry is None or not self._is_current(entry) or not self._is_whole(entry):
            return False
        try:
            stamp = job.stamp()
            if stamp != entry.stamp:
                if job.fingerprint() != entry.inputs:
                    return False
                self.manifest.append(replace(entry, stamp=stamp))
        except SpigoloError:
            return False
        self._count(kept=self.progress.kept + 1)
        return True

    def compute(self, jobs: Sequence[Job], engine: Engine) -> None:
        """Segment the frames of jobs with an engine, such as a pool of worker processes. The output files of a frame
        are written as soon as the engine returns the outcome.
        """
        if not jobs:
            return
        with closing(cast("Iterator[tuple[Job, Answer | Lost]]", engine(self.work, jobs))) as outcomes:  # type: ignore[type-var]
            for job, outcome in outcomes:
                answer = Answer(error=outcome.reason) if isinstance(outcome, Lost) else outcome
                if answer.error is None:
                    self.write(job.name, answer)
                else:
                    self.fail(job.name, answer)

    def write(self, name: str, answer: Answer) -> None:
        """Write the output files of a frame, and then a line about the frame in the manifest."""
        try:
            paths = {folder: place(self.root, folder, name, SUFFIXES[folder]) for folder in SUFFIXES}
        except FileError as error:
            self.fail(name, replace(answer, error=str(error)))
            return
        for folder, path in paths.items():
            if folder in answer.files:
                write_bytes(path, answer.files[folder])
            else:
                path.unlink(missing_ok=True)
        self.manifest.append(self._entry(name, answer))
        self._count(computed=self.progress.computed + 1)

    def fail(self, name: str, answer: Answer) -> None:
        """Record the failure of a frame. Files that an earlier run wrote for the frame are removed."""
        for folder, suffix in SUFFIXES.items():
            try:
                place(self.root, folder, name, suffix).unlink(missing_ok=True)
            except OSError:  # FileError is an OSError too, raised for paths outside the folder
                continue
        self.manifest.append(self._entry(name, answer))
        self.failures.append((name, answer.error or ""))
        self._count(failed=self.progress.failed + 1)

    def _entry(self, name: str, answer: Answer) -> Entry:
        sizes = {folder: len(data) for folder, data in answer.files.items()} if answer.error is None else {}
        return Entry(
            frame=name,
            stamp=answer.stamp,
            inputs=answer.fingerprint,
            digest=self.digest,
            version=__version__,
            objects=answer.objects if answer.error is None else 0,
            files=sizes,
            warnings=answer.warnings,
            error=answer.error,
        )

    def _is_current(self, entry: Entry) -> bool:
        return entry.error is None and (entry.digest, entry.version) == (self.digest, __version__)

    def _is_whole(self, entry: Entry) -> bool:
        """Return True if all output files of a frame exist and have the sizes that the manifest records."""
        try:
            paths = {folder: place(self.root, folder, entry.frame, SUFFIXES[folder]) for folder in entry.files}
            return {"labels", "objects"} <= paths.keys() and all(
                path.is_file() and path.stat().st_size == entry.files[folder] for folder, path in paths.items()
            )
        except (OSError, KeyError):
            return False

    def has_files(self, entry: Entry) -> bool:
        """Return True if a file of a frame is in the folder."""
        with suppress(OSError):
            return any(place(self.root, folder, entry.frame, SUFFIXES[folder]).exists() for folder in SUFFIXES)
        return False

    def _count(self, **numbers: int) -> None:
        self.progress = replace(self.progress, **numbers)
        if self._tell is not None:
            self._tell(self.progress)
