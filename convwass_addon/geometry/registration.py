# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Laying one surface over another: it is turned and scaled from place to place, as evenly as can be.

The vertices Y of the source minimize sum_ij w_ij |(Y_i - Y_j) - s_ij R_ij (X_i - X_j)|^2 + pulls, where the rotations
and scales are fitted to neighborhoods around every vertex (O. Sorkine and M. Alexa, "As-Rigid-As-Possible Surface
Modeling", SGP 2007; smooth rotations after Z. Levi and C. Gotsman, "Smooth Rotation Enhanced As-Rigid-As-Possible Mesh
Animation", TVCG 21, 2015). What pulls are pairs that belong together, a first guess, and, ever more, the closest points
of the target that face the same way, both from here to there and back.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from .closest_points import ClosestPoints
from .elastic_surface import ElasticSurface
from .facing_points import OrientedSamples
from .normals import triangle_normals, vertex_normals
from .unit_shape import UnitShape

# A pair pulls like this much of the surface's area at weight one; with the closest points' weights below that is firm.
_PAIR_WEIGHT = 20.0
# A normal that is turned by a right angle counts like this distance, on surfaces of unit area.
_TURN = 0.2
# Keeps pieces of the source where they are that nothing else holds.
_HOLD = 1e-3
# Closest points pull vertices whose start is not trusted at all by this share of their weight.
_LEAST_PULL = 0.1
# How starts are compared.
_JUDGED_WIDTH, _JUDGED_CLOSENESS = 0.05, 100.0


@dataclass(frozen=True)
class Stage:
    """A part of the way.

    Attributes
    ----------
    closeness : float
        Weight of the closest points, per area.
    trust : float
        Weight of the first guess, per area.
    width : float
        Size of the neighborhoods that turn and scale together, on the surface of unit area.
    rounds : int
        How many.
    """

    closeness: float
    trust: float
    width: float
    rounds: int


BY_PAIRS = (Stage(0.0, 0.0, 0.1, 10), Stage(3.0, 0.0, 0.1, 8), Stage(10.0, 0.0, 0.08, 8))
"""From pairs alone: three or more."""
AS_PLACED = (Stage(1.0, 0.0, 0.2, 6), Stage(3.0, 0.0, 0.1, 8), Stage(10.0, 0.0, 0.08, 8))
"""From where the source is, turned about as the target is."""
BY_GUESS = (Stage(0.0, 100.0, 0.1, 3), Stage(30.0, 20.0, 0.06, 8))
"""From a first guess for every vertex."""
SETTLING = (Stage(100.0, 0.0, 0.04, 8), Stage(300.0, 0.0, 0.03, 6))
"""From where it is nearly right."""
TO_THE_END = (Stage(30.0, 0.0, 0.06, 8), *SETTLING)
"""From any of the others."""


class Registration:
    """One surface on its way to another.

    Parameters
    ----------
    source, target : UnitShape
        What is moved, and where to.
    pairs : (k, 2) int64
        Vertices that belong together.
    start : (n, 3)
        Where the source's vertices begin.
    confidence : (n,), optional
        How far the start of each vertex is right, 0 to 1: the start pulls in proportion to it, and closest points pull
        where it is 0 with a tenth of the weight that they have where it is 1. By default 1 everywhere.

    Attributes
    ----------
    points : (n, 3) float64
        Where its vertices are now.
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
        self._pulled = _LEAST_PULL + (1.0 - _LEAST_PULL) * self._confidence
        self._shape = ElasticSurface(source)
        self._samples = OrientedSamples(target.mesh, _TURN)
        self._facing = triangle_normals(target.mesh.corners)
        self._target_normals = vertex_normals(target.vertices, target.mesh.faces)

    def advance(self, stage: Stage) -> None:
        """Go a part of the way."""
        for _ in range(stage.rounds):
            self._step(stage)

    def _step(self, stage: Stage) -> None:
        areas = self._source.areas
        trusted = stage.trust * self._confidence * areas
        weights = trusted + _HOLD * areas
        pulls = trusted[:, None] * self._guess + _HOLD * areas[:, None] * self.points
        if stage.closeness > 0:
            near, sums = self._closest(stage.closeness)
            weights = weights + self._pulled * near
            pulls += self._pulled[:, None] * sums
        here, there = self._pairs.T
        np.add.at(weights, here, _PAIR_WEIGHT)
        np.add.at(pulls, here, _PAIR_WEIGHT * self._target.vertices[there])
        self.points = self._shape.relaxed(self.points, weights, pulls, stage.width)

    def _closest(self, closeness: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return weights, (n,), and weighted positions, (n, 3), of the closest points here and there."""
        normals = vertex_normals(self.points, self._source.mesh.faces)
        found = self._samples.find(self.points, normals)
        agreement = np.einsum("nd,nd->n", self._facing[found.triangles], normals)
        weights = closeness * self._source.areas * np.maximum(agreement, 0.0)
        pulls = weights[:, None] * found.interpolated(self._target.mesh.corners)
        nearest = self._nearest(normals)
        agreement = np.einsum("nd,nd->n", normals[nearest], self._target_normals)
        back = closeness * self._target.areas * np.maximum(agreement, 0.0)
        weights += np.bincount(nearest, back, len(weights))
        for axis, column in enumerate(self._target.vertices.T):
            pulls[:, axis] += np.bincount(nearest, back * column, len(weights))
        return weights, pulls

    def _nearest(self, normals: NDArray[np.float64]) -> NDArray[np.int64]:
        """Return the source's vertex nearest to each of the target's."""
        tree = cKDTree(np.concatenate([self.points, _TURN * normals], axis=1))
        return tree.query(np.concatenate([self._target.vertices, _TURN * self._target_normals], axis=1))[1]

    def images(self) -> ClosestPoints:
        """Return the points of the target where the source's vertices have come to lie."""
        return self._samples.find(self.points, vertex_normals(self.points, self._source.mesh.faces))

    def energy(self) -> float:
        """Return what is left to be desired: strain, distances to the closest points both ways, and pairs missed."""
        normals = vertex_normals(self.points, self._source.mesh.faces)
        found = self._samples.find(self.points, normals)
        nearest = self._nearest(normals)
        there = np.square(self.points[nearest] - self._target.vertices).sum(axis=1)
        here, partners = self._pairs.T
        missed = np.square(self.points[here] - self._target.vertices[partners]).sum()
        apart = self._source.areas @ np.square(found.distances) + self._target.areas @ there
        return self._shape.strain(self.points, _JUDGED_WIDTH) + _JUDGED_CLOSENESS * apart + _PAIR_WEIGHT * missed
