# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read flat objects as flat shapes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.flat.flat_shapes import FlatShape
from ...errors import InputError
from ...geometry.plane.flat_moments import directed
from ..matrix_checks import require_finite
from ..morphs.looks.materials import input_color, material_color, material_opacity
from ..nodes_output import nodes_output
from ..visibility import evaluated_object
from .flat_images import image_rings
from .flat_kinds import has_own_depth, is_drawn_flat, is_tube, may_become_solid
from .flat_meshes import is_flat_mesh, mesh_rings
from .flat_modifiers import modified_rings
from .flat_pencils import pencil_rings
from .flat_rings import FlatRings
from .planes import Plane, common_planes, plane_of

# Ratio of the extents in a plane below which an object is degenerate.
_SQUASHED = 1e-6


def is_flat(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether an object is flat: by type unless it is made solid, or because its mesh is in one plane."""
    if obj.type != "MESH":
        return is_drawn_flat(obj) and not is_tube(obj) and not _is_made_solid(obj, depsgraph)
    with evaluated_object(obj, depsgraph) as evaluated:
        return is_flat_mesh(evaluated)


def _is_made_solid(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether the modifiers of a curve or text make something with a volume."""
    if not may_become_solid(obj):
        return False
    made = nodes_output(obj, depsgraph)
    if made.is_mesh and not has_own_depth(obj):
        with evaluated_object(obj, depsgraph) as evaluated:
            return not is_flat_mesh(evaluated)
    return made.instances or made.volume or made.points


@dataclass(frozen=True)
class FlatObject:
    """A flat object as a shape in a plane.

    Attributes
    ----------
    read : FlatRings
        The rings of the object.
    plane : Plane
        The plane of the object.
    shape : FlatShape
        In coordinates of the plane.
    """

    read: FlatRings
    plane: Plane
    shape: FlatShape


def flat_objects(objects: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> list[FlatObject]:
    """Read flat objects of the scene; parallel planes get the same axes.

    Raises
    ------
    InputError
        An object cannot be read as a flat shape; the message names it and says what to do.
    """
    read = [read_rings(obj, depsgraph) for obj in objects]
    planes = common_planes([_plane(obj.name, own) for obj, own in zip(objects, read, strict=True)])
    return [
        FlatObject(own, plane, FlatShape(_in_plane(own, plane), own.rule, _colors(obj, own), own.letters))
        for obj, own, plane in zip(objects, read, planes, strict=True)
    ]


def read_rings(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> FlatRings:
    """Read the filled area of a flat object as closed polygons in world space.

    Raises
    ------
    InputError
        Nothing is closed or filled, or coordinates are not finite.
    """
    with evaluated_object(obj, depsgraph) as evaluated:
        require_finite(obj.name, np.array(evaluated.matrix_world, dtype=np.float64))
        if obj.type == "MESH":
            read = mesh_rings(evaluated)
        elif obj.type == "GREASEPENCIL":
            read = pencil_rings(obj, evaluated)
        elif obj.type == "EMPTY":
            read = image_rings(obj, evaluated)
        else:
            read = modified_rings(obj, evaluated, depsgraph)
    if not np.isfinite(read.points).all():
        raise InputError("{name} has points without valid coordinates; delete them.", name=obj.name)
    return read


def _plane(name: str, read: FlatRings) -> Plane:
    points = read.points
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    if sizes[1] <= _SQUASHED * sizes[0] or sizes[0] <= 0:
        raise InputError(
            "{name} is flattened to a line or a point, so it fills no area; give it another scale in Item > Transform.",
            name=name,
        )
    plane = plane_of(points, read.matrix)
    if plane is None:
        raise InputError(
            "{name} does not lie in one plane; flatten it: in Edit Mode, scale it by 0 along its normal.", name=name
        )
    return plane


def _in_plane(read: FlatRings, plane: Plane) -> tuple[NDArray[np.float64], ...]:
    rings = tuple(plane.coordinates(ring) for ring in read.rings)
    return rings if read.fills is None else directed(rings, read.fills)


def _colors(obj: bpy.types.Object, read: FlatRings) -> NDArray[np.float64]:
    """Colors of rings, (r, 4): their own, or those of their material slots."""
    if read.colors is not None:
        return np.array(read.colors, dtype=np.float64)
    own = [_slot_color(slot.material, obj) for slot in obj.material_slots] or [input_color(obj)]
    return np.array([own[min(slot, len(own) - 1)] for slot in read.slots or (0,) * len(read.rings)], dtype=np.float64)


def _slot_color(material: bpy.types.Material | None, obj: bpy.types.Object) -> tuple[float, float, float, float]:
    if material is None:
        return tuple(obj.color)
    return (*material_color(material, obj)[:3], material_opacity(material, obj))
