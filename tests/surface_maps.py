# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between meshes known without solving: to the closest points."""

from __future__ import annotations

import numpy as np

from convwass_addon.applications.soft_maps.surface_maps import CoarseRows, PointMap, SurfaceMap, VertexInterpolation
from convwass_addon.geometry.meshes.closest_points import ClosestPointFinder
from convwass_addon.sentence import Sentence


def closest_map(source, target):
    """Map both directions to the closest points of coinciding meshes; every vertex is its own coarse vertex."""
    return SurfaceMap(
        closest_points(source, target),
        closest_points(target, source),
        single_rows(source, target),
        {"sweeps": 3, "seconds": 0.5, "numerics": "none"},
        (Sentence("{name} is a test", {"name": Sentence("This")}),),
    )


def closest_points(mesh, other):
    """A point of the other mesh for every vertex; all are confident except for vertices without triangles."""
    found = ClosestPointFinder(other.corners).find(mesh.vertices)
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    return PointMap(
        np.where(used, found.triangles, -1).astype(np.int32),
        np.where(used[:, None], found.shares, 0.0).astype(np.float32),
        np.where(used, 0.25, np.inf).astype(np.float32),
        np.full(len(used), -2.0, np.float32),
        np.where(used, 0.75, 0.0).astype(np.float32),
    )


def single_rows(source, target):
    """Map every source vertex to the nearest target vertex, with mass 1."""
    nearest = [np.linalg.norm(target.vertices - point, axis=1).argmin() for point in source.vertices]
    areas = np.zeros(len(target.vertices))
    doubled = np.linalg.norm(np.cross(*(target.corners[:, k] - target.corners[:, 0] for k in (1, 2))), axis=1)
    np.add.at(areas, target.faces, doubled[:, None])
    values = areas.sum() / areas[nearest]
    count = len(source.vertices)
    return CoarseRows(
        np.arange(count + 1),
        np.array(nearest, np.int32),
        values.astype(np.float32),
        own_interpolation(count),
        own_interpolation(len(target.vertices)),
    )


def own_interpolation(count):
    columns = np.stack([np.arange(count)] * 3, axis=1).astype(np.int32)
    return VertexInterpolation(columns, np.tile(np.array([1.0, 0.0, 0.0], np.float32), (count, 1)))
