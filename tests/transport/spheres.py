# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Unit spheres as domains, and distributions on them; distances are compared with great circles."""

from __future__ import annotations

from functools import cache

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.transport import Surface

_GOLDEN = (1 + 5**0.5) / 2
_CORNERS = [(-1, _GOLDEN, 0), (1, _GOLDEN, 0), (-1, -_GOLDEN, 0), (1, -_GOLDEN, 0), (0, -1, _GOLDEN), (0, 1, _GOLDEN)]
_CORNERS += [(0, -1, -_GOLDEN), (0, 1, -_GOLDEN), (_GOLDEN, 0, -1), (_GOLDEN, 0, 1), (-_GOLDEN, 0, -1)]
_CORNERS += [(-_GOLDEN, 0, 1)]
_FACES = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6)]
_FACES += [(7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10)]
_FACES += [(8, 6, 7), (9, 8, 1)]


@cache
def icosphere(level: int) -> TriangleMesh:
    """An icosahedron with triangles split into four `level` times: 10 * 4^level + 2 vertices on the unit sphere."""
    vertices, faces = np.array(_CORNERS) / np.hypot(1, _GOLDEN), np.array(_FACES)
    for _ in range(level):
        edges = np.sort(np.concatenate([faces[:, [1, 2]], faces[:, [2, 0]], faces[:, [0, 1]]]), axis=1)
        edges, middle = np.unique(edges, axis=0, return_inverse=True)
        a, b, c = faces.T
        p, q, r = middle.reshape(3, -1) + len(vertices)
        faces = np.concatenate([np.stack(t, 1) for t in ((a, r, q), (r, b, p), (q, p, c), (p, q, r))])
        new = vertices[edges].sum(axis=1)
        vertices = np.concatenate([vertices, new / np.linalg.norm(new, axis=1, keepdims=True)])
    return TriangleMesh.from_arrays(vertices, faces)


@cache
def _plain(level: int) -> Surface:
    mesh = icosphere(level)
    return Surface(mesh.vertices, mesh.faces)


@cache
def sphere(level: int, gamma: float, steps: int = 10) -> Surface:
    """The icosphere as a domain."""
    return _plain(level).with_kernel(gamma, steps)


def angles(surface: Surface, point: np.ndarray) -> np.ndarray:
    """Great-circle distances of all vertices from a point of the unit sphere."""
    return np.arccos(np.clip(surface.positions @ point, -1.0, 1.0))


def at(angle: float) -> np.ndarray:
    """The point on the equator at an angle."""
    return np.array([np.cos(angle), np.sin(angle), 0.0])


def cap(surface: Surface, angle: float, radius: float = 0.3) -> np.ndarray:
    """Density of mass 1 on the cap around a point on the equator, with a soft rim and exact zeros outside."""
    density = 1.0 / (1.0 + np.exp((angles(surface, at(angle)) - radius) / (0.1 * radius)))
    density[density < 1e-4] = 0.0
    return density / (density @ surface.weights)


def peaks(surface: Surface, seed: int, count: int = 4) -> np.ndarray:
    """Density of mass 1 with several round peaks of different heights, zero far from them."""
    rng = np.random.default_rng(seed)
    places = rng.normal(size=(count, 3))
    places /= np.linalg.norm(places, axis=1, keepdims=True)
    density = sum(
        height * np.exp(-0.5 * (angles(surface, place) / width) ** 2)
        for place, height, width in zip(places, rng.uniform(0.5, 2, count), rng.uniform(0.1, 0.3, count), strict=True)
    )
    density[density < 1e-3] = 0.0
    return density / (density @ surface.weights)


def center(surface: Surface, density: np.ndarray) -> np.ndarray:
    """The point on the sphere in the direction of a density's mean."""
    mean = (density * surface.weights) @ surface.positions
    return mean / np.linalg.norm(mean)


def off_center(surface: Surface, density: np.ndarray, angle: float) -> float:
    """Angle between the center of a density and a point on the equator."""
    return float(np.arccos(np.clip(center(surface, density) @ at(angle), -1.0, 1.0)))
