# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register a mesh to another, and measure the round-trip error of two registrations."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.algebra.rotations import nearest_rotations
from ...geometry.deformation.registration import Registration, Stage
from ...geometry.deformation.surface_projection import drawn_along_normals
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.edges import faces_between, vertex_components
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import vertex_normals
from ...progress import Control
from .carriers import Carrier

# Number of vertices that determine the motion of a part without counterpart.
_AROUND = 40


@dataclass(frozen=True)
class Laid:
    """Positions of a shape's vertices on another shape.

    Attributes
    ----------
    points : (n, 3) float64
        Positions of its vertices.
    trust : (n,) float64
        Confidence in these positions, 0 to 1.
    """

    points: NDArray[np.float64]
    trust: NDArray[np.float64]


@dataclass(frozen=True)
class Registered:
    """A mesh that has been registered to another.

    Attributes
    ----------
    mesh, target : TriangleMesh
        The two meshes.
    own : (m,) int64
        Vertices of the mesh that were registered.
    faces : (t, 3) int64
        Triangles between these vertices, as indices in `own`.
    known : (m, 3) float64
        Positions of these vertices.
    laid : Registration
        The registration, which can be evaluated.
    """

    mesh: TriangleMesh
    own: NDArray[np.int64]
    faces: NDArray[np.int64]
    target: TriangleMesh
    known: NDArray[np.float64]
    laid: Registration

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Positions of all vertices, (n, 3); those that were not registered move with the others."""
        return _with_others(self.mesh.vertices, self.own, self.known)

    def drawn(self, control: Control) -> NDArray[np.float64]:
        """Return these positions, (n, 3), moved to the target along the normals."""
        drawn = drawn_along_normals(TriangleMesh(self.known, self.faces), self.target, control)
        return _with_others(self.mesh.vertices, self.own, drawn)


def registered(
    source: Carrier,
    target: Carrier,
    start: Laid,
    pairs: NDArray[np.int64],
    stages: tuple[Stage, ...],
    control: Control,
) -> Registered:
    """Register one mesh to another from a start; components without a start move with the others."""
    mesh = source.mesh
    labels = vertex_components(mesh)
    known = (start.trust > 0) & (labels >= 0)
    if not known.any():
        raise InputError("No point of {name} has a counterpart on {other}.", name=source.name, other=target.name)
    own = np.flatnonzero((labels >= 0) & np.isin(labels, labels[known]))
    part = TriangleMesh(mesh.vertices[own], faces_between(mesh.faces, own, len(mesh.vertices)))
    shape = source.unit if len(own) == len(mesh.vertices) else UnitShape.of(part)
    other = target.unit
    size = target.mesh.root_area
    center = target.mesh.vertices[0] - size * other.vertices[0]
    ours = pairs[np.isin(pairs[:, 0], own)]
    ours = np.stack([np.searchsorted(own, ours[:, 0]), ours[:, 1]], axis=1)
    laid = Registration(shape, other, ours, (start.points[own] - center) / size, start.trust[own])
    laid.advance(stages, control)
    return Registered(mesh, own, part.faces, target.mesh, size * laid.points + center, laid)


def _with_others(rest: NDArray[np.float64], own: NDArray[np.int64], moved: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move all other vertices like the moved ones around each, by similarity transforms, (n, 3)."""
    points = np.empty_like(rest)
    points[own] = moved
    others = np.setdiff1d(np.arange(len(rest)), own)
    if not len(others):
        return points
    nearest = cKDTree(rest[own]).query(rest[others], min(_AROUND, len(own)))[1].reshape(len(others), -1)
    before, after = rest[own][nearest], moved[nearest]
    here, there = before.mean(axis=1), after.mean(axis=1)
    before, after = before - here[:, None], after - there[:, None]
    fitted = nearest_rotations(np.einsum("nki,nkj->ijn", after, before))
    scales = fitted.traces / np.maximum(np.square(before).sum(axis=(1, 2)), np.finfo(float).tiny)
    turned = np.einsum("ijn,nj->ni", fitted.rotations, rest[others] - here)
    points[others] = there + np.maximum(scales, 0.0)[:, None] * turned
    return points


def home_distances(source: Carrier, target: Carrier, there: NDArray[np.float64], back: NDArray[np.float64]) -> NDArray:
    """Return the round-trip error of every vertex, (n,), in sizes of the source."""
    mesh, other = source.mesh, target.mesh
    images = target.finder.find(there, vertex_normals(there, mesh.faces))
    return np.linalg.norm(images.interpolated(back[other.faces]) - mesh.vertices, axis=1) / source.mesh.root_area
