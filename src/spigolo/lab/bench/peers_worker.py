"""Script of the worker process, which runs functions of other libraries (peers) in a separate Python environment.

The script requires numpy. The functions are from OpenCV's contrib modules and from scikit-image. Functions of a package
that is not installed are left out. The script reads one JSON request per line from standard input, and writes one JSON
line per request to standard output.

The first output line is {"contestants": [...], "versions": {...}}. The request {"load": NAME, "path": RGB.npy} stores
an image. The request {"run": CONTESTANT, "image": NAME} is answered with {"cpu_ms": ..., "wall_ms": ...}. If a request
fails, the output is {"error": ...}.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import time
from collections.abc import Callable
from typing import Any

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:] = [folder for folder in sys.path if os.path.abspath(folder or ".") != HERE]

Image = dict[str, Any]
"""Pixels of one image in both channel orders: `rgb` for scikit-image and `bgr` for OpenCV."""
Run = Callable[[Image], object]


def main() -> None:
    """Answer requests until standard input ends."""
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # sends text that libraries print to standard error
    contestants, versions = find_contestants()
    answers.write(json.dumps({"contestants": list(contestants), "versions": versions}) + "\n")
    images: dict[str, Image] = {}
    for line in sys.stdin:
        answer: dict[str, Any]
        try:
            answer = obey(json.loads(line), contestants, images)
        except Exception as error:
            answer = {"error": f"{type(error).__name__}: {error}"}
        answers.write(json.dumps(answer) + "\n")


def obey(request: dict[str, str], contestants: dict[str, Run], images: dict[str, Image]) -> dict[str, float]:
    """Execute one request: store an image, or time a function on a stored image."""
    if "load" in request:
        rgb = importlib.import_module("numpy").load(request["path"])
        images[request["load"]] = {"rgb": rgb, "bgr": rgb[..., ::-1].copy()}
        return {}
    run, image = contestants[request["run"]], images[request["image"]]
    wall, cpu = time.perf_counter(), time.process_time()
    run(image)
    cpu, wall = time.process_time() - cpu, time.perf_counter() - wall
    return {"cpu_ms": 1e3 * cpu, "wall_ms": 1e3 * wall}


def find_contestants() -> tuple[dict[str, Run], dict[str, str]]:
    """Return the functions that this Python environment can run, indexed by name, and the versions of their modules."""
    found: dict[str, Run] = {}
    versions = {"python": sys.version.split()[0]}
    cv2, skimage = attempt("cv2"), attempt("skimage.segmentation")
    if cv2 is not None:
        cv2.setNumThreads(1)
        versions["opencv"] = cv2.__version__
        if hasattr(cv2, "ximgproc"):
            graph = cv2.ximgproc.segmentation.createGraphSegmentation()
            found["GraphSegmentation"] = lambda image: graph.processImage(image["bgr"])
        if hasattr(cv2, "saliency"):
            fine = cv2.saliency.StaticSaliencyFineGrained_create()
            found["StaticSaliencyFineGrained"] = lambda image: fine.computeSaliency(image["bgr"])
    if skimage is not None:
        versions["scikit-image"] = importlib.import_module("skimage").__version__
        found["felzenszwalb"] = lambda image: skimage.felzenszwalb(image["rgb"])
    return found, versions


def attempt(name: str) -> Any:
    """Import a module by name. Return None if the module is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


if __name__ == "__main__":
    main()
