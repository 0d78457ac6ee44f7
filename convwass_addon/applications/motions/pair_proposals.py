# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Coarse meshes laid on each other from several starts, and what is wrong with each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.facing_points import FacingPointFinder
from ...geometry.fusion import fused_choice
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import vertex_normals
from ...geometry.poisson_deformation import deformation_gradients
from ...geometry.registration import AS_PLACED, Stage
from ...geometry.rotations import nearest_rotations
from ...geometry.weighted_quantile import weighted_quantile
from ...progress import Control
from ..workers import both_ways
from .carriers import Carrier
from .laid_meshes import Laid, Registered, home_distances, registered
from .mesh_parts import mesh_edges

# From a start to the other surface: first as the start says, then as smooth as the surfaces allow. Tighter stages gain
# little closeness and turn triangles over. Chosen by eye; `python3 run.py bench coherence` measures what they give.
FROM_MAP = (Stage(0.0, 100.0, 0.06, 3), Stage(20.0, 30.0, 0.05, 5), Stage(100.0, 5.0, 0.04, 5))
"""From a start that is nearly right."""
_FROM_PLACE = (*AS_PLACED, Stage(30.0, 0.0, 0.06, 6), Stage(100.0, 0.0, 0.04, 3))
_HEALING = (Stage(20.0, 30.0, 0.05, 4), Stage(100.0, 5.0, 0.04, 4))
# What a place pays: for the way there and back and for its distance, both in sizes of the surface, and for the
# logarithm of its stretch. At these values it pays one, which is the most for each.
_TRIP, _AWAY, _STRETCH = 0.15, 0.06, 1.0
# An edge over which the proposals differ by the size of the surface pays so much per its share of that size.
_SEAM = 1.0
# For two shapes to agree, this share of the area must come so near to home.
_MOST, _NEAR_HOME = 0.95, 0.06
# Shapes that are turned by less than this against each other are taken as they stand, radians.
_TURNED = np.radians(30.0)


@dataclass(frozen=True)
class Proposal:
    """A shape laid on another, and how well.

    Attributes
    ----------
    points : (n, 3) float64
        Where its vertices lie.
    costs : (n,) float64
        What every vertex pays.
    misfit : float
        What 95 % of the area pay at most, stretch apart.
    inverse : Laid
        The way back that it makes: where the other's vertices come from.
    """

    points: NDArray[np.float64]
    costs: NDArray[np.float64]
    misfit: float
    inverse: Laid


def proposed(
    drafts: tuple[Carrier, Carrier],
    k: int,
    start: Laid,
    pairs: NDArray[np.int64],
    stages: tuple[Stage, ...],
    control: Control,
) -> Proposal:
    """Lay one of two coarse meshes on the other from a start.

    Parameters
    ----------
    drafts : (Carrier, Carrier)
        The two.
    k : int
        Which of them is laid on the other, 0 or 1.
    start : Laid
        Where its vertices begin.
    pairs : (p, 2) int64
        Its vertices and the other's that belong together.
    stages : tuple of Stage
        How.
    control : Control
        Stops the work.
    """
    own, other = drafts[k], drafts[1 - k]
    return judged(own, other, registered(own, other, start, pairs, stages, control).points, control)


def trusted(found: Proposal) -> Laid:
    """Return where a mesh lies, trusted the less, the more its vertices pay."""
    return Laid(found.points, np.exp(-np.square(found.costs)))


def all_mended(
    drafts: tuple[Carrier, Carrier],
    first: list[Proposal],
    both: tuple[NDArray[np.int64], NDArray[np.int64]],
    control: Control,
) -> list[list[Proposal]]:
    """Mend how coarse meshes lie on each other, once and where the two ways do not agree then; return all attempts."""

    def mended(k: int) -> Proposal:
        placed = Laid(_placed(drafts[k], drafts[1 - k], first[k]), np.ones(len(drafts[k].mesh.vertices)))
        ways = [(first[1 - k].inverse, FROM_MAP), (placed, _FROM_PLACE)]
        return _mended(drafts, k, first[k], ways, both[k], control)

    best = list(both_ways(mended))
    tries = [best]
    for k in (1, 0):
        if not agree(drafts, best, k):
            best = list(best)
            best[k] = _mended(drafts, k, best[k], [(best[1 - k].inverse, FROM_MAP)], both[k], control)
            tries.append(best)
    return tries


def _mended(
    drafts: tuple[Carrier, Carrier],
    k: int,
    best: Proposal,
    ways: list[tuple[Laid, tuple[Stage, ...]]],
    pairs: NDArray[np.int64],
    control: Control,
) -> Proposal:
    """Replace parts of a shape laid on the other by what comes of other starts, where that is better."""
    own, other = drafts[k], drafts[1 - k]
    for start, stages in ways:
        best = _fused(own, best, proposed(drafts, k, start, pairs, stages, control))
    return judged(own, other, registered(own, other, trusted(best), pairs, _HEALING, control).points, control)


