# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A surface that resists bending and shear: its edges follow smooth fields of rotations and scales.

Rotations and scales are fitted to a neighborhood of every vertex (Z. Levi and C. Gotsman, "Smooth Rotation Enhanced
As-Rigid-As-Possible Mesh Animation", TVCG 21, 2015).
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array, vstack
from scipy.sparse.linalg import LinearOperator, cg

from ..algebra.factorization import Factorization, factorize
from ..algebra.kept_factor import KeptFactor
from ..algebra.rotations import nearest_rotations, nearest_rotations_in_plane
from ..meshes.laplacian import Laplacian
from ..meshes.mesh import is_level

# Relative residual at which conjugate gradients stop, and their largest number of iterations; the next round continues.
_RESIDUAL, _MOST_ITERATIONS = 1e-4, 60
# With a preconditioner from an earlier round: a new one takes as long as about this many iterations.
_FEW_ITERATIONS = 20
# Lower limit of the relative weight of edges that yield; without it, joints crumple.
_LEAST_SHARE = 0.02
# Least squared length of an edge, on the surface of unit area. With less, the squares of the strains of edges without
# length overflow.
_LEAST_SQUARE = 1e-100
# Vertices are held in place with at least this fraction of the stiffness of their edges, a thousand times what rounding
# leaves of it. Otherwise, systems of bodies that are too small to be held by their areas would be singular.
_LEAST_HELD = 1e-12


class ElasticSurface:
    """The edges of a surface and their elastic energy.

    Parameters
    ----------
    vertices : (n, 3) float64
        The surface at rest, of unit area.
    laplacian : Laplacian
        Its Laplacian.
    """

    def __init__(self, vertices: NDArray[np.float64], laplacian: Laplacian) -> None:
        matrix = laplacian.matrix
        entries = matrix.tocoo()
        rows, columns = entries.coords
        apart = rows != columns
        self._rows, self._columns, self._weights = rows[apart], columns[apart], -entries.data[apart]
        count = len(vertices)
        self._areas = laplacian.areas
        # Give every diagonal entry a place in the sparsity pattern, because springs are added there.
        self._matrix = (matrix + diags_array(np.ones(count))).tocsc()
        self._matrix.sort_indices()
        ends = np.repeat(np.arange(count), np.diff(self._matrix.indptr))
        self._diagonal = np.flatnonzero(self._matrix.indices == ends)
        self._matrix.data[self._diagonal] -= 1.0
        self._least_held = _LEAST_HELD * self._matrix.data[self._diagonal]
        self._edges = vertices[self._rows] - vertices[self._columns]
        self._is_level = is_level(vertices)
        self._sums = csr_array(
            (np.ones(len(self._rows)), (self._rows, np.arange(len(self._rows)))), shape=(count, len(self._rows))
        )
        self._moments = self._moment_matrix()
        self._squares = self._sums @ (self._weights * np.square(self._edges).sum(axis=1))
        self._blurs: dict[float, Factorization] = {}
        self._factor = KeptFactor()
        # Preconditioner of an earlier system with springs.
        self._nearly: Factorization | None = None

    def unsolved(self) -> ElasticSurface:
        """Return the same surface without preconditioners of earlier systems, on which rounding would depend."""
        other = copy(self)
        other._factor, other._nearly = KeptFactor(), None
        return other

    def _moment_matrix(self) -> csr_array:
        """Return the matrix, (3 n, n), that takes points to the moments of their edges about every vertex.

        With weights w and rest edges e, entry (j n + r, i) of its product with points p is the sum over the neighbors c
        of r of w_rc (p_r - p_c)_i (e_rc)_j. Half of its transpose takes rotations of the vertices to the weighted sums
        of rest edges that are rotated by the mean of their ends.
        """
        count = len(self._areas)
        parts = []
        for along in (self._weights[:, None] * self._edges).T:
            beside = csr_array((along, (self._rows, self._columns)), shape=(count, count))
            parts.append(diags_array(np.bincount(self._rows, along, count)) - beside)
        return csr_array(vstack(parts))

    def relaxed(
        self, points: NDArray[np.float64], weights: NDArray[np.float64], pulls: NDArray[np.float64], width: float
    ) -> NDArray[np.float64]:
        """Fit rotations to the points, then solve for points that balance elasticity and the pulls."""
        turned = np.moveaxis(self.fits(points, width), 2, 0).reshape(3 * len(points), 3)
        right = 0.5 * (self._moments.T @ turned) + pulls
        # Vertices without edges stay in place.
        loose = self._areas <= 0
        lacking = np.maximum(self._least_held - weights, 0.0)
        right += lacking[:, None] * points
        held = np.where(loose, 1.0, weights + lacking)
        right[loose] = points[loose]
        return self._factor.solve(self._with_diagonal(1.0, held), right, points)

    def relaxed_robustly(
        self,
        points: NDArray[np.float64],
        springs: NDArray[np.float64],
        pulls: NDArray[np.float64],
        width: float,
        give: float,
    ) -> NDArray[np.float64]:
        """Like :meth:`relaxed`, but small strain is spread while large strain stays where it is.

        The more the neighborhood of an edge is strained, the smaller its weight: the function of S. Geman and
        D. McClure, "Statistical Methods for Tomographic Image Reconstruction", Bulletin of the ISI 52, 1987, which
        Y. Yao et al., "Quasi-Newton Solver for Robust Non-Rigid Registration", CVPR 2020, use to register surfaces.
        Joints can then bend sharply without stretching the parts between them.

        Parameters
        ----------
        points : (n, 3)
            Current vertices.
        springs : (n, 3, 3)
            Symmetric positive semi-definite stiffness of every vertex's spring, in general anisotropic.
        pulls : (n, 3)
            The springs times their target points.
        width : float
            Size of the neighborhoods, on the surface of unit area.
        give : float
            Strain at which edges begin to yield.
        """
        turned = self._rotated_edges(points, width)
        shares = 1.0 / np.square(1.0 + self._strains(points, turned) / give**2)
        weights = self._weights * np.maximum(shares, _LEAST_SHARE)
        count, loose = len(points), self._areas <= 0
        one_way = coo_array((weights, (self._rows, self._columns)), shape=(count, count)).tocsc()
        matrix = csc_array(diags_array(np.asarray(one_way.sum(axis=1)).ravel()) - one_way)
        lacking = np.maximum(self._least_held - np.einsum("nii->n", springs), 0.0)
        springs = np.where(loose[:, None, None], np.eye(3), springs + lacking[:, None, None] * np.eye(3))
        pulls = pulls + lacking[:, None] * points
        right = np.where(loose[:, None], points, self._sums @ (weights[:, None] * turned) + pulls)
        system = _SpringSystem(matrix, springs)
        if self._nearly is not None:
            solution, is_converged = system.solved(right, points, self._nearly, _FEW_ITERATIONS)
            if is_converged:
                return solution
        self._nearly = factorize(system.scalar_part())
        return system.solved(right, points, self._nearly, _MOST_ITERATIONS)[0]

    def _strains(self, points: NDArray[np.float64], turned: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the mean squared strain around every edge, (e,)."""
        lengths = np.maximum(np.square(self._edges).sum(axis=1), _LEAST_SQUARE)
        squares = np.square(points[self._rows] - points[self._columns] - turned).sum(axis=1) / lengths
        sums = self._sums @ np.stack([self._weights * squares, self._weights], axis=1)
        means = sums[:, 0] / np.maximum(sums[:, 1], np.finfo(float).tiny)
        return 0.5 * (means[self._rows] + means[self._columns])

    def robust_strain(self, points: NDArray[np.float64], width: float, give: float) -> float:
        """Return :meth:`strain` with the contribution of every edge limited to that of a strain of `give`."""
        squares = self._strains(points, self._rotated_edges(points, width))
        bounded = squares / (1.0 + squares / give**2)
        return float(0.5 * (self._weights * np.square(self._edges).sum(axis=1)) @ bounded)

    def strain(self, points: NDArray[np.float64], width: float) -> float:
        """Return the energy of the difference between edges and their rotated and scaled rest edges."""
        moved = points[self._rows] - points[self._columns]
        rest = np.square(moved - self._rotated_edges(points, width)).sum(axis=1)
        return float(0.5 * (self._weights * rest).sum())

    def _rotated_edges(self, points: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Rest edges, rotated and scaled by the fits of their ends, (e, 3)."""
        fits = self.fits(points, width)
        return 0.5 * np.einsum("eij,ej->ei", fits[self._rows] + fits[self._columns], self._edges)

    def fits(self, points: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Return the best rotation times scale from rest to the current pose of each neighborhood, (n, 3, 3).

        A surface that lies in the plane z = constant, at rest and now, only turns within that plane: turned over, its
        parts could fold onto each other without any strain.

        Parameters
        ----------
        points : (n, 3)
            Current vertices.
        width : float
            Size of the neighborhoods, on the surface of unit area.
        """
        sums = np.moveaxis((self._moments @ points).reshape(3, len(points), 3), 2, 0).reshape(9, len(points))
        smooth = self.blurred(np.concatenate([sums, self._squares[None]]), width)
        nearest = nearest_rotations_in_plane if self._is_level and is_level(points) else nearest_rotations
        fitted = nearest(smooth[:9].reshape(3, 3, -1))
        scales = np.maximum(fitted.traces, 0.0) / np.maximum(smooth[9], np.finfo(float).tiny)
        return np.ascontiguousarray(np.moveaxis(scales * fitted.rotations, 2, 0))

    def blurred(self, columns: NDArray[np.float64], width: float) -> NDArray[np.float64]:
        """Return sums over neighborhoods of a size of `width` on the surface, (k, n), by one implicit heat step."""
        if width not in self._blurs:
            held = np.where(self._areas > 0, np.maximum(self._areas, width**2 * self._least_held), 1.0)
            self._blurs[width] = factorize(self._with_diagonal(width**2, held))
        return self._blurs[width].solve(np.ascontiguousarray(columns))

    def _with_diagonal(self, scale: float, values: NDArray[np.float64]) -> csc_array:
        """Return a multiple of the stiffness matrix with values added to its diagonal."""
        system = scale * self._matrix
        system.data[self._diagonal] += values
        return system


@dataclass(frozen=True)
class _SpringSystem:
    """A stiffness matrix plus a spring at every vertex, for points with three coordinates.

    Attributes
    ----------
    matrix : (n, n) csc_array
        Couples vertices, equally along all axes.
    springs : (n, 3, 3) float64
        Symmetric and positive semi-definite.
    """

    matrix: csc_array
    springs: NDArray[np.float64]

    def scalar_part(self) -> csc_array:
        """Return a similar system, (n, n), that is equal along all axes."""
        # A scalar between the largest and the smallest stiffness of every spring.
        own = np.linalg.eigvalsh(self.springs)[:, [0, 2]]
        return csc_array(self.matrix + diags_array(np.sqrt(np.maximum(own[:, 0], 1e-2 * own[:, 1]) * own[:, 1])))

    def solved(
        self, right: NDArray[np.float64], start: NDArray[np.float64], nearly: Factorization, most: int
    ) -> tuple[NDArray[np.float64], bool]:
        """Solve by conjugate gradients with a preconditioner; return whether `most` iterations suffice, too."""
        count = len(start)

        def product(vector: NDArray[np.float64]) -> NDArray[np.float64]:
            moved = vector.reshape(count, 3)
            return (self.matrix @ moved + np.einsum("nij,nj->ni", self.springs, moved)).ravel()

        def precondition(vector: NDArray[np.float64]) -> NDArray[np.float64]:
            return nearly.solve_columns(vector.reshape(count, 3)).ravel()

        shape = (3 * count, 3 * count)
        found, missing = cg(
            LinearOperator(shape, product, dtype=np.float64),
            right.ravel(),
            start.ravel(),
            rtol=_RESIDUAL,
            maxiter=most,
            M=LinearOperator(shape, precondition, dtype=np.float64),
        )
        return found.reshape(count, 3), missing == 0
