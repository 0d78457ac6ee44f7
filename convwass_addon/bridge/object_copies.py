# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Copies of objects at the particles, vertices or faces of another one, as geometry nodes can read them."""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from .element_values import write_attribute
from .nodes.node_math import named_attribute, new_node, without_attribute
from .visibility import evaluated_object

_TRANSFORM = "convwass_transform"
_AT_PARTICLES = ("OBJECT", "COLLECTION")
_AT_ELEMENTS = ("VERTS", "FACES")


@dataclass(frozen=True)
class Copies:
    """All copies of one object.

    Attributes
    ----------
    original : bpy.types.Object
        The object that is copied.
    transforms : (n, 4, 4) float64
        From the place of the original to that of every copy, in world space.
    """

    original: bpy.types.Object
    transforms: NDArray[np.float64]

    def as_points(self) -> bpy.types.Mesh:
        """Return a new mesh with a vertex for every copy, which stores its transform."""
        mesh = bpy.data.meshes.new(self.original.name)
        mesh.vertices.add(len(self.transforms))
        # Blender stores matrices by columns.
        write_attribute(mesh, _TRANSFORM, "FLOAT4X4", self.transforms.transpose(0, 2, 1))
        return mesh


def has_copies(obj: bpy.types.Object) -> bool:
    """Return whether an object shows copies of others at its particles, vertices or faces."""
    return obj.instance_type in _AT_ELEMENTS or any(
        own.settings.render_type in _AT_PARTICLES for own in obj.particle_systems
    )


def is_copied_by_parent(obj: bpy.types.Object) -> bool:
    """Return whether the parent of an object shows copies of it at its vertices or faces."""
    return obj.parent is not None and obj.parent.instance_type in _AT_ELEMENTS


def copies_of(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> list[Copies]:
    """Return what an object for which `has_copies` is true copies, in the current frame."""
    found: dict[bpy.types.Object, list[NDArray[np.float64]]] = {}
    with evaluated_object(obj, depsgraph):
        for shown in depsgraph.object_instances:
            if shown.is_instance and shown.parent is not None and shown.parent.original == obj:
                found.setdefault(shown.object.original, []).append(np.array(shown.matrix_world))
    return [
        Copies(original, np.array(matrices) @ np.linalg.inv(np.array(original.matrix_world)))
        for original, matrices in found.items()
    ]


def copied(tree: bpy.types.NodeTree, points: bpy.types.NodeSocket, mesh: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
    """Return instances of a mesh at the points of :meth:`Copies.as_points`."""
    inputs = {"Points": points, "Instance": mesh}
    instances = new_node(tree, "GeometryNodeInstanceOnPoints", inputs).outputs["Instances"]
    inputs = {"Instances": instances, "Transform": named_attribute(tree, _TRANSFORM, "FLOAT4X4")}
    placed = new_node(tree, "GeometryNodeSetInstanceTransform", inputs).outputs["Instances"]
    return without_attribute(tree, placed, _TRANSFORM)
