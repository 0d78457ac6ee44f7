# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove folds of a mesh that has been deformed to lie on another surface.

Vertices around flipped triangles are moved to the equilibrium of springs between neighbors, with the other vertices
fixed, and then projected onto the surface; springs are weaker along long edges of the undeformed mesh. In the plane,
springs with positive stiffness cause no folds inside a convex boundary (W. T. Tutte, "How to draw a graph", 1963). On a
surface, a step is accepted only if it leaves fewer folds; otherwise the next step uses a larger neighborhood.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, csr_array, diags_array

from ..progress import UNINTERRUPTED, Control
from .facing_points import FacingPointFinder
from .factorization import factorize
from .mesh import TriangleMesh
from .normals import triangle_normals, vertex_normals

# Largest numbers of attempts, and of rings of neighbors.
_ATTEMPTS, _MOST_RINGS = 16, 5
# Triangles count as folded below this cosine between their normal and the surface's, and as collapsed below this
# fraction of their expected area.
_TURNED, _COLLAPSED = 0.1, 0.01


@dataclass(frozen=True)
class FoldFinder:
    """Finds flipped and collapsed triangles of a mesh on a surface.

    Attributes
    ----------
    rest : TriangleMesh
        The undeformed mesh.
    target : TriangleMesh
        The surface that the mesh is deformed to.
    finder : FacingPointFinder
        Nearest-point queries on the target.
    """

    rest: TriangleMesh
    target: TriangleMesh
    finder: FacingPointFinder

    @classmethod
    def of(cls, rest: TriangleMesh, target: TriangleMesh) -> FoldFinder:
        """Prepare queries."""
        return cls(rest, target, FacingPointFinder(target))

    def agreements(
        self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED, some: NDArray[np.int64] | None = None
    ) -> NDArray[np.float64]:
        """Return the cosine, (m,), between the normals of triangles, all or some, and the surface's below them."""
        corners = vertices[self._faces(some)]
        below = self.finder.find_closest(corners.mean(axis=1), control).triangles
        return np.einsum("md,md->m", triangle_normals(corners), triangle_normals(self.target.corners[below]))

    def collapsed(self, vertices: NDArray[np.float64], some: NDArray[np.int64] | None = None) -> NDArray[np.bool_]:
        """Tell which triangles, (m,), have lost nearly all of their area, relative to the areas of both shapes."""
        faces = self._faces(some)
        expected = _areas(self.rest.vertices[faces]) * (self.target.area / self.rest.area)
        return _areas(vertices[faces]) < _COLLAPSED * expected

    def folded(
        self, vertices: NDArray[np.float64], control: Control = UNINTERRUPTED, some: NDArray[np.int64] | None = None
    ) -> NDArray[np.bool_]:
        """Tell which triangles, (m,), are flipped, perpendicular to the surface, or collapsed."""
        return (self.agreements(vertices, control, some) < _TURNED) | self.collapsed(vertices, some)

    def _faces(self, some: NDArray[np.int64] | None) -> NDArray[np.int64]:
        return self.rest.faces if some is None else self.rest.faces[some]


def unfolded(
    rest: TriangleMesh, vertices: NDArray[np.float64], target: TriangleMesh, control: Control = UNINTERRUPTED
) -> NDArray[np.float64]:
    """Return the vertices, (n, 3), of a mesh on a surface with as few folds as possible.

    Parameters
    ----------
    rest : TriangleMesh
        The undeformed mesh, facing outward.
    vertices : (n, 3) float64
        Deformed positions on `target`. Vertices away from folds stay there.
    target : TriangleMesh
        The surface, facing outward.
    control : Control
        Stops the work.
    """
    folds, neighbors = FoldFinder.of(rest, target), _stiffness(rest)
    best, found, rings = vertices, folds.folded(vertices, control), 1
    for _ in range(_ATTEMPTS):
        control.check()
        if not found.any() or rings > _MOST_RINGS:
            break
        free = _around(rest.faces[found], neighbors, rings)
        tried, left = _relaxed(best, free, neighbors, folds), found.copy()
        touched = np.flatnonzero(np.isin(rest.faces, free).any(axis=1))
        left[touched] = folds.folded(tried, control, touched)
        if left.sum() < found.sum():
            best, found, rings = tried, left, 1
        else:
            rings += 1
    return best


def _relaxed(
    vertices: NDArray[np.float64], free: NDArray[np.int64], neighbors: csr_array, folds: FoldFinder
) -> NDArray[np.float64]:
    """Move some vertices to the equilibrium of their springs, and project them onto the surface."""
    rows = neighbors[free]
    own = np.zeros(len(vertices), bool)
    own[free] = True
    totals = np.asarray(rows.sum(axis=1)).ravel()
    # Makes the system regular even if a component has no fixed vertex.
    system = diags_array(totals * (1.0 + 1e-9)) - rows[:, free]
    pull = rows @ np.where(own[:, None], 0.0, vertices) + 1e-9 * totals[:, None] * vertices[free]
    moved = vertices.copy()
    moved[free] = factorize(csc_array(system)).solve(np.ascontiguousarray(pull.T)).T
    normals = vertex_normals(moved, folds.rest.faces)[free]
    moved[free] = folds.finder.find(moved[free], normals).interpolated(folds.target.corners)
    return moved


def _around(corners: NDArray[np.int64], neighbors: csr_array, rings: int) -> NDArray[np.int64]:
    """Return the vertices of some triangles and rings of neighbors around them."""
    chosen = np.zeros(neighbors.shape[0], bool)
    chosen[corners] = True
    for _ in range(rings):
        chosen |= (neighbors @ chosen.astype(np.float64)) > 0.0
    return np.flatnonzero(chosen)


def _stiffness(mesh: TriangleMesh) -> csr_array:
    """Return the inverse lengths of the edges, (n, n)."""
    tails, heads = mesh.faces.ravel(), np.roll(mesh.faces, -1, axis=1).ravel()
    apart = tails != heads
    tails, heads = tails[apart], heads[apart]
    lengths = np.linalg.norm(mesh.vertices[tails] - mesh.vertices[heads], axis=1)
    stiffness = 1.0 / np.maximum(lengths, 1e-6 * lengths.max(initial=1e-300))
    count = len(mesh.vertices)
    one_way = coo_array((stiffness, (tails, heads)), shape=(count, count)).tocsr()
    return csr_array(one_way + one_way.T)


def _areas(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
