"""Our saliency against OpenCV's, which is its authors' own code, in the environment that has the contrib modules."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

import spigolo as sp
from spigolo.stages.saliency import fine_grained_saliency

pytestmark = pytest.mark.oracle
PYTHON = Path(__file__).resolve().parents[1] / ".venv-oracle" / "bin" / "python"
CODE = """
import sys, cv2, numpy as np
images = np.load(sys.argv[1])
maps = {}
for name in images.files:
    done, maps[name] = cv2.saliency.StaticSaliencyFineGrained_create().computeSaliency(images[name][..., ::-1].copy())
    assert done
np.savez(sys.argv[2], **maps)
"""


def oracle(images: dict[str, np.ndarray], folder: Path) -> dict[str, np.ndarray]:
    if not PYTHON.exists():
        message = "the oracle's environment is absent: make test builds it"
        if os.environ.get("CI"):
            pytest.fail(message)
        pytest.skip(message)
    np.savez(folder / "images.npz", **images)
    subprocess.run([PYTHON, "-c", CODE, folder / "images.npz", folder / "maps.npz"], check=True)
    return dict(np.load(folder / "maps.npz"))


def levels(saliency: np.ndarray) -> np.ndarray:
    """Both maps hold whole levels divided by 255, in float32 once by a product and once by a quotient."""
    return np.rint(saliency * 255).astype(int)


def assert_same(ours: np.ndarray, theirs: np.ndarray, exact: bool) -> None:
    """Equal; on large images but for a level here and there: OpenCV adds up in float32, which ends at 2^24."""
    assert np.abs(ours - theirs).max() <= (0 if exact else 1)
    assert np.mean(ours != theirs) <= (0 if exact else 0.005)


def test_saliency_equals_opencvs(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    smooth = np.cumsum(rng.normal(0, 4, (200, 260, 3)), axis=1)
    scene = Path(sp.__file__).parent / "demo_scene"
    images = {
        "noise": rng.integers(0, 256, (97, 131, 3)).astype(np.uint8),
        "ramps": np.clip(smooth + 128, 0, 255).astype(np.uint8),
        "plain": np.full((60, 80, 3), 77, np.uint8),
        "scene": sp.read_frame(scene / "rgb.png", scene / "depth.png", scene / "camera.json").color,
    }
    theirs = oracle(images, tmp_path)
    for name, image in images.items():
        ours = fine_grained_saliency(image, sp.settings.SaliencyConfig())
        assert ours.shape == theirs[name].shape
        assert_same(levels(ours), levels(theirs[name]), exact=name != "scene")


@pytest.mark.frames
def test_saliency_equals_opencvs_on_real_frames(frames: list[sp.Frame], tmp_path: Path) -> None:
    theirs = oracle({str(k): frame.color for k, frame in enumerate(frames)}, tmp_path)
    for k, frame in enumerate(frames):
        ours = fine_grained_saliency(frame.color, sp.settings.SaliencyConfig())
        assert_same(levels(ours), levels(theirs[str(k)]), exact=False)
