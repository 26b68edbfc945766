"""Abramov et al., 2012, *Depth-Supported Real-Time Video Segmentation with the Kinect*: a Potts model at equilibrium.

From the papers about this method, only the abstract and the timings were available. The interactions, the penalty of a
depth step and the joining of domains (connected areas of equal spin) follow a public re-implementation. Colour
differences are distances in RGB, the default of the re-implementation. Toscana & Rosa 2016 derive their colour
difference in HSV (equation 4) from the paper. The default parameters are our choice. Frames are processed
independently. The tracking of labels by optical flow, as in the papers, is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Annotated

import cv2
import numpy as np
import numpy.typing as npt
from pydantic import Field

from spigolo.frames.frame import DepthMap, Frame
from spigolo.kernels import potts
from spigolo.methods.baseline import Baseline, Division, MethodConfig
from spigolo.methods.domains import Planes, Spins, connected_areas, join_domains
from spigolo.methods.features import color_features, feature_graph
from spigolo.settings.parameters import Area_px2, NotNegative, Positive
from spigolo.stages.graph import OFFSETS
from spigolo.stages.regions import Regions

LEAST_MEAN = 1e-6
"""Minimum mean colour difference, which prevents a division by zero in a frame of a single colour."""


class AbramovConfig(MethodConfig):
    """Parameters of the method `abramov2012`. Colours range from 0 to 255. Interactions and temperatures are relative
    to the interaction of equal colours, which is 1.
    """

    shrink: Annotated[int, Field(ge=1, le=8)] = 2
    """Factor by which the width and height of the image are reduced before segmentation. The published times are for
    images of 320x256 pixels, so the default halves images of 640x480 pixels.
    """
    sigma_px: NotNegative = 0.0
    """Standard deviation of the Gaussian smoothing of colour, in pixels of the reduced image. The value 0 switches
    smoothing off (our choice).
    """
    alpha: Positive = 2.5
    """Colour difference at which two neighbouring pixels neither attract nor repel each other, divided by the mean
    colour difference of all neighbouring pixels. Larger values make larger regions. The default value is our choice.
    The public re-implementation uses values from 1 to 1.35.
    """
    repulsion: NotNegative = 1.0
    """Maximum repulsion of two neighbouring pixels with different colours. Smaller values make larger regions. The
    default value is our choice.
    """
    step_m: Positive | None = 0.02
    """Depth difference, in metres, above which neighbouring pixels repel each other, even if they have the same colour.
    With None, depth is not used. The default value is our choice. The public re-implementation uses the value 0.3.
    """
    step_per_m: NotNegative = 0.0083
    """Depth difference divided by the squared depth, in 1/m, above which neighbouring pixels repel each other. The
    limit of the depth difference is the larger of two values: `step_m`, and `step_per_m` times the squared depth. The
    default value is our choice.
    """
    penalty: NotNegative = 20.0
    """Repulsion of two neighbouring pixels on different sides of a depth step. The default value is our choice. The
    public re-implementation uses the value 250.
    """
    spins: Annotated[int, Field(ge=2, le=65536)] = 256
    """Number of different spins. The initial spins divide the depth range into this number of levels. The default is
    that of the public re-implementation.
    """
    temperature: Positive = 1.0
    """Temperature of the first Metropolis sweep. Higher temperatures accept more changes of spins that increase the
    energy. The default value is our choice.
    """
    cooling: Annotated[float, Field(gt=0, le=1)] = 0.9
    """Factor by which the temperature is multiplied after each Metropolis sweep. The default value is our
    choice.
    """
    sweeps: Annotated[int, Field(ge=0, le=10_000)] = 60
    """Number of Metropolis sweeps before domains (connected areas of equal spin) are joined. The default value is our
    choice.
    """
    last_sweeps: Annotated[int, Field(ge=0, le=10_000)] = 10
    """Number of Metropolis sweeps after domains (connected areas of equal spin) are joined. The default is that of the
    public re-implementation.
    """
    last_temperature: Positive = 0.05
    """Temperature of the Metropolis sweeps after domains (connected areas of equal spin) are joined. The default value
    is our choice.
    """
    piece_px2: Area_px2 = 20000.0
    """Area below which a region is small, px^2. Two small neighbouring regions can join, for example two parts of a
    textured object. The value 0 switches the joining of small regions off. The joining of small regions is our
    addition.
    """
    piece_above: float = -2.0
    """Two small neighbouring regions join only if the mean interaction across their border is above this value (our
    addition). With larger values, fewer small regions are joined.
    """
    min_size_px2: Area_px2 = 1500.0
    """Minimum area of a region, px^2. Each smaller region joins the neighbouring region with the largest mean
    interaction across their border (our choice).
    """
    seed: Annotated[int, Field(ge=0, le=2**31 - 1)] = 7
    """Seed of the random numbers. Equal seeds give equal labels."""


@dataclass(frozen=True)
class Abramov2012(Baseline[AbramovConfig]):
    """Segmentation by a Potts model, whose spins are simulated by Metropolis sweeps at a falling temperature."""

    name = "abramov2012"
    config: AbramovConfig = field(default_factory=AbramovConfig)

    def divide(self, frame: Frame) -> Division:
        """Return the regions of equal spin, enlarged to the size of the frame. The border strength of a pixel is the
        repulsion between the pixel and its right or lower neighbour.
        """
        height, width = frame.shape
        size = max(width // self.config.shrink, 1), max(height // self.config.shrink, 1)
        color = np.asarray(cv2.resize(frame.color, size, interpolation=cv2.INTER_AREA), np.uint8)
        depth = np.asarray(cv2.resize(frame.depth, size, interpolation=cv2.INTER_NEAREST), np.float32)
        planes = self.interactions(color, depth)
        regions = self.regions(self.cool(depth, planes), planes)
        labels = cv2.resize(regions.labels, (width, height), interpolation=cv2.INTER_NEAREST)
        contour = cv2.resize(_repulsion(planes), (width, height), interpolation=cv2.INTER_LINEAR)
        return Division(Regions(np.asarray(labels, np.int32), regions.count), np.asarray(contour, np.float32))

    def interactions(self, color: npt.NDArray[np.uint8], depth: DepthMap) -> Planes:
        """Compute the interactions J (4, H, W) of all pairs of neighbouring pixels from colour (H, W, 3) and depth (H,
        W) in metres.
        """
        config = self.config
        distances = feature_graph(color_features(color, config.sigma_px), connectivity=8).weights
        there = np.isfinite(distances)
        mean = config.alpha * float(distances[there].mean(dtype=np.float64)) if there.any() else 0.0
        depth_rule = np.inf if config.step_m is None else config.step_m, config.step_per_m, config.penalty
        planes = np.empty_like(distances)
        for distance, offset, out in zip(distances, OFFSETS, planes, strict=True):
            potts.interaction_plane(
                distance, depth, max(mean, LEAST_MEAN), config.repulsion, *depth_rule, *offset, out
            )  # fmt: skip
        return planes

    def cool(self, depth: DepthMap, planes: Planes) -> Spins:
        """Return the spins (H, W) of all pixels after the Metropolis sweeps.

        depth: depth map (H, W) in metres, from which the initial spins are computed. planes: interactions (4, H, W).
        """
        config = self.config
        spins = _start(np.zeros_like(depth) if config.step_m is None else depth, config.spins, config.seed)
        for k in range(config.sweeps):
            potts.sweep(spins, planes, config.spins, config.temperature * config.cooling**k, config.seed, k)
        domains = join_domains(connected_areas(spins), planes, lambda b: b.mean > 0)
        spins = domains.labels.copy()
        for k in range(config.sweeps, config.sweeps + config.last_sweeps):
            potts.sweep(spins, planes, domains.count, config.last_temperature, config.seed, k)
        return spins

    def regions(self, spins: Spins, planes: Planes) -> Regions:
        """Return the connected areas of equal spin (H, W) as regions, after small areas were joined."""
        areas, config = connected_areas(spins), self.config.at_size(spins.shape)
        piece, least = config.piece_px2, config.min_size_px2

        pieces = join_domains(areas, planes, lambda b: (np.maximum(*b.area) < piece) & (b.mean > config.piece_above))
        return join_domains(pieces, planes, lambda b: b.area[0] < least)


def _start(depth: DepthMap, spins: int, seed: int) -> Spins:
    """Return initial spins (H, W): depth divided into `spins` levels, and random levels where depth is missing."""
    random = np.random.default_rng(seed).integers(spins, size=depth.shape, dtype=np.int32)
    valid = depth > 0
    if not valid.any():
        return random
    near, far = float(depth[valid].min()), float(depth[valid].max())
    behind = np.where(valid, depth - np.float32(near), np.float32(0))
    steps = behind * np.float32((spins - 1) / max(far - near, 1e-6))
    return np.where(valid, steps.astype(np.int32), random)


def _repulsion(planes: Planes) -> npt.NDArray[np.float32]:
    """Return the repulsion (H, W) between each pixel and its right or lower neighbour, from 0 to 1.

    The value 0 means the largest attraction, 1/2 no interaction, and 1 the largest repulsion.
    """
    return np.asarray(np.clip((1 - np.minimum(planes[0], planes[1])) / 2, 0, 1), np.float32)
