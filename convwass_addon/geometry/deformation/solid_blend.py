# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation between deformations of a solid in which parts rotate instead of shrinking towards the middle."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array, diags_array
from scipy.spatial.transform import Rotation

from ..algebra.factorization import Factorization, factorize
from ..algebra.rotations import nearest_rotations

_CORNERS = np.array(list(product((0, 1), repeat=3)))
_EDGES = tuple((a, b) for a in range(8) for b in range(a + 1, 8) if int(np.abs(_CORNERS[a] - _CORNERS[b]).sum()) == 1)
# Stiffness relative to a cell's that holds every connected component in place, too weak to fix more than its center.
_HOLD = 1e-7
# Collapsed and inverted cells count as compressed to this fraction of a length.
_LEAST = 0.1


class SolidNodes:
    """The corners of the grid cells of a solid, as nodes that a deformation moves.

    Parameters
    ----------
    mass : (nx, ny, nz) float64
        Mass of each cell; cells with positive mass belong to the solid.

    Attributes
    ----------
    positions : (n, 3) float64
        Positions of the nodes, in cells.
    corners : (c, 8) int64
        Indices of the nodes at the corners of every cell.
    mass : (c,) float64
        Mass of every cell.
    """

    def __init__(self, mass: NDArray[np.float64]) -> None:
        cells = np.argwhere(mass > 0)
        self.mass = mass[mass > 0]
        self._shape = tuple(size + 1 for size in mass.shape)
        flat = np.ravel_multi_index(np.moveaxis(cells[:, None] + _CORNERS, -1, 0), self._shape)
        nodes, corners = np.unique(flat, return_inverse=True)
        self.corners = corners.reshape(-1, 8)
        self.positions = np.stack(np.unravel_index(nodes, self._shape), axis=1).astype(np.float64)
        self._number = np.full(int(np.prod(self._shape)), -1, np.int64)
        self._number[nodes] = np.arange(len(nodes))

    def interpolation(self, points: NDArray[np.float64]) -> csr_array:
        """Return the interpolation matrix, (p, n), from the nodes to points, (p, 3), in cells of the solid."""
        low = np.clip(np.floor(points).astype(np.int64), 0, np.array(self._shape) - 2)
        share = points - low
        columns = self._number[np.ravel_multi_index(np.moveaxis(low[:, None] + _CORNERS, -1, 0), self._shape)]
        weights = np.where(_CORNERS, share[:, None], 1.0 - share[:, None]).prod(axis=2)
        rows = np.repeat(np.arange(len(points)), 8)
        return csr_array((weights.ravel(), (rows, columns.ravel())), shape=(len(points), len(self.positions)))


