# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert shape keys to offsets of vertices in world space, and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..element_values import vectors_of, write_floats


@dataclass(frozen=True)
class KeyOffsets:
    """The effect of a shape key.

    Attributes
    ----------
    name : str
        Name of the key.
    relative_to : str
        Name of the key it is relative to; empty for the basis.
    offsets : (n, 3) float64
        Offset of every vertex in world space, without the object's location.
    slider : (float, float)
        Minimum and maximum value.
    """

    name: str
    relative_to: str
    offsets: NDArray[np.float64]
    slider: tuple[float, float]


def key_names(obj: bpy.types.Object) -> list[str]:
    """Return the names of the shape keys of a mesh object, except its basis."""
    keys = obj.data.shape_keys
    return [key.name for key in keys.key_blocks if key != keys.reference_key] if keys else []


def locked_keys(obj: bpy.types.Object, names: Sequence[str]) -> list[str]:
    """Return which of these keys an object has locked; the basis counts as locked."""
    keys = obj.data.shape_keys
    blocks = [keys.key_blocks[name] for name in names if name in keys.key_blocks] if keys else []
    return [block.name for block in blocks if block.lock_shape or block == keys.reference_key]


def read_keys(obj: bpy.types.Object, names: Sequence[str]) -> list[KeyOffsets]:
    """Return the effects of shape keys."""
    keys = obj.data.shape_keys
    turn = np.array(obj.matrix_world, dtype=np.float64)[:3, :3]
    found = []
    for name in names:
        block = keys.key_blocks[name]
        offsets = (vectors_of(block.data) - vectors_of(block.relative_key.data)) @ turn.T
        base = "" if block.relative_key == keys.reference_key else block.relative_key.name
        found.append(KeyOffsets(name, base, offsets, (block.slider_min, block.slider_max)))
    return found


def write_keys(obj: bpy.types.Object, keys: Sequence[KeyOffsets]) -> None:
    """Write shape keys. Existing keys get a new shape, and keep their value, drivers and position.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object in any mode except Edit Mode, with a nonzero scale.
    keys : sequence of KeyOffsets
        Keys after those they are relative to.
    """
    active = obj.active_shape_key_index
    if obj.data.shape_keys is None:
        obj.shape_key_add(name="Basis", from_mix=False)
    blocks = obj.data.shape_keys.key_blocks
    back = np.linalg.pinv(np.array(obj.matrix_world, dtype=np.float64)[:3, :3])
    for key in keys:
        block = blocks.get(key.name)
        if block is None:
            block = obj.shape_key_add(name=key.name, from_mix=False)
            # Initial values of new keys differ between versions of Blender.
            block.value = 0.0
            block.slider_min, block.slider_max = key.slider
            block.relative_key = blocks.get(key.relative_to) or obj.data.shape_keys.reference_key
        change = vectors_of(block.relative_key.data) + key.offsets @ back.T - vectors_of(block.data)
        _move(block, change)
        for other in _dependents(block, blocks):
            _move(other, change)
    obj.active_shape_key_index = active
    obj.data.update()


def _dependents(block: bpy.types.ShapeKey, blocks: Sequence[bpy.types.ShapeKey]) -> list[bpy.types.ShapeKey]:
    """Return the keys that are directly or indirectly relative to another, whose effect must be preserved."""
    found = [block]
    for _ in blocks:
        found += [other for other in blocks if other.relative_key in found and other not in found]
    return found[1:]


def _move(block: bpy.types.ShapeKey, change: NDArray[np.float64]) -> None:
    positions = vectors_of(block.data) + change
    write_floats(block.data, "co", positions)
