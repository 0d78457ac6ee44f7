# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from convwass_addon.geometry.meshes.facing_points import FacingPointFinder, FacingShape, OrientedSamples
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals
from tests.applications.maps import subdivided
from tests.shapes import ball, box, joined, square

WING = subdivided(subdivided(subdivided(box((1.0, 1.0, 0.02)))))
POINTS = np.array([[0.3, 0.2, 0.004], [-0.1, 0.4, -0.003], [0.0, 0.0, 0.2]])
UP, DOWN = np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.0, -1.0])


def heights(normals):
    finder = FacingPointFinder(WING)
    found = finder.find(POINTS, np.broadcast_to(normals, POINTS.shape))
    places = found.interpolated(WING.corners)
    np.testing.assert_allclose(found.shares.sum(axis=1), 1.0)
    np.testing.assert_allclose(np.linalg.norm(places - POINTS, axis=1), found.distances, atol=1e-12)
    return places


def test_the_side_of_a_wing_with_the_right_normals_is_found():
    for normal, height in ((UP, 0.01), (DOWN, -0.01)):
        places = heights(normal)
        # The last point is too far above to belong to the lower side.
        np.testing.assert_allclose(places[:2, 2], height)
        np.testing.assert_allclose(places[:2, :2], POINTS[:2, :2], atol=1e-9)


@pytest.mark.parametrize("length", [1.0, 0.5])
@pytest.mark.parametrize(("distance", "height"), [(0.45, -0.01), (0.58, 0.01)])
def test_a_turn_by_60_degrees_counts_as_much_as_a_twentieth_of_the_size(distance, height, length):
    """A turn by 180 degrees costs four times the square; the lower side is a fiftieth farther away than the upper one.

    So both sides cost the same at the distance d with (d + 0.02)^2 - d^2 = 4 (0.05^2 area), which is about 0.51.
    """
    assert (4.0 * 0.05**2 * WING.area - 0.02**2) / (2.0 * 0.02) == pytest.approx(0.51, abs=0.02)
    found = FacingPointFinder(WING).find(np.array([[0.1, 0.2, 0.01 + distance]]), length * DOWN[None])
    assert found.interpolated(WING.corners)[0, 2] == pytest.approx(height)


def test_a_near_triangle_that_faces_away_is_better_than_small_ones_far_away():
    """There are more small ones than are measured, and the centers of the large ones are far away."""
    upright = square(0.2).vertices[:, [2, 0, 1]] + (4.9, 4.9, 1.5)
    small = subdivided(subdivided(TriangleMesh(upright, square().faces)))
    assert (triangle_normals(small.corners)[:, 0] > 0.99).all()
    mesh = joined(square(10.0), small)
    found = FacingPointFinder(mesh).find(np.array([[4.9, 4.9, 0.01]]), np.array([[1.0, 0.0, 0.0]]))
    assert found.distances[0] == pytest.approx(0.01)


def test_without_normals_the_closest_point_is_found():
    np.testing.assert_allclose(heights(np.zeros(3))[:, 2], [0.01, -0.01, 0.01])


def test_oriented_samples_lie_on_the_side_with_similar_normals():
    thin = box((1.0, 1.0, 0.01))
    top = thin.vertices[:, 2].max()
    above = np.tile([[0.1, 0.05, top + 0.01]], (2, 1))
    found = OrientedSamples(thin, 0.2).find(above, np.array([[0.0, 0, 1], [0, 0, -1]]))
    np.testing.assert_allclose(found.interpolated(thin.corners)[:, 2], [top, -top], atol=1e-9)
    np.testing.assert_allclose(found.distances, [0.01, 0.01 + 2 * top], atol=1e-9)
    np.testing.assert_allclose(found.shares.sum(axis=1), 1.0)


def test_threads_share_a_finder_that_was_built_before(monkeypatch):
    built, real = [], FacingPointFinder.__init__
    monkeypatch.setattr(FacingPointFinder, "__init__", lambda self, mesh: built.append(mesh) or real(self, mesh))
    shape = FacingShape(ball()).ready()
    with ThreadPoolExecutor(4) as executor:
        assert len({id(finder) for finder in executor.map(lambda _: shape.finder, range(8))}) == 1
    assert len(built) == 1
