# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with any number of vertices, and densities on them; needs only NumPy and SciPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array
from scipy.spatial import ConvexHull

# Wave vectors, phases and heights of the blob's bumps: few waves, no symmetry, no folds.
_WAVES = np.array([[2.1, 0.4, -1.3], [-0.7, 2.6, 0.9], [1.2, -1.9, 2.8], [3.4, 1.5, 0.6], [-2.2, 1.1, 3.7]])
_PHASES = np.array([0.3, 1.9, 4.4, 2.7, 5.6])
_HEIGHTS = np.array([0.16, 0.12, 0.09, 0.06, 0.05])
# Concentration of the von Mises-Fisher distributions: a standard deviation of about 17 degrees per axis.
_CONCENTRATION = 12.0


def sphere(count: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Triangulate the sphere of unit area with exactly `count` nearly evenly spaced vertices.

    The vertices lie on a spherical Fibonacci lattice (Á. González, "Measurement of Areas on a Sphere Using Fibonacci
    and Latitude-Longitude Lattices", Mathematical Geosciences 42, 2010); their convex hull is the triangulation.

    Returns
    -------
    vertices : (count, 3) float64
        On a sphere around the origin, scaled so that the triangles have unit area.
    faces : (2 count - 4, 3) int64
        Counterclockwise seen from outside.
    """
    k = np.arange(count) + 0.5
    z, angle = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    flat = np.sqrt(1.0 - z**2)
    vertices = np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=1)
    faces = ConvexHull(vertices).simplices.astype(np.int64)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    inward = np.einsum("ij,ij->i", a, np.cross(b - a, c - a)) < 0
    faces[inward] = faces[inward, ::-1]
    return _with_unit_area(vertices, faces), faces


def blob(count: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return a smooth bumpy shape, the same for every `count`: the sphere displaced radially by a few waves."""
    vertices, faces = sphere(count)
    directions = vertices / np.linalg.norm(vertices, axis=1, keepdims=True)
    radii = 1.0 + np.cos(directions @ _WAVES.T + _PHASES) @ _HEIGHTS
    return _with_unit_area(directions * radii[:, None], faces), faces


def edge_graph(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> csr_array:
    """Return the edge graph of a closed mesh, weighted by length, in both directions."""
    # Every edge belongs to two triangles that traverse it in opposite directions.
    tails, heads = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    lengths = np.linalg.norm(vertices[tails] - vertices[heads], axis=1)
    return coo_array((lengths, (tails, heads)), shape=(len(vertices), len(vertices))).tocsr()


def random_densities(count: int, trials: int) -> NDArray[np.float64]:
    """Return pairs of densities of independent uniform noise, (trials, 2, count), as in the paper's Table 1."""
    return np.random.default_rng(0).random((trials, 2, count))


def bumps(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return two smooth densities of two bumps each, (2, n), at points on a sphere around the origin, (n, 3)."""
    directions = points / np.linalg.norm(points, axis=1, keepdims=True)
    centers = np.array([[[0.6, -0.6, 0.5], [-0.7, -0.3, -0.6]], [[0.9, 0.3, 0.1], [-0.2, 0.1, -1.0]]])
    centers /= np.linalg.norm(centers, axis=-1, keepdims=True)
    shares = np.array([[0.6, 0.4], [0.5, 0.5]])
    heights = np.exp(_CONCENTRATION * (np.einsum("dcx,nx->dcn", centers, directions) - 1.0))
    return np.einsum("dc,dcn->dn", shares, heights)


def great_circle_distances(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the geodesic distances between all points on a sphere around the origin, (n, n)."""
    radii = np.linalg.norm(points, axis=1)
    directions = points / radii[:, None]
    return radii.mean() * np.arccos(np.clip(directions @ directions.T, -1.0, 1.0))


def _with_unit_area(vertices: NDArray[np.float64], faces: NDArray[np.int64]) -> NDArray[np.float64]:
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    return vertices / np.sqrt(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())