def _fused(own: Carrier, one: Proposal, other: Proposal) -> Proposal:
    """Take the better of two proposals from place to place."""
    mesh = own.mesh
    areas = mesh.vertex_areas / mesh.area
    edges = mesh_edges(mesh.faces)
    apart = np.linalg.norm(one.points - other.points, axis=1) / own.size
    lengths = np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1) / own.size
    seams = _SEAM * lengths * apart[edges].mean(axis=1)
    second = fused_choice(np.stack([areas * one.costs, areas * other.costs]), edges, seams)
    costs = np.where(second, other.costs, one.costs)
    # Along a seam neither is to be believed.
    torn = edges[second[edges[:, 0]] != second[edges[:, 1]]].ravel()
    np.maximum.at(costs, torn, np.minimum(apart[torn] / _AWAY, 1.0))
    return Proposal(np.where(second[:, None], other.points, one.points), costs, one.misfit, one.inverse)


def judged(own: Carrier, other: Carrier, points: NDArray[np.float64], control: Control) -> Proposal:
    """Measure what is wrong with a shape laid on another."""
    control.check()
    mesh = own.mesh
    lying = TriangleMesh(points, mesh.faces)
    images = FacingPointFinder(other.mesh).find(points, vertex_normals(points, mesh.faces))
    there = vertex_normals(other.mesh.vertices, other.mesh.faces)
    origins = FacingPointFinder(lying).find(other.mesh.vertices, there)
    home = origins.interpolated(mesh.corners)
    trip = np.linalg.norm(images.interpolated(home[other.mesh.faces]) - mesh.vertices, axis=1) / own.size
    away = images.distances / other.size
    misfit = np.minimum(trip / _TRIP, 1.0) + np.minimum(away / _AWAY, 1.0)
    costs = misfit + np.minimum(_vertex_stretch(own, points) / _STRETCH, 1.0)
    missed = np.minimum(origins.distances / other.size / _AWAY, 1.0)
    inverse = Laid(home, np.exp(-np.square(missed + origins.interpolated(costs[mesh.faces][:, :, None])[:, 0])))
    return Proposal(points, costs, weighted_quantile(misfit, mesh.vertex_areas, _MOST), inverse)


def _vertex_stretch(own: Carrier, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the largest logarithmic stretch of the triangles around every vertex, up or down, on average, (n,)."""
    mesh = own.mesh
    scale = np.sqrt(TriangleMesh(points, mesh.faces).area / mesh.area)
    gradients = deformation_gradients(mesh.vertices, points, mesh.faces) / scale
    sizes = np.linalg.svd(gradients, compute_uv=False)[:, [0, 2]]
    stretch = np.abs(np.log(np.maximum(sizes, 1e-6))).max(axis=1)
    corners, count = mesh.faces.ravel(), len(points)
    sums = np.bincount(corners, np.repeat(stretch, 3), count)
    return sums / np.maximum(np.bincount(corners, minlength=count), 1)


def _placed(own: Carrier, other: Carrier, found: Proposal) -> NDArray[np.float64]:
    """Return a shape as it stands beside another, moved and scaled, (n, 3); turned only if it stands otherwise."""
    mesh = own.mesh
    weights = mesh.vertex_areas * np.exp(-np.square(found.costs))
    weights = weights / weights.sum()
    here, there = mesh.vertices - weights @ mesh.vertices, found.points - weights @ found.points
    turn = nearest_rotations(np.einsum("n,ni,nj->ij", weights, there, here)[:, :, None]).rotations[:, :, 0]
    if np.trace(turn) > 1.0 + 2.0 * np.cos(_TURNED):
        turn = np.eye(3)
    centers = [part.vertex_areas @ part.vertices / part.area for part in (mesh, other.mesh)]
    return other.size / own.size * (mesh.vertices - centers[0]) @ turn.T + centers[1]


def total_cost(drafts: tuple[Carrier, Carrier], found: list[Proposal]) -> float:
    """Return what both shapes pay on average, and for how far from home the way there and back ends."""
    total = 0.0
    for k in (0, 1):
        home = home_distances(drafts[k], drafts[1 - k], found[k].points, found[1 - k].points)
        areas = drafts[k].mesh.vertex_areas
        total += float(areas @ (found[k].costs + np.minimum(home / _TRIP, 1.0)) / areas.sum())
    return total


def agree(
    drafts: tuple[Carrier, Carrier],
    found: Sequence[Proposal | Registered],
    k: int,
    share: float = _MOST,
    near: float = _NEAR_HOME,
) -> bool:
    """Tell whether the way there and back ends near home for a share of the area."""
    home = home_distances(drafts[k], drafts[1 - k], found[k].points, found[1 - k].points)
    return weighted_quantile(home, drafts[k].mesh.vertex_areas, share) <= near
