# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A shape laid on another from where both coincide, growing outward along the limbs.

Maps tell limbs apart by what they look like, and those of an octopus all look alike. But where the bodies of two poses
coincide, limbs begin at the same places: what has been laid on the other shape leads on to what lies beside it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

from ...geometry.registration import Registration, Stage
from ...geometry.rotations import nearest_rotations
from ...geometry.surface_graph import surface_graph
from ...geometry.unit_shape import UnitShape
from ...progress import Control
from .carriers import Carrier
from .coinciding_places import coinciding_region

# Bodies coincide where at least this share of their surfaces does.
_ENOUGH = 0.25
# How far the front moves at a time, in sizes of the surface, and how what it has reached is laid on the other shape:
# of the eight arms of an octopus that changes its pose, six or seven find their places, and two that are side by side
# change them (the benchmark's "octopus moves").
_STEP, _STAGE = 0.03, Stage(100.0, 0.0, 0.05, 3)
# Closest points farther away, in sizes, belong to what has not been reached.
_REACH = 0.1
_SETTLING = Stage(100.0, 0.0, 0.04, 4)
# Vertices at the front that say how what lies beyond moves.
_AT_FRONT = 24


def grown_points(own: Carrier, other: Carrier, control: Control) -> NDArray[np.float64] | None:
    """Lay one shape on another by growing.

    Parameters
    ----------
    own, other : Carrier
        Of few vertices.
    control : Control
        Stops the work.

    Returns
    -------
    (n, 3) float64 or None
        Where the vertices come to lie; None where the shapes hardly coincide as they stand.
    """
    mesh = own.mesh
    core, _ = coinciding_region(mesh, mesh.vertices, other.mesh, other.mesh.vertices)
    if mesh.vertex_areas @ core < _ENOUGH * mesh.area:
        return None
    shape, target = UnitShape.of(mesh), UnitShape.of(other.mesh)
    center = other.mesh.vertices[0] - other.size * target.vertices[0]
    laid = Registration(shape, target, np.empty((0, 2), np.int64), (mesh.vertices - center) / other.size)
    # What the front has not reached yet must not draw it.
    laid.reach = _REACH
    graph = surface_graph(shape.mesh)
    away = dijkstra(graph, indices=np.flatnonzero(core), min_only=True)
    farthest = away[np.isfinite(away)].max()
    for front in np.arange(0.0, farthest + _STEP, _STEP):
        control.check()
        reached = away <= front
        laid.pulled = reached.astype(np.float64)
        laid.advance(_STAGE)
        beyond = ~reached & np.isfinite(away)
        if beyond.any():
            _lead_on(laid, shape.vertices, graph, reached, beyond)
    laid.pulled, laid.reach = np.ones(len(away)), np.inf
    laid.advance(_SETTLING)
    return other.size * laid.points + center


def _lead_on(
    laid: Registration,
    rest: NDArray[np.float64],
    graph: csr_array,
    reached: NDArray[np.bool_],
    beyond: NDArray[np.bool_],
) -> None:
    """Move what lies beyond the front rigidly with the nearest part of it."""
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
