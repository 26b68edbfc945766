"""Export for grasp planners: the input file of Contact-GraspNet and the workspace mask of GraspNet."""

from __future__ import annotations

from io import BytesIO

import cv2
import numpy as np

from spigolo.errors import CameraError, FileError
from spigolo.frames.files import PathLike, write_bytes
from spigolo.objects.segmentation import Segmentation


def contact_graspnet(result: Segmentation, path: PathLike) -> None:
    """Write the .npz file that the grasp planner Contact-GraspNet reads.

    The file contains the following arrays:

    - `depth` (H, W) float32: depth in metres, 0 where missing
    - `K` (3, 3) float64: camera matrix
    - `rgb` (H, W, 3) uint8: colour image
    - `segmap` (H, W) int32: labels, 0 = background

    Raises CameraError for a frame without intrinsics.
    """
    camera = result.frame.camera
    if camera is None:
        raise CameraError("Contact-GraspNet needs intrinsics, got a frame without a camera: give the frame a camera")
    K = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]], np.float64)
    buffer = BytesIO()
    np.savez_compressed(buffer, depth=result.frame.depth, K=K, rgb=result.frame.color, segmap=result.labels)
    write_bytes(path, buffer.getvalue())


def workspace_mask(result: Segmentation, path: PathLike) -> None:
    """Write one mask that contains all objects as a 1-bit PNG, as the grasp planners GraspNet and AnyGrasp read it from
    `workspace_mask.png`.

    PIL reads a 1-bit PNG as a boolean array.
    """
    white = (result.labels > 0).astype(np.uint8) * 255
    done, data = cv2.imencode(".png", white, [cv2.IMWRITE_PNG_BILEVEL, 1])
    if not done:
        raise FileError(f"could not encode a mask of shape {white.shape} for {path}")
    write_bytes(path, data.tobytes())
