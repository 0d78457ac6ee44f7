# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bind a body to an armature with Blender's automatic weights."""

from __future__ import annotations

import bpy

from ...errors import InputError
from ..mesh_checks import writable_mesh
from ..operator_errors import reason


def require_bindable(body: bpy.types.Object, rig: bpy.types.Object) -> None:
    """Check that a body can be bound to a rig, before the rig is changed.

    Raises
    ------
    InputError
        The rig is no armature or a child of the body, or the body cannot be written.
    """
    if rig.type != "ARMATURE":
        raise InputError("{object} is not an armature, so it cannot provide weights; switch them off.", object=rig.name)
    writable_mesh(body)
    if rig in body.children_recursive:
        raise InputError(
            "{rig} is a child of {body} and cannot become its parent; clear its own parent: Object > Parent.",
            rig=rig.name,
            body=body.name,
        )


def bind_with_weights(body: bpy.types.Object, rig: bpy.types.Object) -> int:
    """Parent a body to an armature with automatic weights.

    Groups named after deforming bones get new weights; other groups are kept.

    Parameters
    ----------
    body : bpy.types.Object
        A mesh, in Object Mode.
    rig : bpy.types.Object
        An armature, in Object or Pose Mode.

    Returns
    -------
    int
        Number of vertices without any bone weight; all of them if Blender found no solution.

    Raises
    ------
    InputError
        Blender cannot parent the body to the armature.
    """
    world = body.matrix_world.copy()
    chosen = {"active_object": rig, "object": rig, "selected_objects": [rig, body]}
    try:
        with bpy.context.temp_override(**chosen, selected_editable_objects=[rig, body]):
            bpy.ops.object.parent_set(type="ARMATURE_AUTO")
    except RuntimeError as error:
        raise InputError(
            "{body} could not be bound to {rig}: {reason}",
            body=body.name,
            rig=rig.name,
            reason=reason(error),
        ) from error
    # A body that had another parent would jump otherwise; keep_transform=True loses the shear that it may have.
    body.matrix_parent_inverse = rig.matrix_world.inverted_safe() @ world @ body.matrix_basis.inverted_safe()
    return unweighted(body, rig)


def unweighted(body: bpy.types.Object, rig: bpy.types.Object) -> int:
    """Count the vertices of a body without weight of a deforming bone."""
    deforming = {bone.name for bone in rig.data.bones if bone.use_deform}
    groups = {group.index for group in body.vertex_groups if group.name in deforming}
    return sum(
        not any(own.group in groups and own.weight > 0.0 for own in vertex.groups) for vertex in body.data.vertices
    )
