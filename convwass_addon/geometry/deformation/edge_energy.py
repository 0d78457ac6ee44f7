# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""As-rigid-as-possible energy per triangle, with positive cotangent weights."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array

from ..meshes.mesh import TriangleMesh

# Limits of half cotangents. Without negative weights, solutions satisfy a maximum principle.
_LEAST_WEIGHT, _MOST_WEIGHT = 0.02, 20.0


@dataclass(frozen=True)
class EdgeEnergy:
    """Sum over triangles t and their edges ij of w_tij |(x_i - x_j) - G_t (v_i - v_j)|^2, with v the vertices.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh with the vertices v.
    weights : (m, 3) float64
        Weights of every triangle's edges, each opposite a corner: half the corner's cotangent, within limits.
    """

    mesh: TriangleMesh
    weights: NDArray[np.float64]

    @classmethod
    def of(cls, mesh: TriangleMesh) -> EdgeEnergy:
        """Compute the weights from the angles."""
        halves = np.empty((len(mesh.faces), 3))
        for place in range(3):
            apex, one, other = (mesh.corners[:, (place + step) % 3] for step in range(3))
            cosine = np.einsum("nd,nd->n", one - apex, other - apex)
            sine = np.linalg.norm(np.cross(one - apex, other - apex), axis=1)
            halves[:, place] = 0.5 * cosine / np.maximum(sine, 1e-12 * np.maximum(np.abs(cosine), 1e-300))
        return cls(mesh, np.clip(halves, _LEAST_WEIGHT, _MOST_WEIGHT))

    @cached_property
    def stiffness(self) -> csc_array:
        """The matrix L, (n, n), of the energy, which is minimal where L x = `pulls`; zero for isolated vertices."""
        faces, count = self.mesh.faces, len(self.mesh.vertices)
        ends = [(faces[:, (place + 1) % 3], faces[:, (place + 2) % 3]) for place in range(3)]
        rows, columns = (np.concatenate(part) for part in zip(*ends, strict=True))
        apart = rows != columns
        one_way = coo_array((self.weights.T.ravel()[apart], (rows[apart], columns[apart])), shape=(count, count))
        both = (one_way + one_way.T).tocsc()
        return csc_array(diags_array(np.asarray(both.sum(axis=0)).ravel()) - both)

    def pulls(self, gradients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the right-hand side for deformation gradients G, (m, 3, 3): G times the edges, summed per vertex."""
        faces, count = self.mesh.faces, len(self.mesh.vertices)
        pulls = np.zeros((3, count))
        for place in range(3):
            one, other = (place + 1) % 3, (place + 2) % 3
            edges = self.mesh.corners[:, one] - self.mesh.corners[:, other]
            wanted = self.weights[:, place, None] * np.einsum("nij,nj->ni", gradients, edges)
            for axis in range(3):
                pulls[axis] += np.bincount(faces[:, one], wanted[:, axis], count)
                pulls[axis] -= np.bincount(faces[:, other], wanted[:, axis], count)
        return pulls.T
