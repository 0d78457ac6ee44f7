# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np

from convwass_addon.geometry.facing_points import FacingPointFinder, FacingShape, OrientedSamples
from tests.applications.maps import subdivided
from tests.shapes import ball, box

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
