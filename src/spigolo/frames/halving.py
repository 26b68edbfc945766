"""Frames and regions of interest at half the width and height."""

from __future__ import annotations

import cv2
import numpy as np

from spigolo.frames.camera import Camera
from spigolo.frames.frame import Frame
from spigolo.frames.roi import MetricBox, Roi, roi_mask
from spigolo.kernels.halving import halve_depth


def halve_frame(frame: Frame) -> Frame:
    """Return a frame of half the width and height, rounded up, in which each pixel replaces a block of 2x2 pixels.

    The colour of a pixel is the mean colour of its block. The depth of a pixel is the lower median of the measured
    depth values in its block.
    """
    height, width = ((n + 1) // 2 for n in frame.shape)
    even = cv2.copyMakeBorder(frame.color, 0, frame.shape[0] % 2, 0, frame.shape[1] % 2, cv2.BORDER_REPLICATE)
    color = np.asarray(cv2.resize(even, (width, height), interpolation=cv2.INTER_AREA), np.uint8)
    depth = np.empty((height, width), np.float32)
    halve_depth(frame.depth, depth)
    k = frame.camera
    camera = k and Camera(k.fx / 2, k.fy / 2, (k.cx - 0.5) / 2, (k.cy - 0.5) / 2, width, height)
    return Frame(color, depth, camera, frame.name, frame.stamp_ns, max_pixels=depth.size)


def halve_roi(roi: Roi | None, frame: Frame) -> Roi | None:
    """Return the region of interest for the halved frame. Raises FrameError if `roi` does not fit the frame."""
    if roi is None or isinstance(roi, MetricBox):
        return roi
    return roi_mask(roi, frame)[0][::2, ::2]


def uncropped(shape: tuple[int, int]) -> tuple[int, int]:
    """Return the size (H, W) of the full 4:3 image of a camera. Images of another aspect ratio count as crops of the
    full 4:3 image.
    """
    height, width = shape
    return max(height, round(width * 3 / 4)), max(width, round(height * 4 / 3))
