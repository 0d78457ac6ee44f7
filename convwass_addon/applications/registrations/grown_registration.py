# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register a shape to another from where they coincide, outward along the limbs.

Maps distinguish limbs by local properties, and those of an octopus are all alike. But where the bodies of two poses
coincide, limbs begin at the same places, so that registered parts lead to their neighbors.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from ...geometry.algebra.rotations import nearest_rotations
from ...geometry.deformation.registration import Registration, Stage
from ...progress import Control
from .carriers import Carrier
from .coinciding_places import coinciding_region

# Bodies coincide if at least this fraction of their surfaces does.
_ENOUGH = 0.25
# Advance of the front per step, in sizes of the surface, and the registration of what it has reached. Of the eight arms
# of an octopus that changes its pose, six or seven find their places, and two neighboring ones are exchanged (the
# benchmark's "octopus moves").
_STEP, _STAGES = 0.03, (Stage(100.0, 0.0, 0.05, 3),)
# Closest points further away, in sizes, are ignored: they belong to parts that have not been reached.
_REACH = 0.1
_SETTLING = (Stage(100.0, 0.0, 0.04, 4),)
# Number of vertices at the front that determine the motion of what lies beyond.
_AT_FRONT = 24


def grown_points(own: Carrier, other: Carrier, control: Control) -> NDArray[np.float64] | None:
    """Register one shape to another by growing.

    Parameters
    ----------
    own, other : Carrier
        Carriers with few vertices.
    control : Control
        Stops the work.

    Returns
    -------
    (n, 3) float64 or None
        Positions of the registered vertices; None if too little of the shapes coincides as they stand.
    """
    mesh = own.mesh
    core, _ = coinciding_region(mesh, mesh.vertices, other.mesh, other.mesh.vertices)
    if mesh.vertex_areas @ core < _ENOUGH * mesh.area:
        return None
    shape, target = own.unit, other.unit
    center = other.mesh.vertices[0] - other.mesh.root_area * target.vertices[0]
    laid = Registration(shape, target, np.empty((0, 2), np.int64), (mesh.vertices - center) / other.mesh.root_area)
    # Closest points must not attract the front to parts that it has not reached yet.
    laid.reach = _REACH
    graph = shape.graph
    away = dijkstra(graph, indices=np.flatnonzero(core), min_only=True)
    farthest = away[np.isfinite(away)].max()
    for front in np.arange(0.0, farthest + _STEP, _STEP):
        reached = away <= front
        laid.pulled = reached.astype(np.float64)
        laid.advance(_STAGES, control)
        beyond = ~reached & np.isfinite(away)
        if beyond.any():
            _lead_on(laid, shape.vertices, graph, reached, beyond)
    laid.pulled, laid.reach = np.ones(len(away)), np.inf
    laid.advance(_SETTLING, control)
    return other.mesh.root_area * laid.points + center


def _lead_on(
    laid: Registration,
    rest: NDArray[np.float64],
    graph: csr_array,
    reached: NDArray[np.bool_],
    beyond: NDArray[np.bool_],
) -> None:
    """Move what lies beyond the front rigidly with the nearest part of the front."""
    inside = np.flatnonzero(reached)
    sources = dijkstra(graph, indices=inside, min_only=True, return_predecessors=True)[2][beyond]
    used, place = np.unique(sources, return_inverse=True)
    around = inside[cKDTree(rest[inside]).query(rest[used], min(_AT_FRONT, len(inside)))[1].reshape(len(used), -1)]
    here, there = rest[around], laid.points[around]
    middles = here.mean(axis=1), there.mean(axis=1)
    moments = np.einsum("uki,ukj->iju", there - middles[1][:, None], here - middles[0][:, None])
    turns = np.moveaxis(nearest_rotations(moments).rotations, 2, 0)
    offsets = rest[beyond] - middles[0][place]
    laid.points[beyond] = np.einsum("nij,nj->ni", turns[place], offsets) + middles[1][place]
