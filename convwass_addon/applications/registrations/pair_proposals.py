# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registrations of coarse meshes from several starts, and costs that compare them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotations import nearest_rotations
from ...geometry.arrays.weighted_quantile import weighted_quantile
from ...geometry.deformation.fusion import fused_choice
from ...geometry.deformation.poisson_deformation import stretches_of
from ...geometry.deformation.registration import AS_PLACED, Stage
from ...geometry.meshes.edges import edge_lengths, mesh_edges
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import vertex_normals
from ...progress import Control
from ..workers import both_ways
from .carriers import Carrier
from .laid_meshes import Laid, Registered, home_distances, registered
from .mirrored_sides import MirroredSides

# Stages of a registration: first close to the start, then as smooth as the surfaces permit. Tighter stages hardly
# reduce distances and flip triangles. Chosen by eye; `python3 run.py bench coherence` measures the effect.
FROM_MAP = (Stage(0.0, 100.0, 0.06, 3), Stage(20.0, 30.0, 0.05, 5), Stage(100.0, 5.0, 0.04, 5))
"""From a start that is nearly right."""
_FROM_PLACE = (*AS_PLACED, Stage(30.0, 0.0, 0.06, 6), Stage(100.0, 0.0, 0.04, 3))
_HEALING = (Stage(20.0, 30.0, 0.05, 4), Stage(100.0, 5.0, 0.04, 4))
# Costs of a vertex: round-trip error and distance, both in sizes of the surface, and logarithmic stretch. Each is
# scaled to one at these values, and limited to one.
_TRIP, _AWAY, _STRETCH = 0.15, 0.06, 1.0
# Cost of a vertex whose mirror image goes elsewhere than to its mirrored place. With 1, registrations of a dog or a cow
# to a bird gave up a symmetric start for one that merges left and right.
_LOPSIDED = 3.0
# Cost of an edge where two proposals are joined: their distance times the edge's length, both in sizes of the surface.
_SEAM = 1.0
# Two registrations agree if this fraction of the area has a round-trip error below the second number.
_MOST, _NEAR_HOME = 0.95, 0.06
# Smaller rotations between shapes, in radians, are ignored.
_TURNED = np.radians(30.0)


@dataclass(frozen=True)
class Proposal:
    """A registration of one shape to another, with its costs.

    Attributes
    ----------
    points : (n, 3) float64
        Positions of the vertices.
    costs : (n,) float64
        Cost of every vertex.
    misfit : float
        95th percentile of the costs by area, without stretch.
    inverse : Laid
        The inverse registration: the points that the other shape's vertices come from.
    """

    points: NDArray[np.float64]
    costs: NDArray[np.float64]
    misfit: float
    inverse: Laid


@dataclass(frozen=True)
class DraftPair:
    """Two coarse meshes that are registered to each other.

    Attributes
    ----------
    both : (Carrier, Carrier)
        The two meshes.
    pairs : (p, 2) int64
        Their corresponding vertices.
    control : Control
        Stops the work.
    """

    both: tuple[Carrier, Carrier]
    pairs: NDArray[np.int64]
    control: Control

    def registered(self, k: int, start: Laid, stages: tuple[Stage, ...]) -> Registered:
        """Register mesh k to the other one in some stages, from initial positions of its vertices."""
        pairs = self.pairs if k == 0 else self.pairs[:, ::-1]
        return registered(self.both[k], self.both[1 - k], start, pairs, stages, self.control)

    def judged(self, k: int, points: NDArray[np.float64]) -> Proposal:
        """Measure the costs of a registration of mesh k."""
        self.control.check()
        own, other = self.both[k], self.both[1 - k]
        mesh = own.mesh
        lying = TriangleMesh(points, mesh.faces)
        images = other.finder.find(points, vertex_normals(points, mesh.faces))
        there = other.mesh.vertex_normals
        origins = FacingPointFinder(lying).find(other.mesh.vertices, there)
        home = origins.interpolated(mesh.corners)
        trip = np.linalg.norm(images.interpolated(home[other.mesh.faces]) - mesh.vertices, axis=1) / own.mesh.root_area
        away = images.distances / other.mesh.root_area
        misfit = np.minimum(trip / _TRIP, 1.0) + np.minimum(away / _AWAY, 1.0)
        costs = misfit + np.minimum(_vertex_stretch(own, points) / _STRETCH, 1.0)
        missed = np.minimum(origins.distances / other.mesh.root_area / _AWAY, 1.0)
        inverse = Laid(home, np.exp(-np.square(missed + origins.interpolated(costs[mesh.faces][:, :, None])[:, 0])))
        return Proposal(points, costs, weighted_quantile(misfit, mesh.vertex_areas, _MOST), inverse)

    def proposed(self, k: int, start: Laid, stages: tuple[Stage, ...]) -> Proposal:
        """Register mesh k as :meth:`registered` does, and measure the costs."""
        return self.judged(k, self.registered(k, start, stages).points)

    def home_distances(self, k: int, found: Sequence[Proposal | Registered]) -> NDArray[np.float64]:
        """Return the round-trip errors of the vertices of mesh k, (n,), given the registrations of both meshes."""
        return home_distances(self.both[k], self.both[1 - k], found[k].points, found[1 - k].points)


def trusted(found: Proposal) -> Laid:
    """Return a registration with confidences that fall with the costs of the vertices."""
    return Laid(found.points, np.exp(-np.square(found.costs)))


