# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes that follow coarser meshes."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.progress import UNINTERRUPTED
from tests.shapes import ball, joined


def test_a_shape_turns_and_stretches_as_its_coarser_mesh():
    """Two balls, each by a linear map of its own; means of the coarser vertices would cut off what bulges."""
    shape = joined(ball(points=500), ball(center=(3.0, 0.0, 0.0), points=500))
    carrier = carrier_of(shape, "balls", 150, UNINTERRUPTED)
    assert len(carrier.mesh.vertices) < 200
    maps = np.stack([Rotation.from_rotvec([0.5, -1.2, 0.3]).as_matrix(), np.diag([2.0, 1.0, 0.5])])

    def maps_at(points):
        return maps[(points[:, 0] > 1.5).astype(int)]

    def mapped(points):
        return np.einsum("nij,nj->ni", maps_at(points), points)

    carried = carrier.carried(mapped(carrier.mesh.vertices), maps_at(carrier.mesh.corners.mean(axis=1)))
    np.testing.assert_allclose(carried, mapped(shape.vertices), atol=1e-12)
