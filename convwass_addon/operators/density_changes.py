# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether the groups and the mesh of a density have changed since it was made."""

from __future__ import annotations

import math

import bpy

from ..bridge.densities.density_request import marks_of
from ..bridge.densities.density_store import StoredDensity
from ..bridge.vertex_groups import read_groups

# Weights are stored in single precision.
_SAME = 1e-6


def lost_inputs(obj: bpy.types.Object, stored: StoredDensity) -> list[str]:
    """Return the names of missing groups, and the object's name if the number of vertices or faces has changed.

    Fast enough for a panel.
    """
    lost = [name for name in dict.fromkeys(stored.inputs) if name not in obj.vertex_groups]
    counts = [len(obj.data.vertices), len(obj.data.polygons)]
    return lost + [obj.name] * (stored.settings.get("mesh", counts) != counts)


def changed_inputs(obj: bpy.types.Object, stored: StoredDensity) -> list[str]:
    """Like `lost_inputs`, with the groups that were painted since."""
    lost, marks = lost_inputs(obj, stored), stored.settings.get("marks")
    if lost or not isinstance(marks, list) or len(marks) != len(stored.inputs):
        return lost
    now = marks_of(obj, read_groups(obj, stored.inputs))["marks"]
    pairs = zip(stored.inputs, marks, now, strict=True)
    return list(dict.fromkeys(name for name, before, after in pairs if not _is_close(before, after)))


def _is_close(before: object, after: float) -> bool:
    is_number = isinstance(before, (int, float)) and not isinstance(before, bool)
    return is_number and math.isclose(before, after, rel_tol=_SAME, abs_tol=_SAME)
