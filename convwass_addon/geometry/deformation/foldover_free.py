# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Deform triangles in the plane with some vertices held, without turning any triangle over.

V. Garanzha, I. Kaporin, L. Kudryavtseva, F. Protais, N. Ray and D. Sokolov, "Foldover-free maps in 50 lines of code",
ACM Transactions on Graphics 40(4), 2021.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array

from ...progress import UNINTERRUPTED, Control
from ..algebra.factorization import Factorization, factorize
from ..meshes.edges import vertex_components
from ..meshes.laplacian import laplacian
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import doubled_areas

# Weight of the change of area beside that of angles.
_AREA = 0.5

UNDISTORTED = 2.0 + 2.0 * _AREA
"""Energy of triangles that keep their form, the least one."""

# Largest energy of a triangle that counts in the distortion.
_MOST = 100.0
# Rounds in which triangles are turned back, steps of the minimizer per round, and the relative decrease of the energy
# per round below which the minimum is reached, and per step below which a round ends.
_ROUNDS, _STEPS, _DECREASE, _LEAST_DECREASE = 20, 60, 0.01, 1e-4
# Width e of the transition between triangles that are turned over and those that are not, relative to the determinant
# of the worst one, and its least value.
_WIDTH, _LEAST_WIDTH = 0.2, 1e-6
# Least area of a connected component after the deformation, relative to that before: a hundredth of that of a point.
_LEAST_AFTER = 1e-7
# Steps that the quasi-Newton method remembers, and of the line search: the share of the expected decrease that is
# enough, and the largest number of times that a step is halved.
_REMEMBERED, _ENOUGH, _HALVINGS = 10, 1e-4, 30


@dataclass(frozen=True)
class DeformedTriangles:
    """Triangles deformed in the plane.

    Attributes
    ----------
    points : (n, 2) float64
        Positions of the vertices.
    distortion : float
        Mean energy, with that of every triangle limited to 100, which those have that are turned over. Similarities
        have 3.
    """

    points: NDArray[np.float64]
    distortion: float


def foldover_free(
    mesh: TriangleMesh, start: NDArray[np.float64], held: NDArray[np.bool_], control: Control = UNINTERRUPTED
) -> DeformedTriangles:
    """Move vertices in the plane so that the triangles are distorted least.

    With the Jacobian matrix J of a triangle, of determinant D, the energy per area is (|J|^2 + w (D^2 + 1)) / h(D),
    where h(D) = (D + sqrt(e^2 + D^2)) / 2. For e = 0 it is infinite for triangles that are turned over; e becomes
    smaller as these become fewer.

    Parameters
    ----------
    mesh : TriangleMesh
        At rest, in the plane z = 0, facing up.
    start : (n, 2)
        Positions of the vertices, possibly with triangles turned over.
    held : (n,) bool
        Vertices that keep their positions.
    control : Control
        Stops the work.
    """
    labels = vertex_components(mesh)
    # The first step of the minimizer depends on the scale.
    center, size = start.mean(axis=0), mesh.root_area
    # Components do not depend on each other; one that is difficult would keep the others from ending.
    points, distortion = (start - center) / size, 0.0
    for component in range(labels.max(initial=-1) + 1):
        own = np.flatnonzero(labels == component)
        number = np.zeros(len(labels), np.int64)
        number[own] = np.arange(len(own))
        part = TriangleMesh(mesh.vertices[own], number[mesh.faces[labels[mesh.faces[:, 0]] == component]])
        found = _connected(part, points[own], held[own], control)
        points[own] = found.points
        distortion += found.distortion * part.area / mesh.area
    return DeformedTriangles(np.where(held[:, None], start, center + size * points), distortion)


def _connected(
    mesh: TriangleMesh, start: NDArray[np.float64], held: NDArray[np.bool_], control: Control
) -> DeformedTriangles:
    """Move the vertices of a connected mesh."""
    energy = _Energy.of(mesh, start)
    free = np.flatnonzero(~held)
    if not len(free):
        return DeformedTriangles(start, energy.limited(start))
    inner = factorize(csc_array(laplacian(mesh).matrix)[free][:, free])
    points, least, worst = start.copy(), np.inf, energy.determinants(start).min(initial=1.0)
    for _ in range(_ROUNDS):
        control.check()
        width = float(np.sqrt(_LEAST_WIDTH**2 + np.square(_WIDTH * np.clip(worst, -1.0, 0.0))))
        points, reached = _minimized(energy, points, free, width, inner)
        before, worst = worst, energy.determinants(points).min(initial=1.0)
        # Triangles all of whose corners are held may remain turned over.
        if reached > (1.0 - _DECREASE) * least and (worst > 0.0 or worst <= (1.0 - _DECREASE) * before):
            break
        least = reached
    return DeformedTriangles(points, energy.limited(points))


