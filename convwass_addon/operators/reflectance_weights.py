# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The weights of blended materials: from an argument, from the panel, or keyed in the panel."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..applications.reflectance.weight_sheets import PadSheet, way_weights
from ..bridge.keyframes import curves_of
from ..errors import InputError
from ..properties.light import MATERIALS, ReflectanceProperties


@dataclass(frozen=True)
class BlendPlan:
    """The blends to compute.

    Attributes
    ----------
    weights : (n, k) float64
        One row per blend.
    sheet : PadSheet or None
        Positions on a pad.
    """

    weights: NDArray[np.float64]
    sheet: PadSheet | None = None


def blend_plan(scene: bpy.types.Scene, options: ReflectanceProperties, words: str, names: Sequence[str]) -> BlendPlan:
    """Return the blends of some materials.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its panel provides weights that are not given.
    options : ReflectanceProperties
        Kind and number of blends.
    words : str
        Weights in the format of the operator's argument.
    names : sequence of str
        Names of the materials.

    Raises
    ------
    InputError
        The weights are invalid or not keyed, or the last frame does not come after the first one.
    """
    from ..applications.reflectance.lobe_frames import path_weights

    count = len(names)
    if options.blend == "PAD":
        sheet = PadSheet.of(count, options.blends)
        return BlendPlan(sheet.weights, sheet)
    if options.blend == "WEIGHTS":
        rows = _given(words) if words.strip() else [_set(scene, names)]
        if len(rows) > 1:
            raise InputError("Weights must be numbers separated by commas, not {text!r}.", text=words)
        return BlendPlan(np.array(rows))
    if options.frame_end <= options.frame_start:
        raise InputError("The last frame must come after the first one.")
    if options.blend == "PATH":
        return BlendPlan(path_weights(options.blends, count))
    if words.strip():
        return BlendPlan(way_weights(_given(words), options.blends))
    frames = np.linspace(options.frame_start, options.frame_end, options.blends)
    return BlendPlan(_keyed(scene, names, frames))


def _given(words: str) -> list[list[float]]:
    """Parse rows of numbers."""
    try:
        return [[float(word) for word in row.split(",")] for row in words.strip(" ;").split(";")]
    except ValueError as error:
        raise InputError("Weights must be numbers separated by commas, not {text!r}.", text=words) from error


def _slots(scene: bpy.types.Scene, names: Sequence[str]) -> list[str | None]:
    """Return the panel's weight property of each material, or None if it is not chosen there."""
    own = scene.convwass_reflectance
    chosen = [(material.name, name) for name in MATERIALS if (material := getattr(own, name)) is not None]
    if [name for name, _ in chosen] == list(names):
        found = [slot for _, slot in chosen]
    else:
        found = [dict(chosen).get(name) for name in names]
    return [None if slot is None else slot.replace("material", "weight") for slot in found]


def _set(scene: bpy.types.Scene, names: Sequence[str]) -> list[float]:
    """Return the current weights of the panel; 1 for materials that are not chosen there."""
    return [1.0 if slot is None else getattr(scene.convwass_reflectance, slot) for slot in _slots(scene, names)]


def _keyed(scene: bpy.types.Scene, names: Sequence[str], frames: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the weights of the panel at some frames, (n, k)."""
    curves = {curve.data_path: curve for curve in curves_of(scene)}
    columns, is_keyed = [], False
    for slot, value in zip(_slots(scene, names), _set(scene, names), strict=True):
        curve = curves.get(f"convwass_reflectance.{slot}")
        is_keyed = is_keyed or curve is not None
        columns.append([value if curve is None else max(curve.evaluate(frame), 0.0) for frame in frames])
    if not is_keyed:
        raise InputError("No weight is keyed; press I over the weights at some frames, or pass a path of weights.")
    return np.array(columns).T