def all_mended(drafts: DraftPair, first: list[Proposal]) -> list[list[Proposal]]:
    """Improve registrations from other starts, once more where they disagree after that; return all attempts."""

    def mended(k: int) -> Proposal:
        own, other = drafts.both[k], drafts.both[1 - k]
        placed = Laid(_placed(own, other, first[k]), np.ones(len(own.mesh.vertices)))
        return _mended(drafts, k, first[k], [(first[1 - k].inverse, FROM_MAP), (placed, _FROM_PLACE)])

    best = list(both_ways(mended))
    tries = [best]
    for k in (1, 0):
        if not agree(drafts, best, k):
            best = list(best)
            best[k] = _mended(drafts, k, best[k], [(best[1 - k].inverse, FROM_MAP)])
            tries.append(best)
    return tries


def _mended(drafts: DraftPair, k: int, best: Proposal, ways: list[tuple[Laid, tuple[Stage, ...]]]) -> Proposal:
    """Replace parts of a registration by those from other starts where these have lower costs."""
    for start, stages in ways:
        best = _fused(drafts.both[k], best, drafts.proposed(k, start, stages))
    return drafts.proposed(k, trusted(best), _HEALING)


def _fused(own: Carrier, one: Proposal, other: Proposal) -> Proposal:
    """Combine two proposals, taking the better one at every vertex."""
    mesh = own.mesh
    areas = mesh.vertex_areas / mesh.area
    edges = mesh_edges(mesh.faces)
    apart = np.linalg.norm(one.points - other.points, axis=1) / own.mesh.root_area
    lengths = edge_lengths(mesh.vertices, edges) / own.mesh.root_area
    seams = _SEAM * lengths * apart[edges].mean(axis=1)
    second = fused_choice(np.stack([areas * one.costs, areas * other.costs]), edges, seams)
    costs = np.where(second, other.costs, one.costs)
    # Neither proposal is reliable along a seam.
    torn = edges[second[edges[:, 0]] != second[edges[:, 1]]].ravel()
    np.maximum.at(costs, torn, np.minimum(apart[torn] / _AWAY, 1.0))
    return Proposal(np.where(second[:, None], other.points, one.points), costs, one.misfit, one.inverse)


def _vertex_stretch(own: Carrier, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest absolute logarithmic stretch, averaged over the triangles around every vertex, (n,)."""
    mesh = own.mesh
    stretch = stretches_of(mesh, points)
    corners, count = mesh.faces.ravel(), len(points)
    sums = np.bincount(corners, np.repeat(stretch, 3), count)
    return sums / np.maximum(np.bincount(corners, minlength=count), 1)


def _placed(own: Carrier, other: Carrier, found: Proposal) -> NDArray[np.float64]:
    """Return a shape translated and scaled to another, (n, 3); rotated only if the registration rotates it much."""
    mesh = own.mesh
    weights = mesh.vertex_areas * np.exp(-np.square(found.costs))
    weights = weights / weights.sum()
    here, there = mesh.vertices - weights @ mesh.vertices, found.points - weights @ found.points
    turn = nearest_rotations(np.einsum("n,ni,nj->ij", weights, there, here)[:, :, None]).rotations[:, :, 0]
    if np.trace(turn) > 1.0 + 2.0 * np.cos(_TURNED):
        turn = np.eye(3)
    centers = [part.area_center for part in (mesh, other.mesh)]
    return other.mesh.root_area / own.mesh.root_area * (mesh.vertices - centers[0]) @ turn.T + centers[1]


def total_cost(drafts: DraftPair, found: list[Proposal], sides: MirroredSides | None = None) -> float:
    """Return the mean cost of both registrations, including their round-trip errors and, with sides, asymmetries."""
    total = 0.0
    for k in (0, 1):
        costs = found[k].costs + np.minimum(drafts.home_distances(k, found) / _TRIP, 1.0)
        if sides is not None:
            costs = costs + _LOPSIDED * np.minimum(sides.apart(k, found[k].points) / _TRIP, 1.0)
        areas = drafts.both[k].mesh.vertex_areas
        total += float(areas @ costs / areas.sum())
    return total


def symmetrized(drafts: DraftPair, found: list[Proposal], sides: MirroredSides) -> list[Proposal]:
    """Improve registrations of symmetric shapes by taking, of every two mirrored places, what is better at one."""

    def improved(k: int) -> Proposal:
        points, costs = found[k].points, found[k].costs
        elsewhere = sides.mirrored(k, costs)
        start = np.where((elsewhere < costs)[:, None], sides.mirrored_map(k, points), points)
        trust = np.exp(-np.square(np.minimum(costs, elsewhere)))
        return drafts.proposed(k, Laid(start, trust), FROM_MAP)

    return list(both_ways(improved))


def evened(drafts: DraftPair, found: list[Proposal], sides: MirroredSides) -> list[Proposal]:
    """Make registrations symmetric where both shapes are, without registering them again."""

    def even(k: int) -> Proposal:
        return drafts.judged(k, sides.evened_map(k, found[k].points, found[k].costs))

    return list(both_ways(even))


def agree(
    drafts: DraftPair,
    found: Sequence[Proposal | Registered],
    k: int,
    share: float = _MOST,
    near: float = _NEAR_HOME,
) -> bool:
    """Return whether a fraction of the area has a small round-trip error."""
    return weighted_quantile(drafts.home_distances(k, found), drafts.both[k].mesh.vertex_areas, share) <= near
