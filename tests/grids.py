# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat sheets, symmetric figures and bars of triangles, with any resolution."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from convwass_addon.geometry.meshes.mesh import TriangleMesh


def sheet(columns, rows, size=(1.0, 1.0)):
    """A flat rectangle of right-angled triangles, with the given numbers of vertices along its sides."""
    x, y = np.meshgrid(np.linspace(0, size[0], columns), np.linspace(0, size[1], rows), indexing="ij")
    corner = np.arange(columns * rows).reshape(columns, rows)
    a, b, c, d = (part.ravel() for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return TriangleMesh.from_arrays(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), faces)


def figure(cells=6):
    """A body with a head, two arms, two legs and a tail; and the index of every vertex's mirror image.

    It is exactly symmetric in x, but not in the other directions.
    """
    directions, faces = _cube_sphere(cells)
    bumps = [((0.0, 0.15, 1.0), 0.7, 9.0), ((0.9, 0.1, 0.35), 1.0, 14.0), ((0.45, -0.1, -0.9), 0.9, 14.0)]
    bumps += [((0.0, -0.9, -0.2), 0.35, 8.0)]
    radii = np.ones(len(directions))
    for center, height, sharpness in bumps:
        center = np.array(center) / np.linalg.norm(center)
        for side in (center,) if center[0] == 0 else (center, center * (-1.0, 1.0, 1.0)):
            radii += height * np.exp(sharpness * (directions @ side - 1.0))
    mirror = cKDTree(directions).query(directions * (-1.0, 1.0, 1.0))[1]
    return TriangleMesh.from_arrays(directions * radii[:, None] * (1.0, 0.7, 1.0), faces), mirror


def _cube_sphere(cells):
    """Directions to the vertices and centers of a subdivided cube's squares, and triangles around the centers."""
    ticks = np.tan(np.linspace(-np.pi / 4, np.pi / 4, cells + 1))
    middles = np.tan((np.arange(cells) + 0.5) / cells * np.pi / 2 - np.pi / 4)
    points, faces = [], []
    for axis in range(3):
        for sign in (-1, 1):
            i, j = (part.ravel() for part in np.meshgrid(np.arange(cells), np.arange(cells), indexing="ij"))
            corners = [(ticks[i], ticks[j]), (ticks[i + 1], ticks[j]), (ticks[i + 1], ticks[j + 1])]
            corners += [(ticks[i], ticks[j + 1]), (middles[i], middles[j])]
            start = sum(len(some) for some in points)
            for u, v in corners:
                points.append(np.roll(np.stack([np.full(len(u), float(sign)), u, v], axis=1), axis, axis=1))
            number = start + np.arange(len(i)) + np.arange(5)[:, None] * len(i)
            for first, second in ((0, 1), (1, 2), (2, 3), (3, 0)):
                ends = (number[first], number[second]) if sign > 0 else (number[second], number[first])
                faces.append(np.stack([*ends, number[4]], axis=1))
    points, faces = np.concatenate(points), np.concatenate(faces)
    _, first, merged = np.unique(points.round(9), axis=0, return_index=True, return_inverse=True)
    directions = points[first]
    return directions / np.linalg.norm(directions, axis=1, keepdims=True), merged.ravel()[faces]
