"""Labelled frames as data sets keep them on disk: one small class a layout, its docstring is the format."""

from __future__ import annotations

from spigolo.datasets.sample import Instance, Model, Sample

__all__ = ["Instance", "Model", "Sample"]
