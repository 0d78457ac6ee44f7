# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.uv_charts import SharedEdges, chart_labels, uv_sizes
from tests.applications.maps import tube
from tests.shapes import box, torus


@pytest.mark.parametrize("mesh", [box(), torus(segments=(9, 7))])
def test_shared_edges_list_their_ends_in_the_same_order(mesh):
    shared = SharedEdges.of(mesh.faces)
    assert len(shared.faces) == len(mesh.faces) * 3 // 2
    for side in range(2):
        ends = mesh.faces[shared.faces[:, side, None], shared.corners[:, side]]
        np.testing.assert_array_equal(ends, shared.vertices)
    assert (shared.faces[:, 0] != shared.faces[:, 1]).all()
    assert len(np.unique(shared.vertices, axis=0)) == len(shared.vertices)


def test_islands_are_separated_only_where_uvs_differ():
    mesh, uvs, _ = tube(12, 5)
    assert chart_labels(mesh.faces, uvs).max() == 0
    # Move the upper half elsewhere.
    upper = mesh.vertices[mesh.faces][..., 2].mean(axis=1) > 1
    labels = chart_labels(mesh.faces, uvs + upper[:, None, None])
    assert len(np.unique(labels)) == 2
    assert len(np.unique(labels[upper])) == 1
    # Rounding is no seam.
    noise = np.random.default_rng(0).normal(size=uvs.shape) * 1e-8
    assert chart_labels(mesh.faces, uvs + noise).max() == 0


def test_sizes_are_the_largest_stretch_for_any_orientation_of_triangles():
    rng = np.random.default_rng(1)
    flat = rng.normal(size=(50, 3, 2))
    turns = Rotation.random(50, random_state=2).as_matrix()
    corners = np.einsum("nij,nkj->nki", turns, np.concatenate([flat, np.zeros((50, 3, 1))], axis=2))
    stretch = np.array([[3.0, 0.4], [-0.2, 0.5]])
    expected = np.linalg.svd(stretch)[1][0]
    np.testing.assert_allclose(uv_sizes(corners, flat @ stretch.T + 0.7), expected, rtol=1e-6)
    assert not uv_sizes(np.zeros((2, 3, 3)), flat[:2]).any()
