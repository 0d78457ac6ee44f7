# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Non-rigid registration of one surface to another, with smoothly varying rotations and scales.

The vertices Y of the source minimize sum_ij w_ij |(Y_i - Y_j) - s_ij R_ij (X_i - X_j)|^2 + pulls, where the rotations
and scales are fitted to neighborhoods around every vertex (O. Sorkine and M. Alexa, "As-Rigid-As-Possible Surface
Modeling", SGP 2007; smooth rotations after Z. Levi and C. Gotsman, "Smooth Rotation Enhanced As-Rigid-As-Possible Mesh
Animation", TVCG 21, 2015). The pulls come from corresponding pairs, an initial guess and, with increasing weight,
nearest points with similar normals, from source to target and back.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.label_sums import label_sums
from ..meshes.closest_points import ClosestPoints
from ..meshes.normals import vertex_normals
from ..meshes.point_tree import point_tree
from .unit_shape import TURN, UnitShape

# Chosen by eye; docs/performance, "Soft maps", lists what these and the other constants of soft maps achieve.
# A pair pulls like this multiple of the surface's area at weight one: firmly, compared with the nearest points below.
_PAIR_WEIGHT = 20.0
# Holds components of the source in place that nothing else constrains.
_HOLD = 1e-3
# Relative weight of the nearest points at vertices whose start has confidence zero.
_LEAST_PULL = 0.1
# Width and closeness for comparing results.
_JUDGED_WIDTH, _JUDGED_CLOSENESS = 0.05, 100.0


@dataclass(frozen=True)
class Stage:
    """A stage of the registration.

    Attributes
    ----------
    closeness : float
        Weight of the nearest points, per area.
    trust : float
        Weight of the initial guess, per area.
    width : float
        Size of the neighborhoods that share a rotation and scale, on the surface of unit area.
    rounds : int
        Number of iterations.
    give : float or None
        Strain at which the surface yields, so that strain concentrates where it bends; None to spread it.
    grip : float
        Fraction of the nearest points' weight that also resists sliding along the surface. Only used with `give`.
    """

    closeness: float
    trust: float
    width: float
    rounds: int
    give: float | None = None
    grip: float = 1.0


BY_PAIRS = (Stage(0.0, 0.0, 0.1, 10), Stage(3.0, 0.0, 0.1, 8), Stage(10.0, 0.0, 0.08, 8))
"""From pairs alone, three or more."""
AS_PLACED = (Stage(1.0, 0.0, 0.2, 6), Stage(3.0, 0.0, 0.1, 8), Stage(10.0, 0.0, 0.08, 8))
"""From the current placement, if the source is oriented like the target."""
BY_GUESS = (Stage(0.0, 100.0, 0.1, 3), Stage(30.0, 20.0, 0.06, 8))
"""From an initial guess for every vertex."""
SETTLING = (Stage(100.0, 0.0, 0.04, 8), Stage(300.0, 0.0, 0.03, 6))
"""From a nearly correct result."""
TO_THE_END = (Stage(30.0, 0.0, 0.06, 8), *SETTLING)
"""After any of the first three."""


@dataclass(frozen=True)
class _Pulls:
    """Points of the target that attract vertices of the source.

    Attributes
    ----------
    vertices : (k,) int64
        Vertices of the source, possibly repeated.
    weights : (k,) float64
    positions, normals : (k, 3) float64
        Positions and normals of the points.
    """

    vertices: NDArray[np.int64]
    weights: NDArray[np.float64]
    positions: NDArray[np.float64]
    normals: NDArray[np.float64]

    def weight_sums(self, count: int) -> NDArray[np.float64]:
        """Return the sum of weights at each of `count` vertices, (n,)."""
        return np.bincount(self.vertices, self.weights, count)

    def pulled(self, count: int) -> NDArray[np.float64]:
        """Return the sum of weighted positions at each of `count` vertices, (n, 3)."""
        return label_sums(self.vertices, self.weights[:, None] * self.positions, count)

    def springs(self, count: int, grip: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return springs, (n, 3, 3), with the fraction `grip` along the surface, and springs times targets, (n, 3)."""
        across = (1.0 - grip) * self.normals[:, :, None] * self.normals[:, None, :]
        springs = self.weights[:, None, None] * (across + grip * np.eye(3))
        pulls = np.einsum("kij,kj->ki", springs, self.positions)
        sums = label_sums(self.vertices, np.concatenate([springs.reshape(-1, 9), pulls], axis=1), count)
        return sums[:, :9].reshape(-1, 3, 3), sums[:, 9:]


class Registration:
    """The state of a registration of one surface to another.

    Parameters
    ----------
    source, target : UnitShape
        The surface that moves, and the one it is registered to.
    pairs : (k, 2) int64
        Corresponding vertices.
    start : (n, 3)
        Initial positions of the source's vertices.
    confidence : (n,), optional
        Confidence in the start of each vertex, 0 to 1, by default 1. The pull of the start is proportional to it. The
        weight of nearest points rises linearly with it, from a tenth at 0 to the full weight at 1.

    Attributes
    ----------
    points : (n, 3) float64
        Current positions of the vertices.
    pulled : (n,) float64
        Relative weight of the nearest points at every vertex.
    reach : float
        Nearest points farther away than this have no effect.
    """

    def __init__(
        self,
        source: UnitShape,
        target: UnitShape,
        pairs: NDArray[np.int64],
        start: NDArray[np.float64],
        confidence: NDArray[np.floating] | None = None,
    ) -> None:
        self.points = start.copy()
        self._guess = start
        self._source, self._target, self._pairs = source, target, pairs
        self._confidence = np.ones(len(start)) if confidence is None else confidence.astype(np.float64)
        self.pulled = _LEAST_PULL + (1.0 - _LEAST_PULL) * self._confidence
        self.reach = np.inf
        self._shape, self._samples = source.elastic.unsolved(), target.samples
        self._facing = target.mesh.face_normals
        self._target_normals = vertex_normals(target.vertices, target.mesh.faces)

    def advance(self, stages: Sequence[Stage], control: Control = UNINTERRUPTED) -> None:
        """Run some stages; `control` is checked in every round."""
        for stage in stages:
            for _ in range(stage.rounds):
                control.check()
                self._step(stage)

    def _step(self, stage: Stage) -> None:
        areas = self._source.areas
        trusted = stage.trust * self._confidence * areas
        held = trusted + _HOLD * areas
        pulls = trusted[:, None] * self._guess + _HOLD * areas[:, None] * self.points
        here, there = self._pairs.T
        np.add.at(held, here, _PAIR_WEIGHT)
        np.add.at(pulls, here, _PAIR_WEIGHT * self._target.vertices[there])
        found = self._closest(stage.closeness) if stage.closeness > 0 else []
        if stage.give is None:
            for near in found:
                held += near.weight_sums(len(areas))
                pulls += near.pulled(len(areas))
            self.points = self._shape.relaxed(self.points, held, pulls, stage.width)
            return
        springs = held[:, None, None] * np.eye(3)
        for near in found:
            own, aims = near.springs(len(areas), stage.grip)
            springs += own
            pulls += aims
        self.points = self._shape.relaxed_robustly(self.points, springs, pulls, stage.width, stage.give)

    def _closest(self, closeness: float) -> list[_Pulls]:
        """Return the pulls of the nearest points, from source to target and back."""
        normals = vertex_normals(self.points, self._source.mesh.faces)
        pulled = np.flatnonzero(self.pulled)
        found = self._samples.find(self.points[pulled], normals[pulled])
        facing = self._facing[found.triangles]
        agreement = np.maximum(np.einsum("nd,nd->n", facing, normals[pulled]), 0.0)
        positions = found.interpolated(self._target.mesh.corners)
        weights = (self.pulled * self._source.areas)[pulled] * closeness * agreement * (found.distances < self.reach)
        there = _Pulls(pulled, weights, positions, facing)
        nearest = self._nearest(normals)
        agreement = np.maximum(np.einsum("nd,nd->n", normals[nearest], self._target_normals), 0.0)
        near = np.square(self.points[nearest] - self._target.vertices).sum(axis=1) < self.reach**2
        weights = self.pulled[nearest] * closeness * self._target.areas * agreement * near
        return [there, _Pulls(nearest, weights, self._target.vertices, self._target_normals)]

    def _nearest(self, normals: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the source vertex nearest to each target vertex."""
        tree = point_tree(np.concatenate([self.points, TURN * normals], axis=1))
        return tree.query(np.concatenate([self._target.vertices, TURN * self._target_normals], axis=1))[1]

    def images(self) -> ClosestPoints:
        """Return the points on the target nearest to the source's current vertices."""
        return self._samples.find(self.points, vertex_normals(self.points, self._source.mesh.faces))

    def energy(self, give: float | None = None) -> float:
        """Return the remaining energy: strain, distances to the nearest points in both directions, and pair errors.

        If `give` is given, the contribution of every edge is limited to that of a strain of `give`.
        """
        normals = vertex_normals(self.points, self._source.mesh.faces)
        found = self._samples.find(self.points, normals)
        nearest = self._nearest(normals)
        there = np.square(self.points[nearest] - self._target.vertices).sum(axis=1)
        here, partners = self._pairs.T
        missed = np.square(self.points[here] - self._target.vertices[partners]).sum()
        apart = self._source.areas @ np.square(found.distances) + self._target.areas @ there
        if give is None:
            strain = self._shape.strain(self.points, _JUDGED_WIDTH)
        else:
            strain = self._shape.robust_strain(self.points, _JUDGED_WIDTH, give)
        return strain + _JUDGED_CLOSENESS * apart + _PAIR_WEIGHT * missed
