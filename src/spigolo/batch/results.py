"""Processing of one job, from the input frame to the content of its output files."""

from __future__ import annotations

import hashlib
import json
import threading
import warnings
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from spigolo.batch.jobs import Job
from spigolo.errors import FrameError, SpigoloError
from spigolo.export.instances import compress, run_lengths
from spigolo.frames.roi import MetricBox, Roi
from spigolo.objects.segmentation import Segmentation
from spigolo.settings.config import Config
from spigolo.stream import Segmenter

SUFFIXES: Mapping[str, str] = {"labels": ".png", "objects": ".json", "undistorted": ".png"}
"""Suffix of the output files in each output folder."""
MAX_LABEL = np.iinfo(np.uint16).max
_kept = threading.local()


@dataclass(frozen=True, slots=True)
class Answer:
    """Outcome of one job."""

    stamp: str = ""
    """Short text from `Job.stamp` that describes the state of the input files before the files are read."""
    fingerprint: str = ""
    """Hash of the content of the input files, from `Job.fingerprint`. The text is empty if the input files cannot be
    read.
    """
    objects: int = 0
    """Number of objects in the frame."""
    files: Mapping[str, bytes] = field(default_factory=dict)
    """Content of the output files of the frame, indexed by the name of the output folder, such as `labels`."""
    warnings: tuple[str, ...] = ()
    """Warnings about the frame."""
    error: str | None = None
    """Reason of the failure, or None if the frame did not fail."""


@dataclass(frozen=True, slots=True)
class Work:
    """Function that segments the frame of a job. If an exception occurs, its message is stored in the field `error` of
    the outcome.
    """

    config: Config
    """Parameters of the segmentation."""
    roi: Roi | None = None
    """Region of interest in all frames. If None, the whole frame is used."""

    @property
    def digest(self) -> str:
        """Return a hash of the parameters, followed by a hash of the region of interest if there is one."""
        if self.roi is None:
            return self.config.digest
        return f"{self.config.digest}-{hashlib.sha256(_bytes_of(self.roi)).hexdigest()[:8]}"

    def __call__(self, job: Job) -> Answer:
        """Segment the frame of a job and return the outcome."""
        stamp = fingerprint = ""
        try:
            stamp, fingerprint = job.stamp(), job.fingerprint()
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                result = _segmenter(self.config)(job.read(), self.roi)
                files = _files(job.name, result)
        except Exception as error:
            return Answer(stamp, fingerprint, error=_reason(error))
        told = tuple(dict.fromkeys(" ".join(str(w.message).split()) for w in caught))
        return Answer(stamp, fingerprint, len(result), files, told)


def _bytes_of(roi: Roi) -> bytes:
    """Return bytes that differ between different regions of interest."""
    if isinstance(roi, MetricBox):
        parts = (roi.low_m, roi.high_m, np.eye(4) if roi.T_base_camera is None else roi.T_base_camera)
        return b"".join(np.asarray(part, float).tobytes() for part in parts)
    values = np.asarray(roi)
    return repr(values.shape).encode() + values.astype(np.int32).tobytes()


def _segmenter(config: Config) -> Segmenter:
    """Return the segmenter of the current thread. The segmenter reuses its memory buffers for the following frames."""
    known: Segmenter | None = getattr(_kept, "segmenter", None)
    if known is None or known.config != config:
        known = _kept.segmenter = Segmenter(config)
    return known


def _reason(error: Exception) -> str:
    text = " ".join(str(error).split())
    return text if isinstance(error, SpigoloError) else f"{type(error).__name__}: {text}"


def _files(name: str, result: Segmentation) -> dict[str, bytes]:
    if len(result) > MAX_LABEL:
        raise FrameError(f"expected at most {MAX_LABEL} objects in a 16-bit label image, got {len(result)}")
    files = {"labels": _png(result.labels.astype(np.uint16)), "objects": _shard(name, result)}
    if result.frame.undistorted:
        files["undistorted"] = _png(np.asarray(cv2.cvtColor(result.frame.color, cv2.COLOR_RGB2BGR)))
    return files


def _png(image: npt.NDArray[Any]) -> bytes:
    done, data = cv2.imencode(".png", image)
    if not done:
        raise FrameError(f"could not encode an image of shape {image.shape} and type {image.dtype}")
    return data.tobytes()


def _shard(name: str, result: Segmentation) -> bytes:
    """Return the objects of a frame as JSON, with masks in COCO's compressed run-length encoding."""
    facts = result.to_dict()["objects"]
    masks = [{"mask_rle": compress(run_lengths(o.mask)["counts"])} for o in result]
    shard = {
        "frame": name,
        "stamp_ns": result.frame.stamp_ns,
        "image_size_px": list(result.labels.shape),
        "left_out": list(result.left_out),
        "objects": [fact | mask for fact, mask in zip(facts, masks, strict=True)],
    }
    return (json.dumps(shard, allow_nan=False) + "\n").encode()
