# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Decide whether a morph is flat or solid."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ..element_values import vectors_of
from ..objects import MESHED, checked_matrix
from ..visibility import evaluated_object
from .flat_kinds import has_own_depth, is_drawn_flat, is_shape
from .flat_objects import is_flat
from .planes import plane_of

# Distance of a vertex from the others, relative to their median distance, from which it counts as a stray one.
_FAR = 100.0


def asks_for_flat(inputs: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph, thickness: float) -> bool:
    """Return whether a morph is flat: all objects are flat, and no mesh gets a thickness.

    Raises
    ------
    InputError
        Flat and solid shapes are mixed, and the flat ones have no depth, or only a scale of zero or a vertex that is
        very far away flattens them.
    """
    if not all(is_shape(obj) for obj in inputs):
        # Reading them reports the problem.
        return False
    flat = [is_flat(obj, depsgraph) for obj in inputs]
    if all(flat):
        return thickness <= 0 or not all(obj.type == "MESH" for obj in inputs)
    if not any(flat):
        return False
    solid = inputs[flat.index(False)]
    if not _has_faces(solid, depsgraph):
        # Reading it reports the problem.
        return False
    for obj in (obj for obj, is_one in zip(inputs, flat, strict=True) if is_one):
        if obj.type not in MESHED:
            raise InputError(
                "{flat} is flat but {solid} is solid, and drawings and images cannot be made solid; choose shapes of "
                "one kind.",
                flat=obj.name,
                solid=solid.name,
            )
        with evaluated_object(obj, depsgraph) as evaluated:
            # Neither a thickness nor a depth helps where the scale is zero.
            checked_matrix(evaluated)
            if obj.type == "MESH":
                _refuse_strays(obj.name, vectors_of(evaluated.data.vertices))
        if thickness <= 0 and not (is_drawn_flat(obj) and has_own_depth(obj)):
            raise InputError(
                "{flat} is flat but {solid} is solid; choose shapes of one kind, or set Thickness to make the flat "
                "ones solid.",
                flat=obj.name,
                solid=solid.name,
            )
    return False


def _has_faces(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether an object shows faces of its own, unlike wires and mere instances."""
    if obj.type not in MESHED:
        return True
    with evaluated_object(obj, depsgraph) as evaluated:
        try:
            return len(evaluated.to_mesh().polygons) > 0
        finally:
            evaluated.to_mesh_clear()


def _refuse_strays(name: str, points: NDArray[np.float64]) -> None:
    """Raise InputError, with the name of a flat mesh, if a few far ones of its vertices, (n, 3), make it look flat."""
    distances = np.linalg.norm(points - np.median(points, axis=0), axis=1)
    is_near = distances <= _FAR * np.median(distances)
    if not is_near.all() and plane_of(points[is_near], np.eye(4)) is None:
        raise InputError(
            "{name} looks flat, because {bad} of its {count} vertices are very far away. Delete those vertices, or the "
            "modifier that makes them.",
            name=name,
            bad=int(np.count_nonzero(~is_near)),
            count=len(points),
        )


def refuse_following(wanted: bool) -> None:
    """Raise InputError if a flat morph is to follow animated shapes."""
    if wanted:
        raise InputError("Flat shapes cannot be followed: set Inputs to At Bake Frame.")


def refuse_volumes(wanted: bool) -> None:
    """Raise InputError if volumes are requested for a flat morph."""
    if wanted:
        raise InputError("Flat shapes have no volume; choose another output: objects, a player or a cache.")
