"""Execution of functions of other libraries (peers) in a worker process.

A separate Python environment is required, because opencv-contrib-python cannot be installed together with
opencv-python.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from spigolo.errors import FileError, SpigoloError
from spigolo.frames.frame import Color
from spigolo.lab.bench.timing import LEAST_MS, Run, Sample

WORKER = Path(__file__).with_name("peers_worker.py")
DEFAULT_PYTHON = Path(".venv-oracle", "bin", "python")
PACKAGES = {
    "GraphSegmentation": "opencv-contrib-python-headless",
    "StaticSaliencyFineGrained": "opencv-contrib-python-headless",
    "felzenszwalb": "scikit-image",
}
"""Name of the PyPI package that provides each function of another library."""


class Worker:
    """Worker process in another Python environment.

    The worker process runs all functions in `PACKAGES` that its Python environment can import.
    """

    def __init__(self, python: Path) -> None:
        self.python = python
        self._errors = tempfile.TemporaryFile("w+")  # noqa: SIM115  a pipe that nobody empties would fill
        try:
            self._process = subprocess.Popen(
                [python, WORKER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors, text=True
            )
        except OSError as error:
            self._errors.close()
            raise FileError(
                f"expected a Python interpreter in {python}, but it cannot be run: {error.strerror}"
            ) from None
        try:
            greeting = self._answer()
        except SpigoloError:
            self.close()
            raise
        self.names: list[str] = greeting["contestants"]
        self.versions: dict[str, str] = greeting["versions"]

    def load(self, key: str, image: Color) -> None:
        """Send an RGB image (H, W, 3) to the worker process, which stores the image under the name `key`."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "image.npy")
            np.save(path, image)
            self._ask({"load": key, "path": str(path)})

    def run(self, name: str, key: str) -> Sample:
        """Run a function once on the stored image `key`, and return its CPU and wall time."""
        answer = self._ask({"run": name, "image": key})
        return Sample(max(answer["cpu_ms"], LEAST_MS), max(answer["wall_ms"], LEAST_MS))

    def close(self) -> None:
        """End the worker process."""
        for stream in (self._process.stdin, self._process.stdout, self._errors):
            if stream is not None:
                with suppress(OSError):
                    stream.close()
        self._process.wait()

    def _ask(self, request: dict[str, str]) -> dict[str, Any]:
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # the worker process may have ended already
            self._process.stdin.write(json.dumps(request) + "\n")
            self._process.stdin.flush()
        answer = self._answer()
        if "error" in answer:
            raise SpigoloError(f"the peers in {self.python} failed: {answer['error']}")
        return answer

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        try:
            answer = json.loads(line)
        except ValueError:
            answer = None
        if not isinstance(answer, dict):
            raise FileError(f"the Python interpreter {self.python} ended unexpectedly: {self._last_words()}")
        return answer

    def _last_words(self) -> str:
        self._process.kill()
        self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().strip().splitlines()
        return lines[-1] if lines else "no error message"


class Peers:
    """Functions of other libraries (peers) that can be imported, with the worker process that runs each function."""

    def __init__(self, workers: list[Worker]) -> None:
        self._workers = workers
        self._home: dict[str, Worker] = {}
        for worker in workers:
            for name in worker.names:
                self._home.setdefault(name, worker)

    @property
    def names(self) -> list[str]:
        """Return the names of the functions of other libraries that can run."""
        return [name for name in PACKAGES if name in self._home]

    @property
    def missing(self) -> list[str]:
        """Return one message for each package that no worker process can import."""
        lacking: dict[str, list[str]] = {}
        for name, package in PACKAGES.items():
            if name not in self._home:
                lacking.setdefault(package, []).append(name)
        return [
            f"left out: {', '.join(names)}, because {package} is missing: python3 -m venv {DEFAULT_PYTHON.parents[1]}"
            f" && {DEFAULT_PYTHON} -m pip install {package}"
            for package, names in lacking.items()
        ]

    @property
    def versions(self) -> dict[str, dict[str, str]]:
        """Return the version of each module, indexed by the path of the interpreter and the name of the module."""
        return {str(worker.python): worker.versions for worker in self._workers}

    def load(self, key: str, image: Color) -> None:
        """Send an RGB image (H, W, 3) to all worker processes, which store the image under the name `key`."""
        for worker in self._workers:
            worker.load(key, image)

    def contestants(self, key: str) -> Mapping[str, Run]:
        """Return timed functions, indexed by name, that run functions of other libraries on the stored image `key`."""
        return {name: _run(self._home[name], name, key) for name in self.names}


def _run(worker: Worker, name: str, key: str) -> Run:
    return lambda: worker.run(name, key)


@contextmanager
def open_peers(python: Path | None = None) -> Iterator[Peers]:
    """Start worker processes for functions of other libraries (peers).

    Raises FileError if `python` cannot be run.

    Parameters
    ----------
    python
        Python interpreter of the worker process, by default `.venv-oracle/bin/python` if this file exists. A second
        worker process uses the current Python interpreter. The second worker process runs the functions that the
        interpreter `python` cannot import. Functions that neither worker process can import are left out.

    """
    given = python if python is not None else DEFAULT_PYTHON if DEFAULT_PYTHON.is_file() else None
    with ExitStack() as stack:
        workers: list[Worker] = []
        for path in ([] if given is None else [given]) + [Path(sys.executable)]:
            if set(PACKAGES) - {name for worker in workers for name in worker.names}:
                workers.append(Worker(path))
                stack.callback(workers[-1].close)
        yield Peers([worker for worker in workers if worker.names])
