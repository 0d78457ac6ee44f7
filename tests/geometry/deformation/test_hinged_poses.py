# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts that rotate relative to each other, and the samples that represent them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.deformation.hinged_poses import HingedPose, hinged_points
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.surface_samples import SurfaceSamples
from convwass_addon.geometry.remeshing.subdivision import with_short_edges
from tests.shapes import box, joined

JOINT = np.array([0.6, 0.0, 0.2])
AXIS = np.array([0.0, 1.0, 0.0])


def fine_box(size, center, edge):
    return with_short_edges(box(size, center), edge, 100_000).mesh


@pytest.fixture(scope="module")
def hinge():
    """A large box and a small one next to it, two components, and the mask of the small one's vertices."""
    mesh = joined(fine_box((1.0, 1.0, 1.0), (0.0, 0.0, 0.0), 0.15), fine_box((0.3, 0.2, 0.2), (0.8, 0.0, 0.2), 0.08))
    return mesh, mesh.vertices[:, 0] > 0.55


def swung(points, angle):
    return Rotation.from_rotvec(angle * AXIS).apply(points - JOINT) + JOINT


def swings(moving, angle):
    """Turns of vertices, some of which swing about the axis."""
    turns = np.zeros((len(moving), 3, 3))
    turns[moving, 1] = angle * AXIS
    return turns


@pytest.mark.parametrize("share", [0.25, 0.5, 1.0])
def test_a_part_rotates_about_the_joint_inferred_from_its_poses(hinge, share):
    """The two parts do not touch; only the end pose of the small one determines its joint."""
    mesh, small = hinge
    angle = np.radians(100.0)
    moved = np.where(small[:, None], swung(mesh.vertices, angle), mesh.vertices)
    samples = SurfaceSamples.of(mesh, 120, 0.4)
    pose = HingedPose.of(samples, mesh.vertices, moved, swings(small, angle))
    found = hinged_points(samples, mesh.vertices, [pose], [share])
    expected = np.where(small[:, None], swung(mesh.vertices, share * angle), mesh.vertices)
    np.testing.assert_allclose(found, expected, atol=5e-3)


def test_parts_at_rest_in_both_poses_stay_at_rest(hinge):
    mesh, small = hinge
    moved = np.where(small[:, None], swung(mesh.vertices, 2.0), mesh.vertices)
    samples = SurfaceSamples.of(mesh, 120, 0.4)
    pose = HingedPose.of(samples, mesh.vertices, moved, swings(small, 2.0))
    found = hinged_points(samples, mesh.vertices, [pose], [0.5])
    apart = np.linalg.norm(found - mesh.vertices, axis=1)
    assert apart[~small].max() < 2e-3
    assert apart[small].min() > 0.04


def test_samples_see_each_other_only_through_the_solid():
    """The ends of a bar bent to three quarters of a circle do not."""
    bar = fine_box((0.1, 0.1, 1.0), (0.0, 0.0, 0.0), 0.05)
    turn, radius = 1.5 * np.pi * bar.vertices[:, 2], 1.0 / (1.5 * np.pi) + bar.vertices[:, 0]
    bent = TriangleMesh(np.stack([radius * np.cos(turn), bar.vertices[:, 1], radius * np.sin(turn)], axis=1), bar.faces)
    samples = SurfaceSamples.of(bent, 100, 1.0)
    along = bar.vertices[samples.seeds][samples.pairs][:, :, 2]
    assert np.abs(along[:, 0] - along[:, 1]).max() < 0.5
    assert len(samples.pairs) > 5 * len(samples.seeds)
    np.testing.assert_allclose(np.asarray(samples.blend.sum(axis=1)).ravel(), 1.0)
    assert samples.areas.sum() == pytest.approx(bent.area)


def test_a_pose_counts_as_much_as_two_equal_ones_of_half_its_share(hinge):
    mesh, small = hinge
    moved = np.where(small[:, None], swung(mesh.vertices, 1.0), mesh.vertices)
    samples = SurfaceSamples.of(mesh, 120, 0.4)
    pose = HingedPose.of(samples, mesh.vertices, moved, swings(small, 1.0))
    one, both = (hinged_points(samples, mesh.vertices, [pose] * n, [0.6 / n] * n) for n in (1, 2))
    np.testing.assert_allclose(one, both, atol=1e-6)
