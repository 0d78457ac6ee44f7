# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh laid on another, and how near to home the way there and back ends."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.edges import vertex_components
from ...geometry.facing_points import FacingPointFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import vertex_normals
from ...geometry.registration import Registration, Stage
from ...geometry.surface_projection import drawn_along_normals
from ...geometry.unit_shape import UnitShape
from ...progress import Control
from .carriers import Carrier
from .mesh_parts import renumbered, with_others


@dataclass(frozen=True)
class Laid:
    """A shape laid on another.

    Attributes
    ----------
    points : (n, 3) float64
        Where the vertices of its mesh lie.
    trust : (n,) float64
        How far that is trusted, 0 to 1.
    """

    points: NDArray[np.float64]
    trust: NDArray[np.float64]


@dataclass(frozen=True)
class Registered:
    """A mesh that has been laid on another.

    Attributes
    ----------
    mesh, target : TriangleMesh
        The two.
    own : (m,) int64
        Vertices of the mesh of which it is known where they lie.
    faces : (t, 3) int64
        Triangles between those, by their places in `own`.
    known : (m, 3) float64
        Where these lie.
    laid : Registration
        Knows how well they fit.
    """

    mesh: TriangleMesh
    own: NDArray[np.int64]
    faces: NDArray[np.int64]
    target: TriangleMesh
    known: NDArray[np.float64]
    laid: Registration

    @cached_property
    def points(self) -> NDArray[np.float64]:
        """Where all vertices lie, (n, 3)."""
        return with_others(self.mesh.vertices, self.own, self.known)

    def drawn(self, control: Control) -> NDArray[np.float64]:
        """Return the same, (n, 3), drawn to the target along the normals."""
        drawn = drawn_along_normals(TriangleMesh(self.known, self.faces), self.target, control)
        return with_others(self.mesh.vertices, self.own, drawn)


def registered(
    source: Carrier,
    target: Carrier,
    start: Laid,
    pairs: NDArray[np.int64],
    stages: tuple[Stage, ...],
    control: Control,
) -> Registered:
    """Lay one mesh on another from a start; components without one go with the others."""
    mesh = source.mesh
    labels = vertex_components(mesh)
    known = (start.trust > 0) & (labels >= 0)
    if not known.any():
        raise InputError("No point of {name} has a counterpart on {other}.", name=source.name, other=target.name)
    own = np.flatnonzero((labels >= 0) & np.isin(labels, labels[known]))
    part = TriangleMesh(mesh.vertices[own], renumbered(mesh.faces, own, len(mesh.vertices)))
    shape, other = UnitShape.of(part), UnitShape.of(target.mesh)
    size = np.sqrt(target.mesh.area)
    center = target.mesh.vertices[0] - size * other.vertices[0]
    ours = pairs[np.isin(pairs[:, 0], own)]
    ours = np.stack([np.searchsorted(own, ours[:, 0]), ours[:, 1]], axis=1)
    laid = Registration(shape, other, ours, (start.points[own] - center) / size, start.trust[own])
    for stage in stages:
        for _ in range(stage.rounds):
            control.check()
            laid.advance(replace(stage, rounds=1))
    return Registered(mesh, own, part.faces, target.mesh, size * laid.points + center, laid)


def home_distances(source: Carrier, target: Carrier, there: NDArray[np.float64], back: NDArray[np.float64]) -> NDArray:
    """Return how far from home the way there and back ends, (n,), in sizes of the source."""
    mesh, other = source.mesh, target.mesh
    images = FacingPointFinder(other).find(there, vertex_normals(there, mesh.faces))
    return np.linalg.norm(images.interpolated(back[other.faces]) - mesh.vertices, axis=1) / source.size
