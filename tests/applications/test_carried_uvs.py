# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""UV maps are exact if a blend coincides with its shape, and no triangle extends across a seam."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.morphs.carried_uvs import UvMap, home_triangles
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.uv_charts import chart_labels, uv_sizes
from tests.applications.maps import subdivided, tube
from tests.shapes import ball, box


def carried(uv_map, mesh, labels=None, **more):
    """Return the UVs of a blend that coincides with its shape."""
    finder = ClosestPointFinder(uv_map.corners)
    places = finder.find_about(mesh.vertices)
    labels = uv_map.charts if labels is None else labels
    homes = home_triangles(finder, labels, places, mesh.faces, mesh.vertices, **more)
    return uv_map.at(places, mesh.faces, mesh.vertices, homes)


def map_of(mesh, uvs, repeats=False):
    return UvMap(mesh.corners, mesh.faces, np.asarray(uvs, np.float64), repeats)


def six_islands(mesh):
    """UVs of a unit cube with one island per side, 0.3 wide and at least 0.03 apart, and the side of each triangle."""
    normals = np.cross(mesh.corners[:, 1] - mesh.corners[:, 0], mesh.corners[:, 2] - mesh.corners[:, 0])
    axis = np.abs(normals).argmax(axis=1)
    side = 2 * axis + (np.take_along_axis(normals, axis[:, None], 1)[:, 0] > 0)
    kept = np.array([[1, 2], [0, 2], [0, 1]])[axis]
    flat = np.take_along_axis(mesh.corners, np.broadcast_to(kept[:, None], (len(axis), 3, 2)), 2) + 0.5
    return 0.3 * flat + np.stack([0.33 * (side % 3), 0.5 * (side // 3)], axis=1)[:, None], side


def test_a_refined_shape_has_its_own_uvs():
    """Also of islands that meet at every edge, whose vertices belong to any of their triangles."""
    mesh = box(center=(3.0, 2.0, 5.0))
    centered = TriangleMesh(mesh.vertices - (3.0, 2.0, 5.0), mesh.faces)
    uvs, _ = six_islands(centered)
    assert len(np.unique(chart_labels(mesh.faces, uvs))) == 6
    fine = subdivided(subdivided(subdivided(mesh)))
    expected, _ = six_islands(TriangleMesh(fine.vertices - (3.0, 2.0, 5.0), fine.faces))
    np.testing.assert_allclose(carried(map_of(mesh, uvs), fine), expected, atol=1e-6)


def test_triangles_across_the_edges_of_islands_belong_to_one_of_them():
    """The blend is the surface of a cube with other triangles, which cross the edges of the cube."""
    cube = box()
    uvs, _ = six_islands(cube)
    sphere = ball(points=3000)
    blend = TriangleMesh(0.5 * sphere.vertices / np.abs(sphere.vertices).max(axis=1)[:, None], sphere.faces)
    found = carried(map_of(cube, uvs), blend)
    island = np.floor((found.mean(axis=1) + 0.01) / (0.33, 0.5))
    inside = found - (island * (0.33, 0.5))[:, None]
    # The margin of the texture is less than half of the gap between islands.
    assert inside.min() > -0.0051
    assert inside.max() < 0.3051
    within = np.isclose(np.abs(blend.corners), 0.5).all(axis=1).any(axis=1)
    np.testing.assert_allclose(uv_sizes(blend.corners, found)[within], 0.3, rtol=1e-4)


@pytest.mark.parametrize("repeats", [True, False])
def test_the_seam_of_a_tube(repeats):
    """Where the texture repeats, nothing is to be seen of the seam; elsewhere triangles end close to it."""
    mesh, uvs, _ = tube(48, 9)
    blend, truth, _ = tube(96, 17, shift=0.7)
    found = carried(map_of(mesh, uvs, repeats), blend)
    # Points between the vertices of a tube, on its chords, differ in angle from those of a circle by up to a tenth of
    # a degree.
    off = found - truth
    assert np.abs(off[..., 1]).max() < 1e-6
    off[..., 0] -= np.rint(off[..., 0].mean(axis=1, keepdims=True))
    across = np.floor(truth[..., 0].max(axis=1) - 1e-9) > np.floor(truth[..., 0].min(axis=1))
    assert across.sum() == 32
    assert np.abs(off[~across, :, 0]).max() < 5e-4
    assert np.abs(off[across, :, 0]).max() < (5e-4 if repeats else 1 / 96)
    assert np.ptp(found[..., 0], axis=1).max() < 1.1 / 96


def test_the_triangles_of_a_quad_have_the_same_uvs_at_their_shared_corners():
    mesh, uvs, _ = tube(48, 9)
    blend, _, quads = tube(50, 11, shift=0.5)
    homes = ClosestPointFinder(mesh.corners).find_about(blend.corners.mean(axis=1)).triangles
    found = carried(map_of(mesh, uvs), blend, known=homes, owners=quads)
    np.testing.assert_allclose(found[::2, 0], found[1::2, 0], atol=1e-6)
    np.testing.assert_allclose(found[::2, 2], found[1::2, 1], atol=1e-6)


def test_known_homes_are_kept():
    """A triangle on the edge of two islands is on that of its home."""
    cube = box()
    uvs, side = six_islands(cube)
    edge = TriangleMesh.from_arrays([(0.5, 0.0, 0.5), (0.5, 0.1, 0.5), (0.5, 0.0, 0.4)], [(0, 1, 2)])
    for wanted in (5, 1):
        (home,) = np.flatnonzero(side == wanted)[:1]
        found = carried(map_of(cube, uvs), edge, known=np.array([home]))
        assert np.floor((found[0, 0] - 1e-3) / (0.33, 0.5)) @ (1, 3) == wanted