class SolidBlend:
    """Deformations of a solid and all interpolations between them.

    The gradient of every cell is split into a rotation and a stretch, F_j = R_j S_j. For deformations j with weights
    w_j the interpolated gradient is exp(sum_j w_j log R_j) (sum_j w_j S_j^(1/2))^2, where the undeformed solid has the
    remaining weight (power means of stretches: I. Dryden, A. Koloydenko and D. Zhou, "Non-Euclidean statistics for
    covariance matrices", Annals of Applied Statistics 3, 2009). With the stretches themselves, solids that become
    longer and thinner swell by up to two thirds on the way. Their logarithms would keep the volume, but limbs stay
    short for long, and nothing moves evenly.

    A Poisson equation yields the nodes that match these gradients best (D. Xu, H. Zhang, Q. Wang and H. Bao, "Poisson
    shape interpolation", SPM 2005, here on grid cells). Their center moves along a straight line. A weight of one
    reproduces the deformation.

    Parameters
    ----------
    nodes : SolidNodes
        The solid.
    deformed : sequence of (n, 3) float64
        The deformed nodes of each deformation, in cells.
    """

    def __init__(self, nodes: SolidNodes, deformed: Sequence[NDArray[np.float64]]) -> None:
        self.nodes = nodes
        self._deformed = list(deformed)
        gradients = [_gradients(nodes, images) for images in deformed]
        turns = [nearest_rotations(np.moveaxis(gradient, 0, 2)).rotations for gradient in gradients]
        self._turns = [Rotation.from_matrix(np.moveaxis(turn, 2, 0)).as_rotvec() for turn in turns]
        self._pulls = _pulls(nodes, nodes.positions)
        stretches = (np.einsum("jic,cjk->cik", *both) for both in zip(turns, gradients, strict=True))
        self._roots = [_root(stretch) for stretch in stretches]
        # What is left of the edges, because cells do not only turn and stretch.
        self._rests = [
            np.einsum("jic,ckj->cki", turn, _pulls(nodes, images)) - self._stretched(root)
            for turn, images, root in zip(turns, self._deformed, self._roots, strict=True)
        ]
        cells = np.arange(8 * len(nodes.corners))
        self._sums = csr_array((np.ones(len(cells)), (nodes.corners.ravel(), cells)))
        self._held = _HOLD * np.bincount(nodes.corners.ravel(), np.repeat(nodes.mass, 8))
        self._factor: Factorization | None = None

    def at(self, weights: Sequence[float]) -> NDArray[np.float64]:
        """Return the nodes, (n, 3) in cells, for a weight of each deformation; the weights sum to at most one."""
        own = 1.0 - sum(weights)
        count = len(self.nodes.corners)
        turn, root = np.zeros((count, 3)), np.tile(own * np.eye(3), (count, 1, 1))
        rest, middle = np.zeros(self._pulls.shape), own * self.nodes.positions
        for weight, turns, roots, rests, images in zip(
            weights, self._turns, self._roots, self._rests, self._deformed, strict=True
        ):
            turn += weight * turns
            root += weight * roots
            rest += weight * rests
            middle += weight * images
        pulls = self._stretched(root) + rest
        pulls = np.einsum("cij,ckj->cki", Rotation.from_rotvec(turn).as_matrix(), pulls)
        right = self._sums @ pulls.reshape(-1, 3) + self._held[:, None] * middle
        if self._factor is None:
            self._factor = factorize(self._system())
        return self._factor.solve_columns(right)

    def _stretched(self, root: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the summed edges at the corners of every cell, (c, 8, 3), after the squares of some stretches."""
        return np.einsum("cil,clj,ckj->cki", root, root, self._pulls, optimize=True)

    def _system(self) -> csr_array:
        """Laplacian of the edges of all cells, plus the term that fixes the center."""
        count = len(self.nodes.positions)
        low, high = (np.concatenate([self.nodes.corners[:, edge[end]] for edge in _EDGES]) for end in (0, 1))
        mass = np.tile(self.nodes.mass, len(_EDGES))
        links = coo_array(
            (np.tile(mass, 2), (np.concatenate([low, high]), np.concatenate([high, low]))), shape=(count, count)
        ).tocsc()
        return (diags_array(np.asarray(links.sum(axis=0)).ravel() + self._held) - links).tocsc()

    def __getstate__(self) -> dict[str, object]:
        # The factorization cannot be pickled, and is quick to recompute.
        return {**self.__dict__, "_factor": None}


def _gradients(nodes: SolidNodes, images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean deformation gradient of every cell, (c, 3, 3)."""
    return np.einsum("cki,kj->cij", images[nodes.corners], _CORNERS - 0.5) / 2.0


def _root(stretches: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the square roots of stretches, (c, 3, 3), of collapsed and inverted cells that of a small one."""
    sizes, axes = np.linalg.eigh(stretches)
    return np.einsum("cik,ck,cjk->cij", axes, np.sqrt(np.maximum(sizes, _LEAST)), axes)


def _pulls(nodes: SolidNodes, images: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum the deformed edges at the corners of every cell, (c, 8, 3), times the cell's mass."""
    at = images[nodes.corners]
    pulls = np.zeros_like(at)
    for low, high in _EDGES:
        edge = at[:, high] - at[:, low]
        pulls[:, high] += edge
        pulls[:, low] -= edge
    return pulls * nodes.mass[:, None, None]
