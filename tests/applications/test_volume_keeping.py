# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The volume of one mesh on its way to another shape."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.one_mesh.refined_samples import RefinedPath
from convwass_addon.applications.one_mesh.volume_keeping import (
    Growth,
    has_volume,
    thickened,
    with_even_volume,
)
from convwass_addon.applications.one_mesh.volume_on_pieces import KeepVolume
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from convwass_addon.sentence import Sentence
from tests.shapes import ball, square, torus

MESSAGE = Sentence("Evening out")


def test_a_growing_ball_stays_on_the_ground_and_gains_volume_evenly():
    small, large = ball(1.0, (2.0, 0.0, 1.0), points=300), ball(3.0, (5.0, 0.0, 3.0), points=300)
    growth = Growth.between(small, large)
    assert growth.scale == pytest.approx(3.0)
    for t in (0.25, 0.5, 0.75):
        grown = TriangleMesh(growth.evenly_in_volume((1 - t) * small.vertices + t * large.vertices, t), small.faces)
        assert grown.volume == pytest.approx((1.0 - t) * small.volume + t * large.volume)
        assert grown.bounds[0, 2] == pytest.approx(0.0, abs=0.01)


def test_thickening_does_not_scale_the_whole_mesh():
    thin, thick = torus(2.0, 0.2), torus(2.0, 0.4)
    growth = Growth.between(thin, thick)
    assert growth.scale < 1.03
    samples = np.stack([(1 - t) * thin.vertices + t * thick.vertices for t in np.linspace(0.0, 1.0, 5)])
    middle = drained(with_even_volume(samples, thin, MESSAGE, UNINTERRUPTED))[2]
    assert TriangleMesh(middle, thin.faces).volume == pytest.approx(0.5 * (thin.volume + thick.volume), rel=1e-3)
    # The volume is proportional to the square of the smaller radius.
    assert middle[:, 2].max() == pytest.approx(np.sqrt(0.5 * (0.2**2 + 0.4**2)), rel=0.02)


def test_a_thickened_torus_keeps_its_ring():
    mesh = torus(2.0, 0.5)
    wanted = mesh.volume * 1.21
    found = TriangleMesh(thickened(mesh, np.full(len(mesh.vertices), 0.5), wanted), mesh.faces)
    assert found.volume == pytest.approx(wanted)
    radial = np.hypot(np.hypot(*found.vertices[:, :2].T) - 2.0, found.vertices[:, 2])
    # The volume of a torus is proportional to the square of its smaller radius.
    np.testing.assert_allclose(radial, 0.55, rtol=0.01)


def test_samples_of_a_pinched_way_get_an_even_volume():
    mesh = torus(2.0, 0.5)
    ring = mesh.vertices / np.hypot(*mesh.vertices[:, :2].T)[:, None] * [2.0, 2.0, 0.0]
    shares = 1.0 - 0.1 * np.sin(np.pi * np.linspace(0.0, 1.0, 9))
    samples = ring + shares[:, None, None] * (mesh.vertices - ring)
    assert TriangleMesh(samples[4], mesh.faces).volume < 0.85 * mesh.volume
    found = drained(with_even_volume(samples, mesh, MESSAGE, UNINTERRUPTED))
    for sample in found:
        assert TriangleMesh(sample, mesh.faces).volume == pytest.approx(mesh.volume, rel=1e-5)
    np.testing.assert_array_equal(found[0], samples[0])
    np.testing.assert_array_equal(found[-1], samples[-1])


def test_open_and_inverted_meshes_have_no_volume_to_keep():
    assert has_volume(ball(points=50))
    assert not has_volume(square())
    assert not has_volume(ball(points=50).flipped())


def test_the_error_of_straight_pieces_is_that_of_the_meshes_between():
    """Half a turn about an axis pinches a mesh flat in the middle of a straight piece."""
    mesh = ball(points=100).moved((0.0, 0.0, 5.0))
    angles = np.linspace(0.0, np.pi, 5)
    turns = [np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]) for a in angles]
    path = RefinedPath.of(np.stack([mesh.vertices @ turn.T for turn in turns]), 0)
    criterion = drained(KeepVolume.of(path, mesh.faces, 0.01, MESSAGE, UNINTERRUPTED))
    assert criterion.between(0, 4) == pytest.approx(100.0)
    # A chord of 90 degrees scales x and y by the cosine of 45 degrees in its middle.
    assert criterion.between(1, 3) == pytest.approx(50.0)
    assert criterion.along([0, 2, 4], np.eye(5)[[0, 2, 4]], UNINTERRUPTED) == pytest.approx(50.0)
