# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.edge_means import EdgeMeans
from tests.shapes import ball


def test_means_at_some_vertices_are_those_at_all_vertices():
    mesh = ball()
    means, random = EdgeMeans.of(mesh), np.random.default_rng(0)
    vertices = random.permutation(len(mesh.vertices))[:40]
    points = random.normal(size=mesh.vertices.shape)
    found = means.mean_points_at(points, vertices)
    np.testing.assert_array_equal(found, means.mean_points(points)[vertices])
    assert not means.mean_points_at(points, vertices[:0]).size
