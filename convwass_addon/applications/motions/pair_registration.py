# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Two shapes laid on each other: from what the map says, and where that fails from elsewhere.

Maps without guides confuse left and right, or send two fingers to one. What gives it away is strain, distance, and that
the way there and back leads elsewhere. So each shape is also laid on the other from where it stands, and by the inverse
of how the other was laid on it, and from place to place the better is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.edges import vertex_components
from ...geometry.facing_points import FacingPointFinder
from ...geometry.fusion import fused_choice
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import vertex_normals
from ...geometry.poisson_deformation import deformation_gradients
from ...geometry.registration import AS_PLACED, Registration, Stage
from ...geometry.rotations import nearest_rotations
from ...geometry.surface_projection import drawn_along_normals
from ...geometry.unit_shape import UnitShape
from ...progress import Control
from .carriers import Carrier, coarser
from .mesh_parts import mesh_edges, renumbered, with_others

# Vertices of the meshes on which several ways are tried.
_DRAFT_VERTICES = 1500
# From a start to the other surface: first as the start says, then as smooth as the surfaces allow. Tighter stages gain
# little closeness and turn triangles over.
_FROM_MAP = (Stage(0.0, 100.0, 0.06, 3), Stage(20.0, 30.0, 0.05, 5), Stage(100.0, 5.0, 0.04, 5))
_FROM_PLACE = (*AS_PLACED, Stage(30.0, 0.0, 0.06, 6), Stage(100.0, 0.0, 0.04, 3))
_HEALING = (Stage(20.0, 30.0, 0.05, 4), Stage(100.0, 5.0, 0.04, 4))
# Strain from which on a surface gives way, so that joints bend and what lies between them keeps its length, and how
# coarse meshes are laid on each other then (docs/performance.md, Motions).
_GIVE = 0.2
_TIGHTENING = (Stage(30.0, 20.0, 0.05, 2, _GIVE), Stage(100.0, 0.0, 0.04, 6, _GIVE, 0.1))
_FINISHING = (Stage(100.0, 5.0, 0.04, 3), Stage(300.0, 0.0, 0.03, 5))
# Chosen by eye; `python3 run.py bench coherence` measures what they give.
# What a place pays: for the way there and back and for its distance, both in sizes of the surface, and for the
# logarithm of its stretch. At these values it pays one, which is the most for each.
_TRIP, _AWAY, _STRETCH = 0.15, 0.06, 1.0
# An edge over which the proposals differ by the size of the surface pays so much per its share of that size.
_SEAM = 1.0
# If 95 % of the area pay no more than this, stretch apart, there is nothing to mend.
_FINE = 0.35
# A point from which the way there and back ends so far from home, in sizes of the surface, is trusted by 0.6.
_MISSED = 0.08
# For two shapes to agree, 95 % of the area must come this near to home.
_NEAR_HOME = 0.06
# Shapes that are turned by less than this against each other are taken as they stand, radians.
_TURNED = np.radians(30.0)


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
class _Proposal:
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


@dataclass(frozen=True)
class _Registered:
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


def laid_on_each_other(
    shapes: tuple[Carrier, Carrier], starts: tuple[Laid, Laid], pairs: NDArray[np.int64], control: Control
) -> tuple[Laid, Laid]:
    """Lay two shapes on each other: as similar to themselves as the other's surface allows.

    Parameters
    ----------
    shapes : (Carrier, Carrier)
        The two.
    starts : (Laid, Laid)
        Where the map puts the vertices of either, and its confidence; 0 where it says nothing.
    pairs : (k, 2) int64
        Vertices of the two that belong together.
    control : Control
        Stops the work.

    Returns
    -------
    (Laid, Laid)
        Points, and how well the way there and back comes home.

    Raises
    ------
    InputError
        The map says nothing about any vertex.
    """
    both = pairs, pairs[:, ::-1]
    drafts = tuple(coarser(shapes[k], both[k][:, 0], _DRAFT_VERTICES, control) for k in (0, 1))
    ends = np.stack([drafts[k].places(pairs[:, k]) for k in (0, 1)], axis=1)
    rough = [
        Laid(start.points[draft.seeds], start.trust[draft.seeds]) for start, draft in zip(starts, drafts, strict=True)
    ]
    drafted = _tightened(drafts, _drafted(drafts, rough, ends, control), ends, control)
    found = []
    for k in (0, 1):
        draft, own = drafts[k], drafted[k]
        gradients = deformation_gradients(draft.mesh.vertices, own.points, draft.mesh.faces)
        begin = Laid(
            draft.carried(own.points, gradients), own.trust if draft.blend is None else draft.blend @ own.trust
        )
        found.append(_registered(shapes[k], shapes[1 - k], begin, both[k], _FINISHING, control).drawn(control))
    homes = [_home(shapes[k], shapes[1 - k], *found[:: 1 - 2 * k]) for k in (0, 1)]
    return tuple(
        Laid(points, np.exp(-0.5 * np.square(home / _MISSED))) for points, home in zip(found, homes, strict=True)
    )


