# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Symmetric motions of symmetric meshes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.one_mesh.mirror_symmetry import MirrorSymmetry
from convwass_addon.errors import InputError
from convwass_addon.geometry.meshes.mirror_planes import MirrorPlane
from tests.shapes import torus

PLANE = MirrorPlane(np.zeros(3), np.array([1.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def vertices():
    # Longer along X than along Y, so that only one plane fits.
    return torus(segments=(24, 12)).vertices * [2.0, 1.0, 1.0] + [0.0, 3.0, 0.0]


def test_vertices_are_paired_and_those_on_the_plane_with_themselves(vertices):
    symmetry = MirrorSymmetry.of(vertices, PLANE, "Ring")
    assert symmetry.has_partner.all()
    np.testing.assert_allclose(vertices[symmetry.partners], vertices * [-1.0, 1.0, 1.0], atol=1e-12)


def test_vertices_that_are_split_along_seams_are_paired(vertices):
    rng = np.random.default_rng(2)
    split = np.concatenate([vertices, vertices[rng.choice(len(vertices), 40, replace=False)]])
    symmetry = MirrorSymmetry.of(split, PLANE, "Ring")
    assert symmetry.has_partner.all()
    np.testing.assert_allclose(split[symmetry.partners], split * [-1.0, 1.0, 1.0], atol=1e-12)
    on_plane = np.abs(split[:, 0]) < 1e-12
    assert on_plane[len(vertices) :].any()
    np.testing.assert_array_equal(symmetry.partners[on_plane], np.flatnonzero(on_plane))
    moved = split + 0.01 * np.sin(3.0 * split)
    found = symmetry.symmetrized(moved)
    nearest = np.argmin(np.linalg.norm(vertices[None] - split[len(vertices) :, None], axis=2), axis=1)
    np.testing.assert_allclose(found[len(vertices) :], found[nearest], atol=1e-12)


def test_the_plane_moves_along_and_noise_becomes_symmetric(vertices):
    symmetry = MirrorSymmetry.of(vertices, PLANE, "Ring")
    turn = Rotation.from_euler("xyz", (0.3, 0.9, 2.0))
    noise = np.random.default_rng(3).normal(scale=0.01, size=vertices.shape)
    shift = np.array([7.0, -2.0, 1.0])
    moved = turn.apply(vertices + noise) + shift
    found = symmetry.symmetrized(moved)
    back = turn.inv().apply(found - shift)
    assert np.abs(back - vertices).max() < 0.04
    plane = symmetry.plane(moved)
    np.testing.assert_allclose(plane.mirrored(found), found[symmetry.partners], atol=1e-12)
    assert abs(turn.apply([1.0, 0.0, 0.0]) @ plane.normal) == pytest.approx(1.0, abs=1e-4)


def test_either_side_is_mirrored_onto_the_other(vertices):
    symmetry = MirrorSymmetry.of(vertices, PLANE, "Ring")
    moved = vertices + np.random.default_rng(3).normal(scale=0.01, size=vertices.shape)
    plane = symmetry.plane(moved)
    on_plane = symmetry.partners == np.arange(len(vertices))
    side = np.sign((vertices - plane.point) @ plane.normal)
    for found, kept in zip(symmetry.mirrored_sides(moved), (1.0, -1.0), strict=True):
        np.testing.assert_allclose(plane.mirrored(found), found[symmetry.partners], atol=1e-12)
        stays = (side == kept) & ~on_plane
        assert stays.any()
        np.testing.assert_array_equal(found[stays], moved[stays])


def test_symmetric_points_stay_where_they_are(vertices):
    symmetry = MirrorSymmetry.of(vertices, PLANE, "Ring")
    np.testing.assert_allclose(symmetry.symmetrized(vertices), vertices, atol=1e-12)


def test_a_mesh_without_mirror_images_is_refused(vertices):
    with pytest.raises(InputError, match="Ring is not symmetric"):
        MirrorSymmetry.of(vertices + np.array([0.5, 0.0, 0.0]), PLANE, "Ring")
