"""Export of results in the formats of other programs.

    result = sp.segment(frame)
    sp.export.contact_graspnet(result, "scene.npz")  # depth, K, rgb, segmap
    sp.export.coco([result], "instances.json")

| function | format | programs that read it |
|---|---|---|
| `labels` | 16-bit PNG | any program |
| `coco` | COCO instances, JSON | CVAT, Label Studio, FiftyOne, training programs |
| `yolo` | YOLO segmentation, text | training programs |
| `bop` | BOP results, JSON | the BOP toolkit |
| `sam` | records of SAM's mask generator | code written for SAM |
| `detections` | `supervision.Detections` | supervision |
| `contact_graspnet` | .npz with depth, K, rgb, segmap | Contact-GraspNet |
| `workspace_mask` | 1-bit PNG | GraspNet, AnyGrasp |
| `ply`, `pcd` | a point cloud for each object | CloudCompare, MeshLab, PCL, Open3D |
"""

from __future__ import annotations

from spigolo.export.clouds import pcd, ply
from spigolo.export.grasping import contact_graspnet, workspace_mask
from spigolo.export.images import labels, yolo
from spigolo.export.instances import bop, coco
from spigolo.export.records import detections, sam

__all__ = [
    "bop",
    "coco",
    "contact_graspnet",
    "detections",
    "labels",
    "pcd",
    "ply",
    "sam",
    "workspace_mask",
    "yolo",
]