def _drafted(
    drafts: tuple[Carrier, Carrier], starts: list[Laid], pairs: NDArray[np.int64], control: Control
) -> list[Laid]:
    """Lay coarse meshes on each other by the best of several ways."""
    both = pairs, pairs[:, ::-1]
    best = [_proposed(drafts, k, starts[k], both[k], _FROM_MAP, control) for k in (0, 1)]
    if max(found.misfit for found in best) <= _FINE:
        return [_trusted(found) for found in best]
    tries = [best]
    inverses = [found.inverse for found in best]
    best = list(best)
    for k in (0, 1):
        placed = Laid(_placed(drafts[k], drafts[1 - k], best[k]), np.ones(len(drafts[k].mesh.vertices)))
        ways = [(inverses[1 - k], _FROM_MAP), (placed, _FROM_PLACE)]
        best[k] = _mended(drafts, k, best[k], ways, both[k], control)
    tries.append(best)
    for k in (1, 0):
        if not _agree(drafts, best, k):
            best = list(best)
            best[k] = _mended(drafts, k, best[k], [(best[1 - k].inverse, _FROM_MAP)], both[k], control)
            tries.append(best)
    kept = min(tries, key=lambda found: _total(drafts, found))
    return [_trusted(found) for found in kept]


def _tightened(
    drafts: tuple[Carrier, Carrier], starts: list[Laid], pairs: NDArray[np.int64], control: Control
) -> list[Laid]:
    """Lay coarse meshes on each other such that limbs keep their lengths and strain gathers in joints.

    Maps slide along limbs, which look alike all along. Skin that is gone under a raised arm on one of the shapes cannot
    be found from there, but from the other one: where the two ways disagree, the inverse of the other is tried too.
    """
    both = pairs, pairs[:, ::-1]

    def tightened(k: int, start: Laid) -> _Registered:
        return _registered(drafts[k], drafts[1 - k], start, both[k], _TIGHTENING, control)

    best = [tightened(k, starts[k]) for k in (0, 1)]
    for k in (0, 1):
        own, other = drafts[k], drafts[1 - k]
        if not _agree(drafts, best, k):
            inverse = _judged(other, own, best[1 - k].points, control).inverse
            rival = tightened(k, inverse)
            best[k] = min(best[k], rival, key=lambda one: one.laid.energy(_GIVE))
    return [_trusted(_judged(drafts[k], drafts[1 - k], best[k].points, control)) for k in (0, 1)]


def _total(drafts: tuple[Carrier, Carrier], found: list[_Proposal]) -> float:
    """Return what both shapes pay on average, and for how far from home the way there and back ends."""
    total = 0.0
    for k in (0, 1):
        home = _home(drafts[k], drafts[1 - k], found[k].points, found[1 - k].points)
        areas = drafts[k].mesh.vertex_areas
        total += float(areas @ (found[k].costs + np.minimum(home / _TRIP, 1.0)) / areas.sum())
    return total


def _agree(drafts: tuple[Carrier, Carrier], found: Sequence[_Proposal | _Registered], k: int) -> bool:
    """Tell whether the way there and back comes home."""
    home = _home(drafts[k], drafts[1 - k], found[k].points, found[1 - k].points)
    return _share_95(home, drafts[k].mesh.vertex_areas) <= _NEAR_HOME


def _mended(
    drafts: tuple[Carrier, Carrier],
    k: int,
    best: _Proposal,
    ways: list[tuple[Laid, tuple[Stage, ...]]],
    pairs: NDArray[np.int64],
    control: Control,
) -> _Proposal:
    """Replace parts of a shape laid on the other by what comes of other starts, where that is better."""
    own, other = drafts[k], drafts[1 - k]
    for start, stages in ways:
        best = _fused(own, best, _proposed(drafts, k, start, pairs, stages, control))
    return _judged(own, other, _registered(own, other, _trusted(best), pairs, _HEALING, control).points, control)


def _proposed(
    drafts: tuple[Carrier, Carrier],
    k: int,
    start: Laid,
    pairs: NDArray[np.int64],
    stages: tuple[Stage, ...],
    control: Control,
) -> _Proposal:
    own, other = drafts[k], drafts[1 - k]
    return _judged(own, other, _registered(own, other, start, pairs, stages, control).points, control)


def _trusted(found: _Proposal) -> Laid:
    return Laid(found.points, np.exp(-np.square(found.costs)))


def _fused(own: Carrier, one: _Proposal, other: _Proposal) -> _Proposal:
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
    return _Proposal(np.where(second[:, None], other.points, one.points), costs, one.misfit, one.inverse)


def _judged(own: Carrier, other: Carrier, points: NDArray[np.float64], control: Control) -> _Proposal:
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
    return _Proposal(points, costs, _share_95(misfit, mesh.vertex_areas), inverse)


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


def _home(source: Carrier, target: Carrier, there: NDArray[np.float64], back: NDArray[np.float64]) -> NDArray:
    """Return how far from home the way there and back ends, (n,), in sizes of the source."""
    mesh, other = source.mesh, target.mesh
    images = FacingPointFinder(other).find(there, vertex_normals(there, mesh.faces))
    return np.linalg.norm(images.interpolated(back[other.faces]) - mesh.vertices, axis=1) / source.size


def _placed(own: Carrier, other: Carrier, found: _Proposal) -> NDArray[np.float64]:
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


def _share_95(costs: NDArray[np.float64], areas: NDArray[np.float64]) -> float:
    """Return what 95 % of the area pay at most."""
    order = np.argsort(costs)
    reached = np.cumsum(areas[order])
    return float(costs[order][np.searchsorted(reached, 0.95 * reached[-1])])


def _registered(
    source: Carrier,
    target: Carrier,
    start: Laid,
    pairs: NDArray[np.int64],
    stages: tuple[Stage, ...],
    control: Control,
) -> _Registered:
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
    return _Registered(mesh, own, part.faces, target.mesh, size * laid.points + center, laid)
