# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.geometry.level_sets.connectivity import Connectivity
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.mesh_connectivity import mesh_connectivity
from tests.shapes import ball, bent_tube, box, joined, square, torus, with_faces


@pytest.mark.parametrize(
    ("mesh", "expected"),
    [
        (ball(), Connectivity(1, 0, 0)),
        (torus(), Connectivity(1, 1, 0)),
        (joined(torus(), ball(0.3)), Connectivity(2, 1, 0)),
        (joined(ball(), ball(0.5).flipped()), Connectivity(1, 0, 1)),
        # A gap too narrow for the grid of any bake.
        (joined(box(center=(-0.501, 0, 0)), box(center=(0.501, 0, 0))), Connectivity(2, 0, 0)),
        (bent_tube(np.radians(355)), Connectivity(1, 0, 0)),
    ],
)
def test_closed_meshes_determine_the_connectivity(mesh, expected):
    assert mesh_connectivity(mesh) == expected


def test_unwelded_triangles_determine_the_connectivity():
    mesh = torus()
    apart = TriangleMesh.from_arrays(mesh.corners.reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))
    assert mesh_connectivity(apart) == Connectivity(1, 1, 0)


@pytest.mark.parametrize(
    "mesh",
    [
        square(),
        with_faces(ball(), slice(1, None)),
        # One solid made of two meshes, and a solid ring whose mesh is a tube that overlaps itself.
        joined(ball(), ball(center=(1, 0, 0))),
        bent_tube(np.radians(375)),
        # Coincident faces.
        joined(box(center=(-0.5, 0, 0)), box(center=(0.5, 0, 0))),
    ],
)
def test_other_meshes_do_not_determine_the_connectivity(mesh):
    assert mesh_connectivity(mesh) is None
