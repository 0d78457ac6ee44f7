# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write results as vertex groups that a later result may replace, unlike groups painted by the user."""

from __future__ import annotations

import hashlib
import json

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..stored_json import table_stored_with
from ..vertex_groups import read_group, write_group

RESULTS_KEY = "convwass_results"
"""Custom property of an object: JSON with a digest of the weights of every result, by the name of its group."""


def require_unpainted(obj: bpy.types.Object, name: str) -> None:
    """Check that a result may be written to a group: it does not exist, is empty, or holds an earlier result.

    Raises
    ------
    InputError
        The group was painted, also over an earlier result, or the object is not a mesh.
    """
    if name not in obj.vertex_groups:
        return
    weights = read_group(obj, name)
    if weights.any() and table_stored_with(obj, RESULTS_KEY).get(name) != _digest(weights):
        raise InputError(
            "{object} already has a vertex group {name} that is no result, or was changed since; choose another name, "
            "or delete the group.",
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
    return replace_by_result(obj, name, weights)


def replace_by_result(obj: bpy.types.Object, name: str, weights: ArrayLike) -> bpy.types.VertexGroup:
    """Write a group as `write_result` does, whatever it holds.

    Raises
    ------
    InputError
        As for `write_group`.
    """
    group = write_group(obj, name, weights)
    before = table_stored_with(obj, RESULTS_KEY)
    kept = {known: digest for known, digest in before.items() if known in obj.vertex_groups}
    obj[RESULTS_KEY] = json.dumps({**kept, name: _digest(read_group(obj, name))})
    return group


def _digest(weights: NDArray[np.float64]) -> str:
    return hashlib.sha256(weights.astype("<f4").tobytes()).hexdigest()
