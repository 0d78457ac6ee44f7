# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.edges import topology
from convwass_addon.geometry.mesh import TriangleMesh
from convwass_addon.geometry.short_edges import with_short_edges
from tests.shapes import ball, box, square, torus


def longest_edge(mesh):
    return np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2).max()


@pytest.mark.parametrize("longest", [1.2, 0.7, 0.13])
@pytest.mark.parametrize("shape", [box((1.0, 2.0, 0.4)), torus(segments=(12, 8)), ball(points=60)])
def test_the_surface_stays(shape, longest):
    split = with_short_edges(shape, longest)
    assert longest_edge(split) <= longest
    np.testing.assert_array_equal(split.vertices[: len(shape.vertices)], shape.vertices)
    found, expected = topology(split), topology(shape)
    assert (found.euler, found.closed) == (expected.euler, expected.closed)
    assert split.area == pytest.approx(shape.area)
    assert split.volume == pytest.approx(shape.volume)
    assert np.unique(split.faces).size == len(split.vertices)


def test_only_long_edges_are_split():
    strip = TriangleMesh.from_arrays([(0, 0, 0), (4, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2), (0, 2, 3)])
    split = with_short_edges(strip, 2.1)
    assert len(split.vertices) == 6
    assert (split.faces == 3).any(axis=1).sum() == 1
    assert with_short_edges(strip, 5.0) is strip


@pytest.mark.parametrize("shape", [square(), box()])
def test_every_number_of_split_edges_occurs_without_gaps(shape):
    stretched = TriangleMesh(shape.vertices * (1.0, 1.7, 2.9), shape.faces)
    for longest in np.linspace(0.3, 3.0, 14):
        split = with_short_edges(stretched, longest)
        assert topology(split).open_edges == 0 or shape.faces.shape[0] == 2
        assert split.area == pytest.approx(stretched.area)


def test_triangles_are_limited():
    assert len(with_short_edges(box(), 1e-3, most_faces=1000).faces) <= 1000
