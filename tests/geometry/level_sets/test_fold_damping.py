# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacements that would turn triangles over are reduced, others are unchanged."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.level_sets.fold_damping import without_folds
from convwass_addon.geometry.meshes.edge_means import EdgeMeans
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals

SIDE = 11
CENTER = SIDE * SIDE // 2


@pytest.fixture(scope="module")
def sheet() -> TriangleMesh:
    """A flat sheet of unit squares, each split in two."""
    x, y = np.meshgrid(np.arange(SIDE), np.arange(SIDE), indexing="ij")
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    faces = [(corner, corner + SIDE, corner + SIDE + 1), (corner, corner + SIDE + 1, corner + 1)]
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return TriangleMesh.from_arrays(points, np.concatenate([np.stack(face, axis=1) for face in faces]))


def reduced(sheet, offsets):
    normals = np.tile([0.0, 0.0, 1.0], (len(sheet.vertices), 1))
    return without_folds(sheet, normals, offsets, EdgeMeans.of(sheet))


def test_offsets_without_folds_are_unchanged(sheet):
    offsets = 0.2 * np.random.default_rng(1).standard_normal((len(sheet.vertices), 3)) * [0, 0, 1]
    np.testing.assert_array_equal(reduced(sheet, offsets), offsets)


def test_a_vertex_that_would_leave_its_neighbors_moves_between_them(sheet):
    offsets = np.tile([0.0, 0.0, 0.3], (len(sheet.vertices), 1))
    offsets[CENTER] += (2.4, 0.0, 0.0)
    found = reduced(sheet, offsets)
    assert triangle_normals((sheet.vertices + found)[sheet.faces])[:, 2].min() > 0.0
    np.testing.assert_allclose(found[CENTER], [0.0, 0.0, 0.3], atol=0.1)


def test_offsets_are_reduced_where_all_neighbors_are_folded(sheet):
    """Averaging neighbors cannot repair a sheet folded over along a line."""
    offsets = np.zeros_like(sheet.vertices)
    offsets[sheet.vertices[:, 0] > 5.5, 0] = -8.0
    found = reduced(sheet, offsets)
    assert triangle_normals((sheet.vertices + found)[sheet.faces])[:, 2].min() > 0.0
    assert np.abs(found).max() < 8.0


def test_existing_folds_are_ignored(sheet):
    folded = sheet.vertices.copy()
    folded[CENTER, 0] += 1.5
    offsets = np.tile([0.1, 0.2, 0.3], (len(folded), 1))
    np.testing.assert_array_equal(reduced(TriangleMesh(folded, sheet.faces), offsets), offsets)
