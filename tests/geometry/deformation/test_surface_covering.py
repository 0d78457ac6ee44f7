# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Stretch meshes over slits that they leave open."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.algebra import factorization
from convwass_addon.geometry.algebra.factorization import CholmodSimplicial, SuperLU
from convwass_addon.geometry.deformation.surface_covering import covering
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.meshes.visible_gap import VisibleGap
from tests.shapes import ball, joined


def cut_off(mesh, height, side):
    """What lies above (side 1) or below (-1) a height; the rest of the mesh is pressed flat."""
    points = mesh.vertices.copy()
    points[:, 2] = side * np.maximum(side * points[:, 2], height)
    return TriangleMesh(points, mesh.faces)


@pytest.mark.parametrize("library", [CholmodSimplicial, SuperLU])
@pytest.mark.parametrize("points", [800, 3000])
def test_two_halves_close_the_slit_between_them(points, library, monkeypatch):
    """With the factorization of the small package, too."""
    monkeypatch.setattr(factorization, "FACTORIZATIONS", {library.name: library})
    surface, mesh = ball(points=2000), ball(points=points)
    halves = joined(cut_off(mesh, 0.06, 1), cut_off(mesh, 0.06, -1))
    # The slit is 0.12 wide.
    closed = TriangleMesh(covering(halves, surface), halves.faces)
    assert VisibleGap.between(halves, surface).most > 0.04
    assert VisibleGap.between(closed, surface).most < 0.012


def test_a_mesh_that_covers_the_surface_stays():
    surface = ball()
    assert np.abs(covering(surface, surface) - surface.vertices).max() < 1e-9
