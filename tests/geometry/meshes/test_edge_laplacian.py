# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Laplacian of a graph is the sum of weighted squared differences along its edges."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edge_laplacian import edge_laplacian
from convwass_addon.geometry.meshes.edges import mesh_edges
from tests.shapes import ball


def test_it_adds_up_squared_differences_along_edges():
    mesh, rng = ball(points=60), np.random.default_rng(4)
    strengths, values = rng.uniform(0.1, 2.0, 60), rng.normal(size=60)
    # A triangle of no area, with a repeated vertex, adds no edge to itself.
    faces = np.concatenate([mesh.faces, [[3, 3, mesh.faces[0, 0]]]])
    tails, heads = mesh_edges(faces).T
    expected = strengths[tails] * strengths[heads] @ np.square(values[tails] - values[heads])
    found = edge_laplacian(faces, strengths)
    assert values @ (found @ values) == pytest.approx(expected)
    np.testing.assert_allclose(found.sum(axis=0), 0.0, atol=1e-12)
