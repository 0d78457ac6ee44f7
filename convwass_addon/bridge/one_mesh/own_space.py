# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials that look different on a copy of a mesh in world space, since they read positions in the mesh's own."""

from __future__ import annotations

import bpy
import numpy as np

from ...sentence import Sentence
from ..morphs.looks.look_groups import GENERATED_TEXTURES
from ..nodes.shown_nodes import nodes_of
from .skinning import armatures

# Differences between matrices that do not count.
_LEAST = 1e-6


def own_space_notices(obj: bpy.types.Object) -> list[Sentence]:
    """Return a notice if materials of an object look different on its copy with shape keys.

    The copy is in world space, unless it has an armature.
    """
    place = np.array(obj.matrix_world, dtype=np.float64)
    if armatures(obj) or np.allclose(place, np.eye(4), atol=_LEAST):
        return []
    outputs = {"Object", "Generated", "Normal"} if _is_turned(place) else {"Object"}
    materials = dict.fromkeys(slot.material for slot in obj.material_slots if slot.material is not None)
    changed = [own.name for own in materials if any(_reads(node, outputs) for node in nodes_of([own]))]
    if not changed:
        return []
    values = {"name": obj.name, "materials": ", ".join(changed)}
    return [
        Sentence(
            "Materials of {name} ({materials}) read positions in its own space and look different on the copy, which "
            "is in world space; apply the location, rotation and scale of {name} first.",
            values,
        )
    ]


def _is_turned(place: np.ndarray) -> bool:
    """Return whether a transform is more than a translation and a scale, which change no generated coordinates."""
    factors = np.diagonal(place)[:3]
    return bool((factors <= 0.0).any()) or not np.allclose(place[:3, :3], np.diag(factors), atol=_LEAST)


def _reads(node: bpy.types.Node, outputs: set[str]) -> bool:
    """Return whether a node reads any of these outputs of Texture Coordinate, in the space of the object shown."""
    if node.type in GENERATED_TEXTURES:
        vector = node.inputs["Vector"]
        return "Generated" in outputs and vector.enabled and not vector.is_linked
    if node.type != "TEX_COORD":
        return False
    return any(node.outputs[name].is_linked for name in outputs if name != "Object" or node.object is None)
