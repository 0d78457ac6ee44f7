# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Folds of a mesh on a surface are removed."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.errors import Cancelled
from convwass_addon.geometry.deformation.fold_finder import FoldFinder
from convwass_addon.geometry.deformation.unfolding import unfolded
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, Control, drained
from convwass_addon.sentence import Sentence
from tests.shapes import ball

MESSAGE = Sentence("Unfolding")


@pytest.fixture(scope="module")
def target():
    return ball(points=1500)


def flipped_patch(mesh):
    """Mirroring the angle of every vertex around the pole flips a patch and leaves a ring of folds."""
    folded = mesh.vertices.copy()
    near = folded[:, 2] > 0.9
    folded[near, :2] *= -1.0
    folded[near, 0] *= -1.0
    return folded


def test_a_flipped_patch_is_unfolded(target):
    mesh = ball(points=600)
    folded, finder = flipped_patch(mesh), FoldFinder.of(mesh, target)
    assert finder.folded(folded).sum() > 10
    found = drained(unfolded(finder, folded, MESSAGE, UNINTERRUPTED))
    assert not finder.folded(found).any()
    assert ClosestPointFinder(target.corners).find(found).distances.max() < 0.01
    covered = ClosestPointFinder(found[mesh.faces]).find(target.vertices).distances
    assert covered.max() < 0.05
    far = mesh.vertices[:, 2] < 0.0
    np.testing.assert_array_equal(found[far], folded[far])


def test_a_mesh_without_folds_is_unchanged(target):
    mesh = ball(points=600)
    work = unfolded(FoldFinder.of(mesh, target), mesh.vertices, MESSAGE, UNINTERRUPTED)
    assert drained(work) is mesh.vertices


def test_unfolding_reports_its_progress_and_can_be_cancelled(target):
    mesh, control = ball(points=600), Control()
    finder = FoldFinder.of(mesh, target)
    both = -flipped_patch(TriangleMesh(-flipped_patch(mesh), mesh.faces))
    begin, found, halfway = (report.fraction for report in unfolded(finder, both, MESSAGE, control))
    assert 0.0 == begin < found < halfway < 1.0
    work = unfolded(finder, both, MESSAGE, control)
    next(work), next(work)
    control.cancel()
    with pytest.raises(Cancelled):
        next(work)
