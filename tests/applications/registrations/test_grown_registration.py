# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Limbs that look alike, registered from where bodies coincide."""

from __future__ import annotations

import numpy as np

from convwass_addon.applications.registrations.carriers import carrier_of, coarser
from convwass_addon.applications.registrations.grown_registration import grown_points
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control
from tests.applications.maps import arm
from tests.shapes import ball

NONE = np.empty(0, np.int64)


def carrier(mesh):
    return coarser(carrier_of(mesh, "shape", 2000, Control()), NONE, 500, Control())


def test_a_limb_is_followed_around_its_bend():
    """The straight half of an arm coincides with that of a bent one; from there the elbow leads to the other half."""
    straight, bent = (arm(angle)[0] for angle in (0.0, np.radians(110.0)))
    one, other = carrier(straight), carrier(bent)
    found = grown_points(one, other, Control())
    ends = [int(np.argmin(np.linalg.norm(one.mesh.vertices - (x, 0.0, 0.0), axis=1))) for x in (0.0, 4.0)]
    tips = bent.vertices[[-2, -1]]
    assert np.linalg.norm(straight.vertices[-1] - tips[1]) > 2.0
    np.testing.assert_allclose(found[ends], tips, atol=0.25)
    assert ClosestPointFinder(bent.corners).find(found).distances.max() < 0.1


def test_shapes_that_do_not_coincide_are_left_alone():
    far = ball(1.0, points=400)
    moved = TriangleMesh(far.vertices + np.array([5.0, 0.0, 0.0]), far.faces)
    assert grown_points(carrier(far), carrier(moved), Control()) is None