def _minimized(
    energy: _Energy, points: NDArray[np.float64], free: NDArray[np.int64], width: float, inner: Factorization
) -> tuple[NDArray[np.float64], float]:
    """Minimize the energy by L-BFGS, preconditioned by the Laplacian of the free vertices; also return the energy."""
    value, gradient = energy.at(points, width)
    gradient = gradient[free]
    steps: list[tuple[NDArray[np.float64], NDArray[np.float64], float]] = []
    for _ in range(_STEPS):
        direction = -_inverse_hessian(gradient, steps, inner)
        slope = float((direction * gradient).sum())
        share, moved = 1.0, points.copy()
        for _ in range(_HALVINGS):
            moved[free] = points[free] + share * direction
            found, after = energy.at(moved, width)
            if found <= value + _ENOUGH * share * slope:
                break
            share *= 0.5
        else:
            break
        change, difference = share * direction, after[free] - gradient
        curvature = float((change * difference).sum())
        if curvature > 0.0:
            steps = [*steps[1 - _REMEMBERED :], (change, difference, curvature)]
        decrease = value - found
        points, value, gradient = moved, found, after[free]
        if decrease < _LEAST_DECREASE * value:
            break
    return points, value


def _inverse_hessian(
    gradient: NDArray[np.float64],
    steps: list[tuple[NDArray[np.float64], NDArray[np.float64], float]],
    inner: Factorization,
) -> NDArray[np.float64]:
    """Multiply a gradient by the approximate inverse Hessian: the two loops of L-BFGS."""
    result, shares = gradient.copy(), []
    for change, difference, curvature in reversed(steps):
        shares.append(float((change * result).sum()) / curvature)
        result -= shares[-1] * difference
    result = inner.solve_columns(result)
    if steps:
        _, difference, curvature = steps[-1]
        smooth = inner.solve_columns(difference)
        result *= curvature / float((difference * smooth).sum())
    for (change, difference, curvature), share in zip(steps, reversed(shares), strict=True):
        result += (share - float((difference * result).sum()) / curvature) * change
    return result


@dataclass(frozen=True)
class _Energy:
    """Triangles at rest, without those of no area.

    Attributes
    ----------
    gradient : (2 m, n) csr_array
        Gradient on every triangle, scaled to the area that it should have: derivatives along x first, then along y.
    transposed : (n, 2 m) csr_array
        The same matrix, transposed.
    areas : (m,) float64
        Shares of the area.
    """

    gradient: csr_array
    transposed: csr_array
    areas: NDArray[np.float64]

    @classmethod
    def of(cls, mesh: TriangleMesh, start: NDArray[np.float64]) -> _Energy:
        corners = mesh.corners[..., :2]
        doubled = doubled_areas(corners)
        kept = doubled > 1e-12 * np.abs(doubled).sum()
        faces, corners, doubled = mesh.faces[kept], corners[kept], doubled[kept]
        # The area inside a held outline, by the signed areas of its triangles, does not depend on the other vertices.
        rest, after = float(doubled.sum()), float(doubled_areas(start[faces]).sum())
        opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
        scale = np.sqrt(max(after, _LEAST_AFTER * rest) / rest)
        across = np.stack([-opposite[..., 1], opposite[..., 0]]) / (doubled[:, None] * scale)
        rows = np.repeat(np.arange(2 * len(faces)), 3)
        columns = np.tile(faces.ravel(), 2)
        gradient = csr_array((across.ravel(), (rows, columns)), shape=(2 * len(faces), len(start)))
        return cls(gradient, csr_array(gradient.T), doubled / rest)

    def _jacobians(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
        """Return the entries of the Jacobian matrices, row by row, (m,) each."""
        (a, c), (b, d) = (self.gradient @ points).reshape(2, -1, 2).transpose(0, 2, 1)
        return a, b, c, d

    def determinants(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the determinants of the Jacobian matrices, (m,)."""
        a, b, c, d = self._jacobians(points)
        return a * d - b * c

    def limited(self, points: NDArray[np.float64]) -> float:
        """Return the energy of vertices, with that of triangles limited, and largest for those turned over."""
        a, b, c, d = self._jacobians(points)
        determinants = a * d - b * c
        total = a * a + b * b + c * c + d * d + _AREA * (np.square(determinants) + 1.0)
        is_bad = total >= _MOST * determinants
        return float(self.areas @ np.where(is_bad, _MOST, total / np.where(is_bad, 1.0, determinants)))

    def at(self, points: NDArray[np.float64], width: float) -> tuple[float, NDArray[np.float64]]:
        """Return the energy of vertices and its gradient, (n, 2)."""
        a, b, c, d = self._jacobians(points)
        determinants = a * d - b * c
        root = np.sqrt(width**2 + np.square(determinants))
        bounded = 0.5 * (determinants + root)
        # For large negative determinants, the sum above loses all digits.
        low = determinants < 0.0
        bounded[low] = 0.5 * width**2 / (root[low] - determinants[low])
        slope = bounded / root
        total = a * a + b * b + c * c + d * d + _AREA * (np.square(determinants) + 1.0)
        energy = float(self.areas @ (total / bounded))
        along = self.areas * (2.0 * _AREA * determinants - total * slope / bounded) / bounded
        share = 2.0 * self.areas / bounded
        # Derivatives by the entries of the Jacobian matrices; those of the determinants are the cofactors.
        by_x = np.stack([share * a + along * d, share * c - along * b], axis=1)
        by_y = np.stack([share * b - along * c, share * d + along * a], axis=1)
        return energy, self.transposed @ np.concatenate([by_x, by_y])
