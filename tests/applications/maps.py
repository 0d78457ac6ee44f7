# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Meshes and exact maps between them, for tests of transfer along maps; and coarse maps, for tests of bakes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from convwass_addon.applications.motions import motion_candidates
from convwass_addon.applications.motions.guided_settings import GuidedSettings
from convwass_addon.applications.motions.warp_motion import WarpEffort
from convwass_addon.applications.outlines import limb_motion, moved_sheets
from convwass_addon.applications.registrations import promising_maps
from convwass_addon.applications.soft_maps.surface_maps import PointMap
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.remeshing import subdivision


@contextmanager
def coarse_maps() -> Iterator[None]:
    """Let bakes map, deform and warp shapes on coarse meshes and cells, which are enough for shapes of few limbs."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(motion_candidates, "USUAL_EFFORT", WarpEffort(24, 4))
        patch.setattr(
            motion_candidates, "GuidedSettings", partial(GuidedSettings, map_vertices=200, carrier_vertices=300)
        )
        patch.setattr(promising_maps, "_CARRIER_VERTICES", 400)
        patch.setattr(promising_maps, "_MAP_VERTICES", 100)
        yield


@contextmanager
def coarse_surfaces() -> Iterator[None]:
    """Let triangles that are to bend be divided less than in use."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(subdivision, "_BENDING", 0.06)
        yield


@contextmanager
def coarse_outlines() -> Iterator[None]:
    """Let flat shapes that move have larger triangles than in use, and fewer vertices."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(moved_sheets, "TRIANGLES", 0.05)
        patch.setattr(limb_motion, "TRIANGLES", 0.05)
        patch.setattr(moved_sheets, "_VERTICES", 1000)
        yield


def exact_map(places, giver):
    """The closest points of a giver to given places, all with full confidence."""
    found = ClosestPointFinder(giver.corners).find(places)
    count = len(found.triangles)
    figures = np.zeros(count, np.float32), np.full(count, -5.0, np.float32), np.ones(count, np.float32)
    return PointMap(found.triangles.astype(np.int32), found.shares.astype(np.float32), *figures)


def without_points(points, lost):
    """The map with the points of some vertices removed."""
    faces = np.where(lost, -1, points.faces).astype(np.int32)
    shares = np.where(lost[:, None], 0.0, points.barycentric).astype(np.float32)
    confidence = np.where(lost, 0.0, points.confidence).astype(np.float32)
    return PointMap(faces, shares, points.spread, points.entropy, confidence)


def subdivided(mesh):
    """Every triangle split into four; the original vertices come first."""
    faces = mesh.faces
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = inverse.reshape(3, -1) + len(mesh.vertices)
    a, b, c = faces.T
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    vertices = np.concatenate([mesh.vertices, mesh.vertices[unique].mean(axis=1)])
    return TriangleMesh(vertices, np.concatenate([np.stack(part, axis=1) for part in parts]))


def turn(angles=(40, -70, 25)):
    return Rotation.from_euler("xyz", angles, degrees=True).as_matrix()


def arm(angle=0.0, around=16, along=40, length=4.0, radius=0.3):
    """A closed tube along x whose second half is bent about z by an angle, with an elbow of constant length."""
    x = np.linspace(0.0, length, along)
    elbow = 1.2
    bend = np.clip((x - 0.5 * (length - elbow)) / elbow, 0.0, 1.0) * angle
    step = np.diff(x, prepend=x[0])
    middle = np.stack([np.cumsum(np.cos(bend) * step), np.cumsum(np.sin(bend) * step), 0 * x], axis=1)
    side = np.stack([-np.sin(bend), np.cos(bend), 0 * x], axis=1)
    turns = np.arange(around) * 2 * np.pi / around
    ring = np.cos(turns)[None, :, None] * side[:, None] + np.sin(turns)[None, :, None] * np.array([0.0, 0.0, 1.0])
    vertices = np.concatenate([(middle[:, None] + radius * ring).reshape(-1, 3), middle[[0, -1]]])
    faces = []
    for j in range(along - 1):
        for i in range(around):
            a, b = j * around + i, j * around + (i + 1) % around
            faces += [(a, b, b + around), (a, b + around, a + around)]
    start, end, last = along * around, along * around + 1, (along - 1) * around
    faces += [(start, (i + 1) % around, i) for i in range(around)]
    faces += [(end, last + i, last + (i + 1) % around) for i in range(around)]
    return TriangleMesh.from_arrays(vertices, faces), bend


def tube(around, along, shift=0.0):
    """An open tube about z of height 2, with UVs from angle and height (one seam), and the quad of every triangle."""
    angles = (np.arange(around) + shift) * 2 * np.pi / around
    vertices = [(np.cos(t), np.sin(t), z) for z in np.linspace(0, 2, along) for t in angles]
    faces, uvs = [], []
    for j in range(along - 1):
        for i in range(around):
            k = (i + 1) % around
            quad = [j * around + i, j * around + k, (j + 1) * around + k, (j + 1) * around + i]
            low, high = j / (along - 1), (j + 1) / (along - 1)
            left, right = (i + shift) / around, (i + 1 + shift) / around
            corners = [(left, low), (right, low), (right, high), (left, high)]
            for part in ((0, 1, 2), (0, 2, 3)):
                faces.append([quad[corner] for corner in part])
                uvs.append([corners[corner] for corner in part])
    return TriangleMesh.from_arrays(vertices, faces), np.array(uvs), np.arange(len(faces)) // 2
