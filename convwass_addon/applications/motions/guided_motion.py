# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motion: limbs swing as maps between the shapes tell, and only the remaining difference is transported.

Every two shapes that occur together are mapped onto each other, unless their vertices correspond, and each is
deformed to match the other. In a blend with weights w, shape i is deformed by the weighted mean of its deformations
to the others: with gradients F_ij = exp(g_ij) exp(s_ij) exp(u_ij) Q_ij, the product of a turn of the whole body, a
swing, a twist and a stretch, its triangles get exp(sum_j w_j g_ij) exp(sum_j w_j s_ij) exp(sum_j w_j u_ij) (sum_j w_j
Q_ij), where g_ii, s_ii and u_ii are zero and Q_ii = 1, and a Poisson system gives its vertices. Then all shapes are
rigidly aligned with each other, and corresponding vertices move to their mean. For two shapes this is Poisson shape
interpolation from both ends. For more shapes the result depends only on the weights, not on the path through them, and
their maps agree with each other; see :mod:`.consistent_maps`.
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise, permutations

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.mutual_alignment import Correspondence, mutual_poses
from ...geometry.deformation.hinged_poses import hinged_points
from ...geometry.deformation.swing_twist import mean_turns, turn_matrices
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..registrations.carriers import Carrier, carrier_steps
from ..registrations.consistent_maps import composed, composed_ways
from ..registrations.corresponding_vertices import corresponding_pair, vertices_correspond
from ..registrations.laid_meshes import Laid
from ..registrations.map_quality import MapQuality, map_quality
from ..registrations.mapped_pairs import mapped_pair, registering
from ..registrations.pair_merits import MappedPair
from ..registrations.shape_deformations import ShapeDeformation, split_deformation
from ..workers import both_ways, in_step, one_blas_thread
from .common_vertices import VersionOfMesh, met, versions_of_mesh
from .guided_settings import GuidedSettings
from .guides import Guide, check_guides, guide_pairs, guide_vertices
from .motion import MovedShape

# Least weight of a point in the rigid alignment, even if its map is not trusted at all.
_LEAST_TRUST = 0.01
# Fraction of the work until the shapes are read.
_READ = 0.05
# Fraction of the work on a pair after the registration.
_LAID = 0.9


@dataclass(frozen=True)
class GuidedPair:
    """Figures of the map between two shapes.

    Attributes
    ----------
    score : float
        Score of the map, 0 to 1; the confidence instead if the registered shapes coincide beyond doubt or the map was
        not used, and if that is more, the confidence times the share of the surface that keeps left and right.
    guides_left_out : int
        Number of guides without which the shapes map better, so that they were left out.
    detour : float
        Length of the map over the Wasserstein distance; see :func:`.map_detour.map_detour`.
    turn : float
        Angle in degrees by which one shape was turned about the vertical axis before they were registered.
    crumpling : float
        How much the shapes crumple on each other; the larger figure of both, see :class:`.map_quality.MapQuality`.
    tumbles : bool
        Whether the map turns a shape far around, and not about the vertical axis.
    by_vertices : bool
        Whether vertices with the same number correspond; see :mod:`.corresponding_vertices`.
    """

    score: float
    guides_left_out: int
    detour: float
    turn: float
    crumpling: float = 1.0
    tumbles: bool = False
    by_vertices: bool = False


