"""Segmentation of many frames, with one table of the objects of all frames. Damaged frames and crashes do not stop a
run.

    jobs = [FrameFiles("a", Path("a/rgb.png"), Path("a/depth.png"), "kinect-v1", 0.001), ...]
    summary = run_batch(jobs, sp.OBJECTS, Path("out"), local(workers=2))

`run_batch` writes a label image labels/FRAME.png for each frame, and one table with the objects of all frames. An
interrupted run can be continued and then produces the same files as an uninterrupted run. The manifest records the
reason of each failed frame.
"""

from __future__ import annotations

from spigolo.batch.cluster import dask_cluster, dask_local
from spigolo.batch.engine import Engine, Lost, here, in_order, local
from spigolo.batch.jobs import FrameFiles, Job
from spigolo.batch.running import Progress, Summary, run_batch

__all__ = [
    "Engine",
    "FrameFiles",
    "Job",
    "Lost",
    "Progress",
    "Summary",
    "dask_cluster",
    "dask_local",
    "here",
    "in_order",
    "local",
    "run_batch",
]
