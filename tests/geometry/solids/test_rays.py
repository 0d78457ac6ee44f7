# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lines cross triangles where barycentric coordinates say, and no closed mesh has a gap."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.solids.rays import crossings
from tests.shapes import ball


def test_crossings_are_those_of_barycentric_coordinates():
    corners = np.random.default_rng(3).uniform(0.0, 9.0, (40, 3, 3))
    wanted = []
    for a, b, c in corners:
        for x, y in np.ndindex(10, 10):
            one, other = np.linalg.solve(np.stack([(b - a)[:2], (c - a)[:2]], axis=1), (x, y) - a[:2])
            if one > 0 and other > 0 and one + other < 1:
                enters = np.cross(b - a, c - a)[2] < 0
                wanted.append((x, y, a[2] + one * (b - a)[2] + other * (c - a)[2], 1 if enters else -1))
    (found,) = crossings(corners)
    got = np.stack([found.column, found.row, found.height, found.sign], axis=1)
    wanted = np.array(wanted)
    np.testing.assert_allclose(got[np.lexsort(got.T)], wanted[np.lexsort(wanted.T)], atol=1e-9)


def test_a_closed_mesh_has_no_gaps_where_edges_meet_lines():
    # Vertices on the lines, and faces that are seen edge on.
    mesh = ball(6.0, (8.0, 8.0, 8.0), points=300)
    corners = np.round(mesh.corners * 2.0) / 2.0
    (found,) = crossings(corners)
    total = np.zeros((17, 17), np.int64)
    np.add.at(total, (found.column, found.row), found.sign)
    assert len(found.sign) > 200
    assert not total.any()
