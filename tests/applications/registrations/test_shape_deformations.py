# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformations of a thin plate whose two sides are laid elsewhere."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.registrations.carriers import carrier_of
from convwass_addon.applications.registrations.laid_meshes import Laid
from convwass_addon.applications.registrations.shape_deformations import split_deformation
from convwass_addon.geometry.deformation.swing_twist import mean_turns, turn_matrices
from convwass_addon.progress import UNINTERRUPTED
from tests.shapes import bent, extruded

THICKNESS = 0.04


@pytest.fixture(scope="module")
def plate():
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    mesh = extruded(square, low=-0.5 * THICKNESS, high=0.5 * THICKNESS, edge=0.05)
    return carrier_of(mesh, "plate", 4000, UNINTERRUPTED)


def deformed(carrier, points):
    """The vertices that fit the gradients, links and anchors of a plate laid at some points."""
    mesh, links = carrier.mesh, carrier.poisson.links
    found = split_deformation(carrier, carrier, Laid(points, np.ones(len(points))), None, UNINTERRUPTED)
    gradients = turn_matrices(mean_turns(found.turns, mesh.faces)) @ found.stretches
    turned = np.einsum("kij,kj->ki", turn_matrices(mean_turns(found.turns, links.ends)), found.link_stretches)
    return carrier.poisson.solve(gradients, turned, points)


def test_sides_do_not_pass_through_each_other(plate):
    """In the middle of the plate, each side is laid beyond the other one."""
    rest = plate.mesh.vertices
    middle = np.exp(-np.square(2.0 * rest[:, :2]).sum(axis=1))
    swapped = rest * np.stack([np.ones(len(rest)), np.ones(len(rest)), 1.0 - 4.0 * middle], axis=1)
    heights = deformed(plate, swapped)[:, 2] * np.sign(rest[:, 2])
    assert (swapped[:, 2] * np.sign(rest[:, 2])).min() < -0.5 * THICKNESS
    assert heights.min() > 0.0


def test_a_bent_plate_is_reproduced(plate):
    laid = bent(plate.mesh.vertices[:, [1, 2, 0]], 1.5)[:, [2, 0, 1]]
    np.testing.assert_allclose(deformed(plate, laid), laid, atol=1e-6)
