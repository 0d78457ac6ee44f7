# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.solids import winding
from convwass_addon.geometry.solids.occupancy import occupancy
from convwass_addon.geometry.solids.orientation import orient_outward
from convwass_addon.geometry.solids.solid_angles import winding_numbers
from convwass_addon.geometry.solids.thicken import shell_occupancy
from convwass_addon.geometry.solids.winding import lattice_winding
from tests.shapes import ball, box, joined, square, torus, with_faces

SHAPE = (40, 32, 36)
MIDDLE = (20.3, 15.9, 18.2)


@pytest.mark.parametrize(
    "mesh",
    [
        ball(11, MIDDLE),
        torus(9, 4, MIDDLE),
        box((20, 9, 14), MIDDLE, (0.4, 0.2, 0.9)),
        joined(ball(7, (12, 16, 18)), ball(6, (27, 16, 18))),
    ],
)
def test_closed_solids_keep_their_volume(mesh):
    filled = occupancy(mesh.corners, SHAPE)
    assert filled.shape == SHAPE
    assert 0 <= filled.min() <= filled.max() <= 1
    assert filled.sum() == pytest.approx(mesh.volume, rel=5e-3)


@pytest.mark.parametrize("thickness", [3.9, 4.13, 4.3])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_plates_along_the_grid_are_as_thick_as_they_are(axis, thickness):
    """Faces that no ray of two axes sees at more than a few places."""
    plate = box(np.roll((thickness, 14.3, 12.6), axis), (18.07, 15.91, 18.23))
    assert occupancy(plate.corners, SHAPE).sum() == pytest.approx(plate.volume, rel=1.2e-2)


def test_faces_on_cell_boundaries_are_exact():
    filled = occupancy(box((10, 12, 14), (20, 16, 18)).corners, SHAPE)
    expected = np.zeros(SHAPE)
    expected[15:25, 10:22, 11:25] = 1
    np.testing.assert_allclose(filled, expected, atol=1e-3)


def test_lattice_winding_is_exact_on_closed_meshes():
    mesh = joined(torus(9, 4, MIDDLE), ball(5, (20.3, 25, 18.2)))
    found = lattice_winding(mesh.corners, SHAPE)
    cells = np.random.default_rng(1).integers(4, 28, (60, 3))
    np.testing.assert_allclose(found[tuple(cells.T)], winding_numbers(cells + 0.5, mesh), atol=2e-3)


def test_lattice_winding_is_approximate_on_open_meshes():
    whole = ball(11, MIDDLE)
    bowl = with_faces(whole, whole.corners[:, :, 2].mean(axis=1) < MIDDLE[2])
    found = lattice_winding(bowl.corners, SHAPE)
    cells = np.random.default_rng(1).integers(4, 28, (80, 3))
    assert np.abs(found[tuple(cells.T)] - winding_numbers(cells + 0.5, bowl)).mean() < 0.06


def test_holes_do_not_leak():
    mesh = ball(11, MIDDLE)
    holey = with_faces(mesh, np.random.default_rng(2).random(len(mesh.faces)) > 0.03)
    assert occupancy(holey.corners, SHAPE).sum() == pytest.approx(mesh.volume, rel=0.02)


def test_overlapping_solids_count_once():
    one, other = box((10, 10, 10), (16, 16, 18)), box((10, 10, 10), (22, 16, 18))
    filled = occupancy(joined(one, other).corners, SHAPE)
    assert filled.max() == 1
    assert filled.sum() == pytest.approx(1600, rel=2e-3)


def test_a_cavity_is_empty():
    hollow = orient_outward(joined(ball(12, MIDDLE), ball(6, MIDDLE).flipped()))
    filled = occupancy(hollow.corners, SHAPE)
    assert filled[20, 16, 18] == 0
    assert filled.sum() == pytest.approx(hollow.volume, rel=5e-3)


def test_a_plate_thinner_than_a_cell_keeps_its_volume():
    plate = box((20, 18, 0.8), MIDDLE)
    assert occupancy(plate.corners, SHAPE).sum() == pytest.approx(plate.volume, rel=0.08)


def test_a_sheet_is_empty_and_can_be_given_thickness():
    sheet = square(16, MIDDLE)
    assert occupancy(sheet.corners, SHAPE).sum() < 1
    thick = shell_occupancy(sheet.corners, SHAPE, 3.0)
    # The border adds half the thickness around the edge.
    assert 16 * 16 * 3 < thick.sum() < 19 * 19 * 3.2


@pytest.mark.parametrize("offset", [0.0, 1e-5, 2e-5, 3e-5, -2e-5])
def test_winding_numbers_are_integers_even_if_the_surface_passes_through_centers(offset):
    """Lines along the three axes pass slightly beside the centers, on different sides."""
    mesh = box((6.0, 5.0, 4.0), center=(8.5 + offset, 8.0 + offset, 7.5 + offset))
    found = winding.lattice_winding(mesh.corners, (16, 16, 16))
    assert set(np.unique(found)) == {0.0, 1.0}
    assert abs(found.sum() - 120.0) <= 60.0
    # Half a cell away from all faces, the result is unambiguous.
    assert (found[6:11, 6:10, 6:9] == 1.0).all()
    assert found[12:].max() == found[:5].max() == 0.0
