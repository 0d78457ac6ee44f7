# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes that follow surfaces along known motions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.one_mesh.followed_surfaces import Moment, followed, turned_around
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from convwass_addon.sentence import Sentence
from tests.shapes import ball, torus

TIMES = np.linspace(0.0, 1.0, 13)


def following(mesh, moments):
    return drained(followed(mesh, moments, Sentence("Following"), UNINTERRUPTED))


def turning(surface, angle):
    """A surface that turns about the x axis, and the velocities of its points."""
    moments = []
    for t in TIMES:
        points = Rotation.from_rotvec([angle * t, 0.0, 0.0]).apply(surface.vertices)
        moments.append(Moment(float(t), TriangleMesh(points, surface.faces), np.cross([angle, 0.0, 0.0], points)))
    return moments


def test_points_move_with_the_matter_of_a_ball_that_turns_in_place():
    """The surface stays the same, so only the velocities tell where points go."""
    mesh = ball(points=900)
    places = following(mesh, turning(ball(points=4000), np.pi / 2))
    expected = Rotation.from_rotvec([np.pi / 2, 0.0, 0.0]).apply(mesh.vertices)
    assert np.linalg.norm(places[-1] - expected, axis=1).mean() < 0.004
    assert places[0] is mesh.vertices and len(places) == len(TIMES)


def test_a_shape_grows_and_travels():
    """x(t) = (1 + t) x + 3 t e, on surfaces with other triangles."""
    mesh, fine = torus(segments=(24, 12)), torus(segments=(96, 48))
    shift = np.array([3.0, 0.0, 0.0])
    moments = [
        Moment(float(t), TriangleMesh((1 + t) * fine.vertices + t * shift, fine.faces), fine.vertices + shift)
        for t in TIMES
    ]
    for t, points in zip(TIMES, following(mesh, moments), strict=True):
        assert np.abs(points - ((1 + t) * mesh.vertices + t * shift)).max() < 0.03


def test_a_mesh_stays_on_a_ball_that_grows_at_an_unknown_velocity():
    """As next to the ends of a morph, only the surfaces tell where it goes."""
    mesh, radii = ball(points=200), np.linspace(1.0, 1.6, 7)
    moments = [Moment(radius - 1.0, ball(radius, points=400)) for radius in radii]
    for radius, points in zip(radii, following(mesh, moments), strict=True):
        np.testing.assert_allclose(np.linalg.norm(points, axis=1), radius, rtol=0.015)


def test_the_way_back_has_the_times_and_velocities_of_the_way_there():
    there = turning(ball(points=300), 1.0)
    back = turned_around(there)
    assert [moment.time for moment in back] == pytest.approx(TIMES)
    assert back[0].surface is there[-1].surface
    np.testing.assert_array_equal(back[3].velocity, -there[-4].velocity)
    assert turned_around([Moment(0.25, ball(points=20))])[0].velocity is None
