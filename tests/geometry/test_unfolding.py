# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Folds of a mesh on a surface are removed."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.closest_points import ClosestPointFinder
from convwass_addon.geometry.fold_finder import FoldFinder
from convwass_addon.geometry.unfolding import unfolded
from tests.shapes import ball


@pytest.fixture(scope="module")
def target():
    return ball(points=1500)


def test_a_flipped_patch_is_unfolded(target):
    """Mirroring the angle of every vertex around the pole flips a patch and leaves a ring of folds."""
    mesh = ball(points=600)
    folded = mesh.vertices.copy()
    near = folded[:, 2] > 0.9
    folded[near, :2] *= -1.0
    folded[near, 0] *= -1.0
    finder = FoldFinder.of(mesh, target)
    assert finder.folded(folded).sum() > 10
    found = unfolded(finder, folded)
    assert not finder.folded(found).any()
    assert ClosestPointFinder(target.corners).find(found).distances.max() < 0.01
    covered = ClosestPointFinder(found[mesh.faces]).find(target.vertices).distances
    assert covered.max() < 0.05
    far = mesh.vertices[:, 2] < 0.0
    np.testing.assert_array_equal(found[far], folded[far])


def test_a_mesh_without_folds_is_unchanged(target):
    mesh = ball(points=600)
    assert unfolded(FoldFinder.of(mesh, target), mesh.vertices) is mesh.vertices
