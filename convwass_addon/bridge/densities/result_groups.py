# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write results as vertex groups that a later result may replace, unlike groups painted by the user."""

from __future__ import annotations

import json

import bpy
from numpy.typing import ArrayLike

from ...errors import InputError
from ..vertex_groups import read_group, write_group

RESULTS_KEY = "convwass_results"
"""Custom property of an object: JSON with the names of the groups that hold results."""


def require_unpainted(obj: bpy.types.Object, name: str) -> None:
    """Check that a result may be written to a group: it does not exist, is empty, or holds an earlier result.

    Raises
    ------
    InputError
        The group was painted, or the object is not a mesh.
    """
    if name in obj.vertex_groups and name not in _results(obj) and read_group(obj, name).any():
        raise InputError(
            "{object} already has a painted vertex group {name}; choose another name for the result.",
            object=obj.name,
            name=name,
        )


def write_result(obj: bpy.types.Object, name: str, weights: ArrayLike) -> bpy.types.VertexGroup:
    """Write a group as `write_group` does, and remember that it holds a result.

    Raises
    ------
    InputError
        As for `require_unpainted` and `write_group`; nothing is written then.
    """
    require_unpainted(obj, name)
    group = write_group(obj, name, weights)
    there = [known for known in _results(obj) if known in obj.vertex_groups]
    obj[RESULTS_KEY] = json.dumps(list(dict.fromkeys([*there, name])))
    return group


def _results(obj: bpy.types.Object) -> list[str]:
    """Return the names of the groups that hold results; none if the stored names are damaged."""
    try:
        found = json.loads(obj.get(RESULTS_KEY, "[]"))
    except (TypeError, ValueError, RecursionError):
        return []
    return found if isinstance(found, list) else []