@dataclass(frozen=True)
class GuidedMotion:
    """Moves shapes towards each other by deforming each to match the others; a :class:`.motion.Motion`.

    Attributes
    ----------
    carriers : tuple of Carrier
        The shapes.
    deformations : mapping of (int, int) to ShapeDeformation
        The deformation of the first of two shapes that matches the second.
    pairs : mapping of (int, int) to GuidedPair
        Figures of every pair, smaller index first.
    settings : GuidedSettings
        Settings of the motion.
    versions : tuple of VersionOfMesh
        The shapes as versions of one mesh; empty unless vertices correspond by their numbers in all pairs.
    """

    carriers: tuple[Carrier, ...]
    deformations: Mapping[tuple[int, int], ShapeDeformation]
    pairs: Mapping[tuple[int, int], GuidedPair]
    settings: GuidedSettings
    versions: tuple[VersionOfMesh, ...] = ()

    def with_coherence(self, coherence: float) -> GuidedMotion:
        """Return the same motion with another coherence, without recomputation.

        Raises
        ------
        InputError
            The coherence is not between 0 and 1.
        """
        return replace(self, settings=replace(self.settings, coherence=coherence))

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`.

        Raises
        ------
        ValueError
            The number of weights is wrong, or the shapes were not prepared to occur together.
        """
        if len(weights) != len(self.carriers):
            raise ValueError(f"there are {len(self.carriers)} shapes, but {len(weights)} weights")
        active = [shape for shape, weight in enumerate(weights) if weight > 0]
        missing = [pair for pair in permutations(active, 2) if pair not in self.deformations]
        if missing:
            raise ValueError(f"shapes {missing[0][0]} and {missing[0][1]} were not prepared to occur together")
        if len(active) == 1 or self.settings.way == 0:
            moved = {shape: self.carriers[shape].rest.vertices for shape in active}
        else:
            moved = self._moved_together(active, weights)
        return [
            MovedShape(carrier.rest, moved[shape], carrier.parents) if shape in moved else None
            for shape, carrier in enumerate(self.carriers)
        ]

    def _moved_together(self, active: list[int], weights: Sequence[float]) -> dict[int, NDArray[np.float64]]:
        """Return the vertices of the shapes that have weight, by their indices."""
        shares = np.array([weights[shape] for shape in active], dtype=np.float64)
        shares /= shares.sum()
        with one_blas_thread():
            states = [self._state(shape, dict(zip(active, shares, strict=True))) for shape in active]
            points = [self.carriers[shape].poisson.solve(*state) for shape, state in zip(active, states, strict=True)]
        ways = zip(permutations(range(len(active)), 2), permutations(active, 2), strict=True)
        found = [self._correspondence(places, shapes, points) for places, shapes in ways]
        poses = mutual_poses(shares, found)
        moved = {
            shape: pose.scaled(self.settings.way).applied(self.carriers[shape].carried(own, gradients))
            for shape, own, (gradients, _, _), pose in zip(active, points, states, poses, strict=True)
        }
        if self.versions and self.settings.way == 1.0:
            moved = met(self.versions, moved, shares, 1.0 - self.settings.stiffness)
        return moved

    def _state(
        self, shape: int, shares: Mapping[int, float]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return the gradients of a shape's triangles, its links and its anchors in a blend."""
        carrier = self.carriers[shape]
        mesh, links = carrier.mesh, carrier.poisson.links
        way, stiffness = self.settings.way, self.settings.stiffness
        others = [(way * share, self.deformations[shape, other]) for other, share in shares.items() if other != shape]
        stays = 1.0 - sum(share for share, _ in others)
        turns = sum(share * found.turns for share, found in others)
        offsets = (1.0 - stiffness) * sum(share * found.offsets for share, found in others)
        scale = stays + sum(share * found.scale for share, found in others)
        stretches = self.settings.mean_stretch([(share, found.stretches) for share, found in others])
        rest = links.vectors(mesh.vertices)
        link_stretches = stays * rest + sum(share * found.link_stretches for share, found in others)
        if stiffness > 0:
            stretches = (1.0 - stiffness) * stretches + stiffness * scale * np.eye(3)
            link_stretches = (1.0 - stiffness) * link_stretches + stiffness * scale * rest
        poses, taken = [found.pose for _, found in others], [share for share, _ in others]
        rigid = 1.0 - stiffness + stiffness * scale
        parts = hinged_points(carrier.samples, mesh.vertices, poses, taken, rigid, 1.0 - stiffness)
        anchors = parts + np.einsum("nij,nj->ni", turn_matrices(turns), offsets)
        gradients = turn_matrices(mean_turns(turns, mesh.faces)) @ stretches
        turned = np.einsum("kij,kj->ki", turn_matrices(mean_turns(turns, links.ends)), link_stretches)
        return gradients, turned, anchors

    def _correspondence(
        self, places: tuple[int, int], shapes: tuple[int, int], points: list[NDArray[np.float64]]
    ) -> Correspondence:
        """Return the corresponding points of two deformed shapes."""
        found = self.deformations[shapes]
        images = found.images.interpolated(points[places[1]][self.carriers[shapes[1]].mesh.faces])
        weights = self.carriers[shapes[0]].mesh.vertex_areas * (found.confidence + _LEAST_TRUST)
        return Correspondence.of(places, points[places[0]], images, weights)


def guided_motion(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    settings: GuidedSettings | None = None,
    guides: Sequence[Guide] = (),
    control: Control = UNINTERRUPTED,
) -> Work[GuidedMotion]:
    """Compute the guided motion of shapes.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        In scene units: open or closed, in any number of components, of any number of vertices.
    names : sequence of str
        Names of the shapes, for messages.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend, smaller index first: neighbors on a path, all pairs of a triangle or a
        pad; see :func:`.layouts.pairs_of`.
    settings : GuidedSettings, optional
        Settings of the motion.
    guides : sequence of mappings from int to int
        Corresponding points: each maps indices of some shapes to one of their vertices.
    control : Control
        Stops the work.

    Returns
    -------
    GuidedMotion
        The return value of the generator.

    Yields
    ------
    Progress
        What is being computed.

    Raises
    ------
    InputError
        Invalid shapes or guides, or shapes that cannot be mapped.
    """
    settings = settings or GuidedSettings()
    check_guides(guides, shapes, names)
    works = [
        carrier_steps(mesh, name, guide_vertices(guides, shape), settings.carrier_vertices, control)
        for shape, (mesh, name) in enumerate(zip(shapes, names, strict=True))
    ]
    carriers = yield from within(in_step(works, Sentence("Reading the shapes")), 0.0, _READ)
    deformations: dict[tuple[int, int], ShapeDeformation] = {}
    known: dict[tuple[int, int], GuidedPair] = {}
    for number, pair in enumerate(pairs):
        # A canonical order, so that a pair has the same result whatever the order of the shapes.
        ordered = pair if _rank(carriers[pair[0]].mesh) <= _rank(carriers[pair[1]].mesh) else pair[::-1]
        one, other = (carriers[shape] for shape in ordered)
        marked = guide_pairs(guides, *ordered)
        places = np.stack([one.places(marked[:, 0]), other.places(marked[:, 1])], axis=1)
        both = shapes[ordered[0]], shapes[ordered[1]]
        registration = _registered(both, (one, other), places, settings.map_vertices, control)
        begin, end = (_READ + (1.0 - _READ) * share / len(pairs) for share in (number, number + 1))
        with one_blas_thread():
            best, match = yield from within(_deformed(one, other, registration, control), begin, end)
        deformations[ordered], deformations[ordered[::-1]] = match.there, match.back
        quality = match.quality
        score = max(best.score, min(quality.confidence, 1.0)) if quality.is_beyond_doubt else best.score
        followed = best.map.pairs.tolist()
        left_out = sum(place not in followed for place in places.tolist())
        known[pair] = GuidedPair(
            score, left_out, best.detour, best.turn, quality.crumpling, best.tumbles, best.by_vertices
        )
    _make_consistent(carriers, deformations, known, control)
    yield Progress(1.0, Sentence("Motion computed"))
    correspond = all(pair.by_vertices for pair in known.values())
    versions = versions_of_mesh(carriers, shapes) if correspond else ()
    return GuidedMotion(tuple(carriers), deformations, known, settings, versions)


def _make_consistent(
    carriers: Sequence[Carrier],
    deformations: dict[tuple[int, int], ShapeDeformation],
    known: dict[tuple[int, int], GuidedPair],
    control: Control,
) -> None:
    """Replace maps that close a cycle by compositions of better ones, in place, unless vertices correspond anyway."""
    if all(pair.by_vertices for pair in known.values()):
        return
    scores = {pair: found.score for pair, found in known.items()}
    for (one, other), way in composed_ways(scores, len(carriers)).items():
        with one_blas_thread():
            laid = [composed(carriers, deformations, own, control) for own in (way, way[::-1])]
            match = _Match.of(carriers[one], carriers[other], *laid, control)
        deformations[one, other], deformations[other, one] = match.there, match.back
        passed = [known[min(step), max(step)] for step in pairwise(way)]
        known[one, other] = GuidedPair(
            min(pair.score for pair in passed),
            sum(pair.guides_left_out for pair in passed),
            max(pair.detour for pair in passed),
            max(pair.turn for pair in passed),
            match.quality.crumpling,
            any(pair.tumbles for pair in passed),
        )


def _registered(
    shapes: tuple[TriangleMesh, TriangleMesh],
    carriers: tuple[Carrier, Carrier],
    pairs: NDArray[np.int64],
    map_vertices: int,
    control: Control,
) -> Work[MappedPair]:
    """Register two shapes by their vertices if these correspond and there are no guides, and otherwise by a map."""
    if not len(pairs) and vertices_correspond(*shapes):
        return corresponding_pair(shapes, carriers)
    return (yield from mapped_pair(*carriers, pairs, map_vertices, control))


def _deformed(
    one: Carrier, other: Carrier, registration: Work[MappedPair], control: Control
) -> Work[tuple[MappedPair, _Match]]:
    """Register two shapes, and deform them to match each other."""
    best = yield from within(registration, 0.0, _LAID)
    yield Progress(_LAID, registering(one, other))
    return best, _Match.of(one, other, best.laid.first, best.laid.second, control)


@dataclass(frozen=True)
class _Match:
    """The deformations of two shapes that match each other, and how well they do."""

    there: ShapeDeformation
    back: ShapeDeformation
    quality: MapQuality

    @classmethod
    def of(cls, one: Carrier, other: Carrier, first: Laid, second: Laid, control: Control) -> _Match:
        """Divide the deformations of two shapes that are laid onto each other."""
        # The samples of both shapes are needed for both directions.
        both_ways(lambda k: (one, other)[k].samples)
        there = split_deformation(one, other, first, None, control)
        back = split_deformation(other, one, second, there, control)
        ways = (one, other, there), (other, one, back)
        qualities = both_ways(lambda k: map_quality(*ways[k]))
        return cls(there, back, qualities[0].or_worse(qualities[1]))


def _rank(mesh: TriangleMesh) -> tuple[object, ...]:
    """Return a sort key of a mesh that rotating, moving or scaling it changes only if another mesh is just as large."""
    digest = hashlib.sha256(mesh.vertices.tobytes() + mesh.faces.tobytes()).hexdigest()
    return len(mesh.vertices), len(mesh.faces), round(mesh.volume / mesh.area**1.5, 9), digest
