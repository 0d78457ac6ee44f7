# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tubes have a center line; other solids have none."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from convwass_addon.geometry import center_lines
from convwass_addon.geometry.center_lines import sliced_tube
from convwass_addon.geometry.mesh import TriangleMesh
from tests.applications.maps import arm
from tests.grids import figure
from tests.line_tubes import helix, straight, tube
from tests.shapes import ball, joined, torus


@pytest.mark.parametrize(
    "line", [straight(), helix(0.5, 0.5, 3.0), helix(1.0, 0.0, 0.8)], ids=["straight", "spring", "arc"]
)
@pytest.mark.parametrize("size", [1.0, 1e-3, 1e4])
def test_the_line_is_in_the_middle(line, size):
    found = sliced_tube(tube(size * line, 0.1 * size))
    away, _ = cKDTree(size * line).query(found.points)
    spacing = np.linalg.norm(np.diff(line, axis=0), axis=1).max()
    assert away.max() < (0.5 * spacing + 0.01) * size
    steps = np.linalg.norm(np.diff(found.points, axis=0), axis=1)
    assert steps == pytest.approx(steps.mean(), rel=0.01)
    length = np.linalg.norm(np.diff(line, axis=0), axis=1).sum()
    assert steps.sum() / size == pytest.approx(length, rel=0.01)
    assert found.radii / size == pytest.approx(0.1, rel=0.06)


def test_radii_follow_a_taper():
    line = straight(6.0, 80)
    radii = np.linspace(0.3, 0.1, 80)
    found = sliced_tube(tube(line, radii))
    # Those of the ends are as wide as the slices next to them.
    inner = slice(12, -12)
    assert found.radii[inner] == pytest.approx(np.interp(found.points[inner, 2], line[:, 2], radii), rel=0.05)


@pytest.mark.parametrize("rings", [(12, 30), (24, 60)])
def test_the_line_of_a_straight_arm_is_straight(rings):
    points = sliced_tube(arm(0.0, *rings)[0]).points
    along = np.diff(points, axis=0) / np.linalg.norm(np.diff(points, axis=0), axis=1, keepdims=True)
    turns = np.arccos(np.clip((along[1:] * along[:-1]).sum(axis=1), -1.0, 1.0))
    assert np.degrees(turns.sum()) < 8.0


def test_the_line_does_not_depend_on_rounding():
    """Although several vertices of an end are equally far away."""
    rod = tube(helix(0.5, 0.5, 3.0))
    expected = sliced_tube(rod).points
    for seed in range(4):
        turn = Rotation.random(rng=np.random.default_rng(seed))
        found = sliced_tube(TriangleMesh(turn.apply(rod.vertices), rod.faces)).points
        np.testing.assert_allclose(found, turn.apply(expected), atol=1e-6)


def test_vertices_are_beside_their_points():
    found = sliced_tube(tube(helix(0.5, 0.5, 3.0)))
    points = np.stack([np.interp(found.places, np.arange(len(found.points)), own) for own in found.points.T], axis=1)
    inner = np.abs(found.places / (len(found.points) - 1.0) - 0.5) < 0.48
    away = np.linalg.norm(found.divided.mesh.vertices - points, axis=1)[inner]
    assert away == pytest.approx(0.1, rel=0.1)


@pytest.mark.parametrize(
    "solid",
    [ball(), torus(1.0, 0.1), figure(40)[0], joined(tube(straight()), tube(np.add(straight(), 1.0)))],
    ids=["ball", "ring", "figure", "two tubes"],
)
def test_what_is_round_closed_branching_or_apart_is_no_tube(solid):
    assert sliced_tube(solid) is None


def test_what_has_too_few_vertices_along_it_is_no_tube(monkeypatch):
    monkeypatch.setattr(center_lines, "_MOST_VERTICES", 0)
    assert sliced_tube(tube(straight(4.0, 2))) is None
