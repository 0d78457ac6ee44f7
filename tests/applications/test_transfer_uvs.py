# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.transfer_uvs import transferred_uvs
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.uv_charts import chart_labels, uv_sizes
from tests.applications.maps import exact_map, subdivided, tube, without_points
from tests.shapes import box, joined

TUBE, TUBE_UVS, _ = tube(48, 9)


def edges_of(pairs):
    return {frozenset(map(int, pair)) for pair in pairs}


def test_transfer_to_itself_is_the_identity():
    found = transferred_uvs(exact_map(TUBE.vertices, TUBE), TUBE, TUBE_UVS, TUBE)
    np.testing.assert_allclose(found.uvs, TUBE_UVS, atol=1e-6)
    # The seam runs up the tube where the angle is 0.
    assert edges_of(found.seams) == {frozenset((48 * j, 48 * (j + 1))) for j in range(8)}
    assert not found.notices


@pytest.mark.parametrize(("around", "along", "shift"), [(40, 11, 0.37), (97, 15, 0.4), (12, 4, 0.3), (200, 40, 0.3)])
def test_no_face_reaches_across_the_seam_of_a_tube(around, along, shift):
    """Within half a face of the seam, UVs move to the seam; elsewhere they follow angle and height."""
    receiver, truth, quads = tube(around, along, shift)
    found = transferred_uvs(exact_map(receiver.vertices, TUBE), TUBE, TUBE_UVS, receiver, quads)
    u, v = np.moveaxis(found.uvs, 2, 0)
    assert (np.ptp(u, axis=1) * around).max() < 1.1
    # Between the vertices of a tube, angles differ slightly from linear interpolation on faces.
    np.testing.assert_allclose(v, truth[..., 1], atol=1e-6)
    away = np.abs(truth[..., 0] - np.round(truth[..., 0])) * around > 0.99
    np.testing.assert_allclose(u[away], truth[..., 0][away] % 1.0, atol=2e-3)
    assert len(found.seams) == along - 1
    # Both triangles of a quad have the same UVs at the corners that they share.
    first, second = found.uvs[::2], found.uvs[1::2]
    np.testing.assert_array_equal(first[:, 0], second[:, 0])
    np.testing.assert_array_equal(first[:, 2], second[:, 1])


def unfolded_cube():
    """A cube with many faces whose six sides are separate UV islands, side by side."""
    cube = subdivided(subdivided(subdivided(box())))
    a, b, c = np.moveaxis(cube.corners, 1, 0)
    normals = np.round(np.cross(b - a, c - a) / np.linalg.norm(np.cross(b - a, c - a), axis=1)[:, None])
    axis = np.abs(normals).argmax(axis=1)
    side = 2 * axis + (normals[np.arange(len(axis)), axis] > 0)
    flat = np.stack([cube.corners[i][:, [j for j in range(3) if j != axis[i]]] for i in range(len(axis))]) + 0.5
    uvs = 0.3 * flat + np.stack([0.33 * (side % 3), 0.5 * (side // 3)], axis=1)[:, None]
    return cube, uvs, side


def test_the_islands_of_a_cube_stay_separate_on_finer_and_rotated_cubes():
    cube, uvs, _ = unfolded_cube()
    assert len(np.unique(chart_labels(cube.faces, uvs))) == 6
    for receiver in (subdivided(cube), TriangleMesh(cube.vertices[:, [1, 0, 2]], cube.faces[:, ::-1].copy())):
        found = transferred_uvs(exact_map(receiver.vertices, cube), cube, uvs, receiver)
        sizes = uv_sizes(receiver.corners, found.uvs)
        np.testing.assert_allclose(sizes, 0.3, rtol=1e-4)
        assert len(np.unique(chart_labels(receiver.faces, found.uvs))) == 6
        on_edge = np.isclose(np.abs(receiver.vertices[found.seams]), 0.5).all(axis=1).sum(axis=1)
        assert (on_edge == 2).all()


def test_islands_stay_in_place_where_faces_lie_across_their_seams():
    """A cube turned about its own axis and pulled back onto the islands' one: its faces know nothing of the edges."""
    cube, uvs, _ = unfolded_cube()
    around = subdivided(subdivided(subdivided(subdivided(box(angles=(0.3, 0.5, 0.2))))))
    found = transferred_uvs(exact_map(around.vertices, cube), cube, uvs, around)
    # No triangle reaches from island to island: these are 0.03 and more apart, and 0.3 wide.
    middles = found.uvs.mean(axis=1)
    island = np.floor((middles + 1e-6) / [0.33, 0.5])
    low = found.uvs - island[:, None] * [0.33, 0.5]
    assert low.min() > -1e-6 and low.max() < 0.3 + 1e-6
    labels = chart_labels(around.faces, found.uvs)
    counts = np.bincount(labels)
    assert (counts > 20).sum() == 6
    assert counts[counts <= 20].sum() < 0.02 * len(around.faces)


def test_pieces_without_points_get_no_place():
    both = joined(TUBE, TUBE.moved((9, 0, 0)))
    uvs = np.concatenate([TUBE_UVS, TUBE_UVS])
    lost = np.arange(len(both.vertices)) >= len(TUBE.vertices)
    found = transferred_uvs(without_points(exact_map(both.vertices, both), lost), both, uvs, both)
    np.testing.assert_allclose(found.uvs[: len(TUBE.faces)], TUBE_UVS, atol=1e-6)
    assert not found.uvs[len(TUBE.faces) :].any()
    assert [str(notice) for notice in found.notices] == [
        "768 triangles have no counterpart and are missing from the UV map."
    ]


def test_invalid_input_is_refused():
    own = exact_map(TUBE.vertices, TUBE)
    with pytest.raises(InputError, match="two numbers for every corner"):
        transferred_uvs(own, TUBE, TUBE_UVS[:5], TUBE)
    with pytest.raises(InputError, match="has no area"):
        transferred_uvs(own, TUBE, np.zeros_like(TUBE_UVS), TUBE)
    with pytest.raises(InputError, match="other vertices"):
        transferred_uvs(own, TUBE, TUBE_UVS, box())
    with pytest.raises(InputError, match="compute it again"):
        transferred_uvs(without_points(own, np.ones(len(TUBE.vertices), bool)), TUBE, TUBE_UVS, TUBE)
    # A map of noise folds half of the surface.
    noise = TUBE.vertices[np.random.default_rng(0).permutation(len(TUBE.vertices))]
    with pytest.raises(InputError, match="would be folded"):
        transferred_uvs(exact_map(noise, TUBE), TUBE, TUBE_UVS, TUBE)
