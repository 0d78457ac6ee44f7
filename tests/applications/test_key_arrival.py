# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is told about how well a mesh with shape keys arrives."""

from __future__ import annotations

import numpy as np
import pytest

from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.one_mesh.key_paths import KeyDemands, KeyPath, key_paths
from convwass_addon.bridge.one_mesh.key_notices import key_summary, poor_notices
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import UNINTERRUPTED, drained
from tests.shapes import ball, box


def test_the_distance_is_that_of_the_surface_and_not_of_its_corners():
    """The eight vertices of a cube end on a ball, and its triangles deep inside."""
    cube, other = box((1.6, 1.6, 1.6)), ball(1.0)
    settings = GuidedSettings(map_vertices=100, carrier_vertices=200)
    paths = drained(key_paths((cube, other), ("Cube", "Ball"), KeyDemands(0.01), settings, (), UNINTERRUPTED))
    corners = TriangleMesh(paths[0].positions[-1], cube.faces).corners
    steps = (np.arange(60) + 0.5) / 60.0
    shares = np.array([(u, v, 1.0 - u - v) for u in steps for v in steps if u + v < 1.0])
    points = np.einsum("sc,fcd->fsd", shares, corners)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    known = ClosestPointFinder(other.corners).find(points.reshape(-1, 3)).distances / other.diagonal
    order, weights = np.argsort(known), np.repeat(areas, len(shares))
    reached = np.cumsum(weights[order]) / weights.sum()
    told = key_summary("Cube", paths).values["distance"]
    assert told == pytest.approx(known[order][np.searchsorted(reached, 0.95)], rel=0.02)
    assert told > 0.05
    assert paths[0].missed > 0.9 and paths[0].beyond == 0.0


def test_what_a_finer_mesh_would_reach_is_told_apart_from_parts_that_it_lacks():
    figures = dict.fromkeys(("score", "deviation", "distance", "distance_95"), 0.0)
    path = KeyPath("Hero", (1.0,), np.zeros((1, 3, 3)), turned=0, missed=0.3, beyond=0.2, **figures)
    assert list(map(str, poor_notices([path]))) == [
        "10% of the surface of Hero is missed: the mesh has too few vertices there; "
        "choose another Basis, or subdivide it",
        "20% of the surface of Hero is missed: no part of the mesh takes its form; add guides, or set Two Meshes",
    ]
