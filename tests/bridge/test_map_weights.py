# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How many groups a vertex is in, what their weights sum to, and what locked ones leave."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra.numpy import arrays

from convwass_addon.bridge.soft_maps.map_weights import deforming_groups, fitted_weights
from convwass_addon.bridge.soft_maps.soft_map_requests import TransferRequest

NONE = np.zeros((0, 1))


def fitted(weights, total=None, fixed=NONE, **rules):
    column = np.array(weights, float)[:, None]
    sums = column.sum(axis=0) if total is None else np.array([total])
    return fitted_weights(column, sums, np.array(fixed, float).reshape(-1, 1), TransferRequest(**rules))[:, 0]


@pytest.mark.parametrize(
    ("weights", "arguments", "expected"),
    [
        ([0.5, 0.3], {"normalize": False, "limit": 0}, [0.5, 0.3]),
        ([0.5, 0.3], {}, [0.625, 0.375]),
        ([0.5, 0.3, 0.2], {"limit": 2}, [0.625, 0.375, 0.0]),
        # Without normalizing, removed weights go to the remaining groups.
        ([0.4, 0.2, 0.2], {"limit": 2, "normalize": False}, [0.8 * 2 / 3, 0.8 / 3, 0.0]),
        # A subset of the groups keeps its fraction of 1.
        ([0.2], {"total": 0.8}, [0.25]),
        # Locked groups count, and leave the rest.
        ([0.5, 0.5], {"fixed": [0.4]}, [0.3, 0.3]),
        ([0.6, 0.4], {"fixed": [0.4], "limit": 2}, [0.6, 0.0]),
        ([0.6, 0.4], {"fixed": [0.5, 0.5], "limit": 2}, [0.0, 0.0]),
        ([0.6, 0.4], {"fixed": [1.5]}, [0.0, 0.0]),
        ([0.0, 0.0], {}, [0.0, 0.0]),
        ([1.0, 1e-6], {}, [1.0, 0.0]),
    ],
)
def test_known_answers(weights, arguments, expected):
    np.testing.assert_allclose(fitted(weights, **arguments), expected, atol=1e-12)


VALUES = st.floats(0.0, 1.0)


@given(
    arrays(float, (6, 3), elements=VALUES),
    arrays(float, (2, 3), elements=st.floats(0.0, 0.5)),
    st.integers(0, 8),
    st.booleans(),
)
def test_the_rules_hold(weights, fixed, limit, normalize):
    total = weights.sum(axis=0)
    found = fitted_weights(weights, total, fixed, TransferRequest(limit=limit, normalize=normalize))
    assert ((found >= 0) & (found <= 1)).all()
    if limit:
        assert ((found > 0).sum(axis=0) <= np.maximum(limit - (fixed > 0).sum(axis=0), 0)).all()
    assert (found[weights == 0] == 0).all()
    if normalize:
        assert ((found.sum(axis=0) + fixed.sum(axis=0)) <= 1 + 1e-9).all()
        some = found.sum(axis=0) > 0
        np.testing.assert_allclose((found.sum(axis=0) + fixed.sum(axis=0))[some], 1.0, atol=1e-2)


def test_which_groups_deform():
    import bpy

    objects = [bpy.data.objects.new(name, bpy.data.meshes.new(name)) for name in ("Giver", "Receiver")]
    whole, part = np.array([[0.25, 1.0], [0.75, 0.0]]), np.array([[0.25, 1.0], [0.5, 0.0]])
    assert deforming_groups(*objects, ["A", "B"], whole) == {"A", "B"}
    assert deforming_groups(*objects, ["A", "B"], part) == set()
    assert deforming_groups(*objects, [], np.zeros((0, 2))) == set()
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    for name in ("B", "C", "Control"):
        armature.data.edit_bones.new(name).tail = (0, 0, 1)
    armature.data.edit_bones["Control"].use_deform = False
    bpy.ops.object.mode_set(mode="OBJECT")
    for obj in objects:
        obj.modifiers.new("Armature", "ARMATURE").object = armature
        assert deforming_groups(*objects, ["A", "B", "Control"], np.tile(whole, (2, 1))[:3]) == {"B"}
        obj.modifiers.clear()
