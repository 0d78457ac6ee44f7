# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""At which weights an operator blends materials: given in words, set in the panel, or keyed there."""

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
    """What is blended.

    Attributes
    ----------
    weights : (n, k) float64
        One row for every blend.
    sheet : PadSheet or None
        Where they are on a pad.
    """

    weights: NDArray[np.float64]
    sheet: PadSheet | None = None


def blend_plan(scene: bpy.types.Scene, options: ReflectanceProperties, words: str, names: Sequence[str]) -> BlendPlan:
    """Return what is to be blended of materials of these names.

    Parameters
    ----------
    scene : bpy.types.Scene
        Its panel has the weights that are not given.
    options : ReflectanceProperties
        How the materials are blended, in how many steps.
    words : str
        Given weights; see the operator.
    names : sequence of str
        Of the materials.

    Raises
    ------
    InputError
        Weights that are no numbers, that are not keyed, or frames that do not follow each other.
    """
    from ..applications.reflectance.lobe_frames import path_weights

    count = len(names)
    if options.blend == "PAD":
        sheet = PadSheet.of(count, options.blends)
        return BlendPlan(sheet.weights, sheet)
    if options.blend == "WEIGHTS":
        rows = _given(words) if words.strip() else [_set(scene, names)]
        if len(rows) > 1:
            raise InputError("Weights are numbers with commas between them, not {text!r}.", text=words)
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
    """Read rows of numbers."""
    try:
        return [[float(word) for word in row.split(",")] for row in words.strip(" ;").split(";")]
    except ValueError as error:
        raise InputError("Weights are numbers with commas between them, not {text!r}.", text=words) from error


def _slots(scene: bpy.types.Scene, names: Sequence[str]) -> list[str | None]:
    """Return which weights of the panel are those of the materials; None for one that is not chosen there."""
    own = scene.convwass_reflectance
    chosen = [(material.name, name) for name in MATERIALS if (material := getattr(own, name)) is not None]
    if [name for name, _ in chosen] == list(names):
        found = [slot for _, slot in chosen]
    else:
        found = [dict(chosen).get(name) for name in names]
    return [None if slot is None else slot.replace("material", "weight") for slot in found]


def _set(scene: bpy.types.Scene, names: Sequence[str]) -> list[float]:
    """Return the weights of the panel as they are; 1 for a material that is not chosen there."""
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
        raise InputError("No weight is keyed; press I over the weights at some frames, or give a way of weights.")
    return np.array(columns).T
