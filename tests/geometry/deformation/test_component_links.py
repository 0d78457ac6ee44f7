# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Links between nearby components."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.deformation.component_links import component_links
from convwass_addon.geometry.meshes.edges import vertex_components
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control
from tests.shapes import ball, joined


def test_one_component_needs_no_links():
    assert not len(component_links(ball(points=50), Control()).ends)


def test_only_nearby_components_are_linked():
    mesh = joined(ball(points=300), ball(0.1, (0.0, 0.0, 1.15), points=30), ball(0.1, (0.0, 9.0, 0.0), points=30))
    links = component_links(mesh, Control())
    labels = vertex_components(mesh)[links.ends]
    assert {tuple(sorted(pair)) for pair in labels.tolist()} == {(0, 1)}
    lengths = np.linalg.norm(mesh.vertices[links.ends[:, 0]] - mesh.vertices[links.ends[:, 1]], axis=1)
    assert lengths.max() < 0.25
    assert (links.weights > 0).all()


def test_large_components_are_linked_like_small_ones():
    mesh = joined(ball(points=300), ball(0.9, (0.0, 0.0, 1.95), points=250))
    links = component_links(mesh, Control())
    assert 2 <= len(links.ends) <= 8
    assert (np.sort(vertex_components(mesh)[links.ends], axis=1) == (0, 1)).all()


def test_unused_vertices_are_linked_to_nearby_components():
    mesh = ball(points=300)
    loose = TriangleMesh(np.concatenate([mesh.vertices, [[0.0, 0.0, 1.02]]]), mesh.faces)
    links = component_links(loose, Control())
    np.testing.assert_array_equal(links.ends[:, 0], [300])


def test_it_can_be_cancelled():
    control = Control()
    control.cancel()
    with pytest.raises(Cancelled):
        component_links(joined(ball(points=30), ball(points=30, center=(2.1, 0, 0))), control)
