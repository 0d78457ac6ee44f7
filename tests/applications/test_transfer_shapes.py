# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.soft_maps.transfer_shapes import ShapeCarrier
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from tests.applications.maps import arm, exact_map, subdivided, turn, without_points
from tests.shapes import box, joined, torus

ARM, _ = arm()
IDENTITY = exact_map(ARM.vertices, ARM)
LENGTH = 4.0


def bulge(mesh, center=3.3, reach=0.5):
    """A bump on one side of the arm near its end; no displacement elsewhere."""
    near = np.clip(1 - np.abs(mesh.vertices[:, 0] - center) / reach, 0, None)
    return np.where(mesh.vertices[:, 1:2] > 0.05, near[:, None] * np.array([0.05, 0.3, 0.1]), 0.0)


def carried(points, giver, key, receiver):
    return ShapeCarrier.of(points, giver, receiver).carried(key)


def relative(found, expected):
    return np.linalg.norm(found - expected) / np.linalg.norm(expected)


def test_transfer_to_itself_is_the_identity():
    keys = np.stack([bulge(ARM), bulge(ARM, 1.0), np.zeros_like(ARM.vertices)])
    carrier = ShapeCarrier.of(IDENTITY, ARM, ARM)
    found = np.stack([carrier.carried(key) for key in keys])
    np.testing.assert_allclose(found, keys, atol=1e-6)
    assert not found[2].any()
    # Vertices without displacement stay exactly in place.
    assert not found[0][~keys[0].any(axis=1)].any()


def test_offsets_are_rotated_and_scaled_with_the_mesh():
    rotation = turn()
    moved = TriangleMesh(2.5 * ARM.vertices @ rotation.T + [7, 8, 9], ARM.faces)
    found = carried(IDENTITY, ARM, bulge(ARM), moved)
    np.testing.assert_allclose(found, 2.5 * bulge(ARM) @ rotation.T, atol=1e-6)


def test_a_mirror_image_gets_the_mirror_image():
    flip = np.array([1.0, 1.0, -1.0])
    image = TriangleMesh(ARM.vertices * flip, ARM.faces[:, ::-1].copy())
    found = carried(IDENTITY, ARM, bulge(ARM), image)
    np.testing.assert_allclose(found, bulge(ARM) * flip, atol=1e-6)


@pytest.mark.parametrize("angle", [0.6, 1.5])
def test_on_a_bent_arm_a_bump_points_where_the_arm_does(angle):
    """Plain offsets would keep the old direction, an error of most of their length."""
    bent, _ = arm(angle)
    key = bulge(ARM)
    cosine, sine = np.cos(angle), np.sin(angle)
    expected = key @ np.array([[cosine, -sine, 0], [sine, cosine, 0], [0, 0, 1]]).T
    found = carried(IDENTITY, ARM, key, bent)
    assert relative(found, expected) < 0.02
    assert relative(key, expected) > 0.9 * 2 * np.sin(angle / 2) * 0.9


def test_a_longer_arm_bends_as_a_whole():
    """The hand of an arm of twice the length moves twice as far, and the arm keeps its width; offsets cannot."""
    key = arm(0.8)[0].vertices - ARM.vertices
    stretched = TriangleMesh(ARM.vertices * [2.0, 1.0, 1.0], ARM.faces)
    found = carried(IDENTITY, ARM, key, stretched)
    after = stretched.vertices + found
    rings = after[:-2].reshape(40, 16, 3)
    widths = np.linalg.norm(rings[:, 0] - rings[:, 8], axis=1)
    np.testing.assert_allclose(widths, 0.6, rtol=0.05)
    middles = rings.mean(axis=1)
    lengths = np.linalg.norm(np.diff(middles, axis=0), axis=1)
    np.testing.assert_allclose(lengths, 2 * LENGTH / 39, rtol=0.05)
    first, last = middles[5] - middles[0], middles[-1] - middles[-6]
    angle = np.arccos(first @ last / np.linalg.norm(first) / np.linalg.norm(last))
    assert angle == pytest.approx(0.8, abs=0.05)


def test_a_finer_mesh_gets_the_offsets_interpolated_on_triangles():
    finer = subdivided(ARM)
    points = exact_map(finer.vertices, ARM)
    found = carried(points, ARM, bulge(ARM), finer)
    assert relative(found, points.at(ARM, bulge(ARM))) < 1e-3


def test_a_component_without_points_stays_and_a_translated_one_moves():
    pair = joined(ARM, torus(center=(0, 5, 0), segments=(24, 12)))
    count = len(ARM.vertices)
    key = np.zeros_like(pair.vertices)
    key[count:] = (0.0, 0.5, 0.25)
    points = exact_map(pair.vertices, pair)
    found = carried(points, pair, key, pair)
    np.testing.assert_allclose(found, key, atol=1e-6)
    lost = np.arange(len(key)) >= count
    found = carried(without_points(points, lost), pair, key + 1.0, pair)
    assert not found[lost].any()
    np.testing.assert_allclose(found[~lost], 1.0, atol=1e-6)


def test_degenerate_triangles_and_loose_vertices_are_tolerated():
    flat = np.array([[0, 0, 0], [0, 0, 0], [3, 0, 0]], float)
    faces = np.concatenate([ARM.faces, [[len(ARM.vertices) + i for i in range(3)]], [[5, 5, 9]]])
    odd = TriangleMesh.from_arrays(np.concatenate([ARM.vertices, flat, [[9, 9, 9]]]), faces)
    points = exact_map(odd.vertices, odd)
    key = np.concatenate([bulge(ARM), np.zeros((4, 3))])
    found = carried(points, odd, key, odd)
    assert np.isfinite(found).all()
    assert relative(found, key) < 0.02


def test_invalid_input_is_refused():
    for key in (bulge(ARM)[:, :2], bulge(ARM)[:5], np.full(ARM.vertices.shape, np.nan)):
        with pytest.raises(InputError, match="three numbers"):
            carried(IDENTITY, ARM, key, ARM)
    with pytest.raises(InputError, match="other vertices"):
        ShapeCarrier.of(IDENTITY, ARM, box())
    with pytest.raises(InputError, match="more faces"):
        ShapeCarrier.of(IDENTITY, box(), ARM)
