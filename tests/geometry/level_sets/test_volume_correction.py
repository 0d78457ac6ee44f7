# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces that are moved along their normals to enclose a volume."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.level_sets.volume_correction import with_volume
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.normals import triangle_normals, vertex_normals
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from tests.shapes import ball, extruded, joined


def corrected(mesh, volume, cell=1.0):
    return with_volume(mesh, vertex_normals(mesh.vertices, mesh.faces), volume, cell)


def plate(thickness):
    square = 4.0 * np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return extruded(square, low=-0.5 * thickness, high=0.5 * thickness, edge=0.5)


@pytest.mark.parametrize("change", [-0.3, 0.3])
def test_a_ball_becomes_a_ball_of_that_volume(change):
    mesh = ball(6.0)
    found = corrected(mesh, mesh.volume * ((6.0 + change) / 6.0) ** 3)
    np.testing.assert_allclose(np.linalg.norm(found.vertices, axis=1), 6.0 + change, atol=2e-3)


def test_no_vertex_moves_farther_than_the_limit():
    mesh = ball(6.0)
    found = corrected(mesh, 0.5 * mesh.volume)
    np.testing.assert_allclose(np.linalg.norm(found.vertices, axis=1), 5.4, atol=1e-3)


@pytest.mark.parametrize("size", [1e-3, 1e3])
def test_it_does_not_depend_on_the_size(size):
    mesh = joined(ball(6.0), plate(0.3).moved((0.0, 0.0, 12.0)))
    larger = TriangleMesh(size * mesh.vertices, mesh.faces)
    found = corrected(larger, 0.9 * larger.volume, size)
    np.testing.assert_allclose(found.vertices, size * corrected(mesh, 0.9 * mesh.volume).vertices, rtol=1e-9)


def test_what_is_not_thin_makes_up_for_what_is():
    thick, thin = ball(2.0), plate(0.1)
    both = joined(thick, thin.moved((0.0, 0.0, 12.0)))
    wanted = thick.volume * (1.5 / 2.0) ** 3 + 0.4 * thin.volume
    assert corrected(both, wanted).volume == pytest.approx(wanted, rel=1e-3)


def test_blocks_across_a_gap_are_not_thin():
    blocks = [
        extruded(np.array([[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]]), low=low, high=low + 4.0, edge=0.5)
        for low in (-4.05, 0.05)
    ]
    alone, both = blocks[1], joined(*blocks)
    found = corrected(both, 0.7 * both.volume).vertices[len(blocks[0].vertices) :]
    np.testing.assert_allclose(found, corrected(alone, 0.7 * alone.volume).vertices, atol=1e-6)


@pytest.mark.parametrize("thickness", [0.1, 0.3, 0.6])
def test_thin_plates_are_not_turned_inside_out(thickness):
    thick, thin, above = ball(6.0), plate(thickness), np.array([0.0, 0.0, 12.0])
    wanted = thick.volume * (5.6 / 6.0) ** 3 + 0.5 * thin.volume
    both = joined(thick, TriangleMesh(thin.vertices + above, thin.faces))
    found = corrected(both, wanted)
    assert found.volume == pytest.approx(wanted, rel=1e-3)
    plate_alone = TriangleMesh(found.vertices[len(thick.vertices) :] - above, thin.faces)
    inside = np.abs(plate_alone.vertices[:, :2]).max(axis=1) < 3.0
    heights = plate_alone.vertices[inside, 2] * np.sign(thin.vertices[inside, 2])
    assert 0.14 * thickness < heights.min() <= heights.max() < 0.25 * thickness
    centers = plate_alone.corners.mean(axis=1)
    beneath = centers - 1e-3 * thickness * triangle_normals(plate_alone.corners)
    np.testing.assert_allclose(winding_numbers(beneath, plate_alone), 1.0, atol=1e-6)
