# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Components that touch: those that pass through each other or lie side by side, not those that are apart."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.meshes.edges import vertex_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.touching_components import touching_components
from tests.shapes import ball, box, joined

# A box with a ball on its top, another box beside it, a box through both, and one that is apart.
SCENE = joined(
    box((2.0, 2.0, 2.0)),
    ball(0.5, (0.0, 0.0, 1.2), 60),
    box((1.0, 1.0, 1.0), (1.51, 0.0, 0.0)),
    box((4.0, 0.2, 0.2)),
    box((1.0, 1.0, 1.0), (0.0, 0.0, -2.0)),
)
TOUCHING = [[0, 1], [0, 2], [0, 3], [2, 3]]


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_pairs_that_meet_are_found_at_any_scale(scale):
    mesh = TriangleMesh(scale * SCENE.vertices, SCENE.faces)
    assert touching_components(mesh, vertex_components(mesh)).tolist() == TOUCHING


def test_vertices_without_triangles_touch_nothing():
    mesh = TriangleMesh(np.concatenate([SCENE.vertices, SCENE.vertices[:3]]), SCENE.faces)
    assert touching_components(mesh, vertex_components(mesh)).tolist() == TOUCHING


def test_a_single_component_touches_none():
    mesh = ball(points=60)
    assert touching_components(mesh, vertex_components(mesh)).shape == (0, 2)
