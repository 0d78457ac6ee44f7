# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Vertices from deformation gradients of the triangles, by a prefactored Poisson system.

Y. Yu et al., "Mesh Editing with Poisson-Based Gradient Field Manipulation", ACM Transactions on Graphics 23(3), 2004;
D. Xu et al., "Poisson Shape Interpolation", ACM Symposium on Solid and Physical Modeling, 2005.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array, diags_array

from ..algebra.factorization import Factorization, factorize
from ..arrays.label_sums import label_sums
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import cross_coordinates
from .edge_energy import EdgeEnergy

# Default weight per area, on a surface of unit area, that pulls vertices to their anchors: just enough to fix the
# position of every component.
_ANCHORING = 1e-4
# Thinner triangles, by area over squared longest edge, have no gradient of their own.
_THIN = 1e-9
# Thin parts keep at least this fraction of their thickness.
_LEAST_THICKNESS = 0.25
# Smaller stretches count as this one, so that their logarithm is finite.
_LEAST_STRETCH = 1e-6


@dataclass(frozen=True)
class Links:
    """Springs between vertices that keep components of a mesh together, and the two sides of thin parts apart.

    Attributes
    ----------
    ends : (k, 2) int64
        Pairs of vertices.
    weights : (k,) float64
        Weight of each link; an edge between two equilateral triangles has 0.58.
    across : (k,) bool
        Which links lead across a thin part, from one side to the other.
    """

    ends: NDArray[np.int64]
    weights: NDArray[np.float64]
    across: NDArray[np.bool_]

    @classmethod
    def none(cls) -> Links:
        """Return no links at all."""
        return cls(np.empty((0, 2), np.int64), np.empty(0), np.empty(0, bool))

    def followed_by(self, others: Links) -> Links:
        """Return these links and others."""
        pairs = (self.ends, others.ends), (self.weights, others.weights), (self.across, others.across)
        return Links(*(np.concatenate(pair) for pair in pairs))

    def vectors(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the vector of every link, (k, 3), from its second end to its first, at positions of all vertices."""
        return points[self.ends[:, 0]] - points[self.ends[:, 1]]

    def kept_across(self, rest: NDArray[np.float64], vectors: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return vectors that leave the sides of thin parts where they are, at some distance from each other.

        Parameters
        ----------
        rest, vectors : (k, 3)
            The vector of every link at rest, and deformed but not rotated.
        """
        lengths = np.linalg.norm(rest, axis=1)
        directions = rest / np.maximum(lengths, np.finfo(float).tiny)[:, None]
        missing = _LEAST_THICKNESS * lengths - np.einsum("kd,kd->k", vectors, directions)
        return vectors + np.where(self.across, np.maximum(missing, 0.0), 0.0)[:, None] * directions


def deformation_gradients(
    rest: NDArray[np.float64], moved: NDArray[np.float64], faces: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the matrices, (m, 3, 3), that take triangles and their normals from rest to the moved positions.

    A normal scales with the square root of its triangle's area (R. Sumner and J. Popovic, "Deformation Transfer for
    Triangle Meshes", SIGGRAPH 2004). Triangles without area at rest get the identity.

    Parameters
    ----------
    rest, moved : (n, 3)
        Positions of the vertices.
    faces : (m, 3) int64
        Triangles.
    """
    one, other, normal, doubled = _frames(rest, faces)
    longest = np.maximum(np.square(one).sum(axis=0), np.square(other).sum(axis=0))
    regular = doubled > _THIN * longest
    doubled = np.where(regular, doubled, 1.0)
    # The rows of the inverse of the matrix whose columns are both edges and the normal over the root of its length.
    squared, rooted = doubled**2, doubled**1.5
    rows = _cross(other, normal) / squared, _cross(normal, one) / squared, normal / rooted
    moved_one, moved_other, moved_normal, moved_doubled = _frames(moved, faces)
    columns = moved_one, moved_other, moved_normal / np.sqrt(np.where(moved_doubled > 0.0, moved_doubled, 1.0))
    gradients = np.empty((len(faces), 3, 3))
    for i in range(3):
        for j in range(3):
            gradients[:, i, j] = sum(column[i] * row[j] for column, row in zip(columns, rows, strict=True))
    gradients[~regular] = np.eye(3)
    return gradients


def logarithmic_stretches(gradients: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest absolute logarithmic stretch in every triangle, (m,), from :func:`deformation_gradients`."""
    # The stretch of the normal is the geometric mean of the other two, and so the middle one.
    sizes = np.linalg.svd(gradients, compute_uv=False)[:, [0, 2]]
    return np.abs(np.log(np.maximum(sizes, _LEAST_STRETCH))).max(axis=1)


def stretches_of(rest: TriangleMesh, moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest absolute logarithmic stretch in every triangle, (m,), apart from the scaling of the whole.

    Parameters
    ----------
    rest : TriangleMesh
        A mesh with an area.
    moved : (n, 3)
        Its vertices in other places.
    """
    scale = np.sqrt(TriangleMesh(moved, rest.faces).area / rest.area)
    return logarithmic_stretches(deformation_gradients(rest.vertices, moved, rest.faces) / scale)


def mean_stretch(rest: TriangleMesh, moved: NDArray[np.float64]) -> float:
    """Return the mean of :func:`stretches_of` by area at rest."""
    return float(rest.face_areas @ stretches_of(rest, moved) / rest.area)


def _frames(points: NDArray[np.float64], faces: NDArray[np.int64]) -> tuple[NDArray[np.float64], ...]:
    """Return two edges of every triangle, (3, m), their cross product, (3, m), and its length, (m,)."""
    # One contiguous array per coordinate, because NumPy is slow for many vectors of length three.
    first, second, third = np.ascontiguousarray(faces.T)
    columns = np.ascontiguousarray(points.T)
    one = np.stack([column.take(second) - column.take(first) for column in columns])
    other = np.stack([column.take(third) - column.take(first) for column in columns])
    normal = _cross(one, other)
    return one, other, normal, np.sqrt(np.square(normal).sum(axis=0))


def _cross(first: NDArray[np.float64], second: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the cross products of vectors given by coordinates, (3, m)."""
    return np.stack(cross_coordinates(first, second))


class PoissonDeformation:
    """Finds vertices whose triangles match given deformation gradients as closely as possible.

    They minimize sum_tij w_tij |(y_i - y_j) - G_t (x_i - x_j)|^2 over the edges of triangles, plus the same for links,
    plus a multiple of the squared distances from anchors. The system is factorized on first use, and again after
    pickling.

    Parameters
    ----------
    mesh : TriangleMesh
        Rest shape, of any topology.
    links : Links
        Links between its vertices.
    anchoring : float
        That multiple, per unit of area on a surface rescaled to area one: parts larger than the inverse of its square
        root follow their anchors. The default is so small that only the mean of the anchors matters.
    """

    def __init__(self, mesh: TriangleMesh, links: Links, anchoring: float = _ANCHORING) -> None:
        self.mesh, self.links = mesh, links
        self._energy = EdgeEnergy.of(mesh)
        area = max(mesh.area, np.finfo(float).tiny)
        # A vertex without triangles and links moves to its anchor.
        self._anchoring = anchoring * np.maximum(mesh.vertex_areas / area, 1e-9)
        self._factor: Factorization | None = None

    def __getstate__(self) -> dict[str, object]:
        """Drop the factorization, which cannot be pickled."""
        return {**self.__dict__, "_factor": None}

    def solve(
        self, gradients: NDArray[np.float64], link_vectors: NDArray[np.float64], anchors: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return the vertices, (n, 3).

        Parameters
        ----------
        gradients : (m, 3, 3)
            Target gradient of every triangle.
        link_vectors : (k, 3)
            Target vector of every link, from its second end to its first.
        anchors : (n, 3)
            Anchors of the vertices.
        """
        if self._factor is None:
            self._factor = factorize(self._system())
        right = self._energy.pulls(gradients) + self._anchoring[:, None] * anchors
        if len(self.links.ends):
            pulls = self.links.weights[:, None] * link_vectors
            one, other = self.links.ends.T
            right += label_sums(one, pulls, len(right))
            right -= label_sums(other, pulls, len(right))
        return self._factor.solve_columns(right)

    def _system(self) -> csc_array:
        count = len(self.mesh.vertices)
        one, other = self.links.ends.T
        one_way = coo_array((self.links.weights, (one, other)), shape=(count, count))
        both = (one_way + one_way.T).tocsc()
        diagonal = self._anchoring + np.asarray(both.sum(axis=0)).ravel()
        return csc_array(self._energy.stiffness + diags_array(diagonal) - both)
