# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of one mesh's vertices to other shapes, with a few key positions and straight lines between them.

The mesh is guided to each of the other shapes and finally moved onto its surface (:mod:`.guided_way`). The path is
sampled, made symmetric if requested, given an even volume, and replaced by the fewest straight pieces that meet the
requirements.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.arrays.weighted_quantile import weighted_quantile
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.missed_surface import MissedSurface, missed_surface
from ...geometry.meshes.spread_closest_points import spread_closest_points
from ...geometry.solids.orientation import orient_outward
from ...one_line import one_line
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..motions.guided_motion import GuidedMotion, GuidedPair, guided_motion
from ..motions.guided_settings import GuidedSettings
from ..motions.guides import Guide
from ..motions.standing_motion import standing_motion
from ..workers import one_blas_thread
from .guided_way import GuidedWay
from .mirror_symmetry import MirrorSymmetry
from .poor_maps import poor_map_error
from .refined_samples import RefinedPath
from .straight_pieces import Criterion, FittedPieces, StayNear, fitted_pieces
from .volume_keeping import has_volume, with_even_volume
from .volume_on_pieces import KeepVolume

# A map below this score leads some parts to the wrong place (the limit of the automatic choice of motions), and would
# distort the mesh.
_LEAST_SCORE = 0.6
# Number of computed samples of a path, and how often their number is doubled by interpolation. Some of the samples
# become key positions.
_SAMPLES, _DOUBLINGS = 17, 2
# Fraction of the work for the motion: 0.3 with 1 040 000 vertices, and more with fewer.
_GUIDED = 0.4
# CPU seconds for a path until it is on the surface, sampled, symmetric and in straight pieces, and for its figures:
# from a man to another pose with 1 040 000 vertices (docs/performance/one_mesh.md).
_SECONDS = (38.0, 8.0, 42.0, 24.0, 9.0)
# Fractions of the work for straight pieces until the volume is even, and until it is known at all samples.
_EVEN, _KNOWN = 0.58, 0.82
# Vertices farther from the other surface than this fraction of its diagonal count as missing it.
_FAR = 0.01
# Largest relative error of the volume between keys.
_VOLUME = 0.01


@dataclass(frozen=True)
class KeyDemands:
    """Requirements on keys.

    Attributes
    ----------
    error : float
        Largest distance of vertices from their path, as a fraction of the diagonal of the shape they move to.
    symmetry : MirrorSymmetry or None
        Mirror images among the vertices, if the keys are to be symmetric.
    on_floor : bool
        Whether shapes that stand on one floor stay on it; see :func:`..motions.standing_motion.standing_motion`.
    """

    error: float
    symmetry: MirrorSymmetry | None = None
    on_floor: bool = True


@dataclass(frozen=True)
class KeyPath:
    """The path of a mesh's vertices to another shape.

    Attributes
    ----------
    name : str
        Name of the other shape.
    times : tuple of float
        Times of the positions, increasing to 1; at 0 the mesh is undeformed.
    positions : (k, n, 3) float64
        Positions of the vertices, scene units.
    score : float or None
        Score of the map between the two shapes, 0 to 1; None if the mesh follows blends.
    deviation : float
        Largest distance of a vertex from the original path, as a fraction of the other shape's diagonal.
    distance, distance_95 : float
        From the vertices in the last position to the other surface, as fractions of its diagonal: mean over the area,
        and 95th percentile.
    turned : int
        Number of triangles that finally face away from the surface they lie on.
    poor : (p,) int64
        Misplaced vertices: those of flipped or collapsed triangles, and those farther than a hundredth of the diagonal
        from the surface.
    missed : float
        Share of the other surface that is farther than a hundredth of its diagonal from the mesh at the end, such as a
        knob where the mesh has no vertices.
    beyond : float
        What of that is farther from the mesh than its closest triangle is long, so that no finer mesh would reach it.
    surface_95 : float
        As `distance_95`, of points all over the triangles: large ones are far from a curved surface on which their
        corners lie.
    """

    name: str
    times: tuple[float, ...]
    positions: NDArray[np.float64]
    score: float | None
    deviation: float
    distance: float
    distance_95: float
    turned: int
    poor: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))
    missed: float = 0.0
    beyond: float = 0.0
    surface_95: float = 0.0

    __repr__ = one_line("name", "times", "positions")

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        distances = ("deviation", "distance", "distance_95", "surface_95")
        names = ("name", "score", *distances, "turned", "missed", "beyond")
        return {**{name: getattr(self, name) for name in names}, "poor": len(self.poor), "times": list(self.times)}


def key_paths(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    demands: KeyDemands,
    settings: GuidedSettings,
    guides: Sequence[Guide],
    control: Control,
) -> Work[list[KeyPath]]:
    """Find the paths of the first shape's vertices to each of the other shapes.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        In scene units: the mesh to be deformed, and the shapes whose form it takes.
    names : sequence of str
        Names of the shapes, for messages.
    demands : KeyDemands
        Requirements on the keys.
    settings : GuidedSettings
        Settings of the motion.
    guides : sequence of mappings from int to int
        Corresponding points; see :func:`..motions.guided_motion.guided_motion`.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        Fewer than two shapes, a coherence at which the mesh does not reach the other shapes, or shapes between which
        there is no good map.
    """
    if len(shapes) < 2:
        raise InputError("Shape keys need a mesh and at least one shape for it to take.")
    if settings.way < 1.0:
        raise InputError("With a coherence below 0.5, the mesh does not reach the other shape; set it to 0.5 or more.")
    outward = [orient_outward(shape) for shape in shapes]
    pairs = [(0, index) for index in range(1, len(shapes))]
    motion = yield from within(guided_motion(outward, names, pairs, settings, guides, control), 0.0, _GUIDED)
    for pair in pairs:
        if motion.pairs[pair].score < _LEAST_SCORE:
            other = pair[1]
            score = motion.pairs[pair].score
            raise poor_map_error(outward[0], outward[other], (names[0], names[other]), score, control)
    return (yield from within(paths_along(motion, outward, names, demands, control), _GUIDED, 1.0))


def paths_along(
    motion: GuidedMotion, shapes: Sequence[TriangleMesh], names: Sequence[str], demands: KeyDemands, control: Control
) -> Work[list[KeyPath]]:
    """Find the paths of the first shape's vertices to each of the other shapes along a motion.

    Parameters
    ----------
    motion : GuidedMotion
        The motion between the first shape and each of the others.
    shapes, names, demands, control
        As for :func:`key_paths`; the shapes must be oriented outward.
    """
    with one_blas_thread():
        return (yield from _paths_along(motion, shapes, names, demands, control))


def _paths_along(
    motion: GuidedMotion, shapes: Sequence[TriangleMesh], names: Sequence[str], demands: KeyDemands, control: Control
) -> Work[list[KeyPath]]:
    found, moving = [], motion
    if demands.on_floor:
        moving = standing_motion(motion, len(shapes), [(0, index) for index in range(1, len(shapes))])
    for index in range(1, len(shapes)):
        message = Sentence("Projecting {first} onto {second}", {"first": names[0], "second": names[index]})
        begin, end = (place / (len(shapes) - 1) for place in (index - 1, index))
        yield Progress(begin, message)
        pair, way = motion.pairs[0, index], GuidedWay.of(moving, len(shapes), index, shapes[0], shapes[index])
        work = _path(way, pair, names[index], demands, message, control)
        found.append((yield from within(work, begin, end)))
    return found


def _path(
    way: GuidedWay, pair: GuidedPair, name: str, demands: KeyDemands, message: Sentence, control: Control
) -> Work[KeyPath]:
    """Choose the fewest key positions that meet the requirements."""
    needed = np.array([not pair.by_vertices, True, demands.symmetry is not None, True, True])
    ends = np.cumsum(needed * _SECONDS)
    laid, sampled, symmetric, fitted, _ = (ends / ends[-1]).tolist()
    if pair.by_vertices:
        way = way.onto_vertices()
    else:
        way = yield from within(way.onto_surface(message, control), 0.0, laid)
    samples = yield from within(way.sampled(_SAMPLES, message, control), laid, sampled)
    _straighten_loose_vertices(samples, way)
    if demands.symmetry is not None:
        symmetrized = way.symmetrized(samples, demands.symmetry, message, control)
        samples = yield from within(symmetrized, sampled, symmetric)
    diagonal = way.target.diagonal
    work = _pieces(samples, way.mesh, demands.error * diagonal, message, control)
    pieces = yield from within(work, symmetric, fitted)
    positions = pieces.positions
    if demands.symmetry is not None:
        # Means of positions that are symmetric about different planes are not quite symmetric.
        positions = np.stack([demands.symmetry.symmetrized(points) for points in positions])
    last = (len(samples) - 1) * 2**_DOUBLINGS
    times = tuple(end / last for end in pieces.ends)
    figures = yield from within(_figures(way, positions[-1], message, control), fitted, 1.0)
    return KeyPath(name, times, positions, pair.score, pieces.deviation / diagonal, **figures)


def _straighten_loose_vertices(samples: NDArray[np.float64], way: GuidedWay) -> None:
    """Let vertices that no triangle uses stay, or move straight to known ends, in place: nothing guides them."""
    loose = ~way.mesh.is_used
    begin = samples[0][loose]
    end = way.target.vertices[loose] if way.ends_on_vertices else begin
    for time, points in zip(np.linspace(0.0, 1.0, len(samples))[1:], samples[1:], strict=True):
        points[loose] = (1.0 - time) * begin + time * end


def _pieces(
    samples: NDArray[np.float64], mesh: TriangleMesh, most: float, message: Sentence, control: Control
) -> Work[FittedPieces]:
    """Follow a path, with an even volume if the mesh encloses one."""
    yield Progress(0.0, message)
    keeps_volume = has_volume(mesh)
    if keeps_volume:
        samples = yield from within(with_even_volume(samples, mesh, message, control), 0.0, _EVEN)
    path = RefinedPath.of(samples, _DOUBLINGS)
    criteria: list[Criterion] = [StayNear(path, most)]
    if keeps_volume:
        work = KeepVolume.of(path, mesh.faces, _VOLUME, message, control)
        criteria.append((yield from within(work, _EVEN, _KNOWN)))
    return (yield from within(fitted_pieces(path, criteria, message, control), _KNOWN, 1.0))


def _figures(way: GuidedWay, last: NDArray[np.float64], message: Sentence, control: Control) -> Work[dict[str, object]]:
    """Return the figures of the last key of a path, with the names that :class:`KeyPath` has for them."""
    control.check()
    yield Progress(0.0, message)
    final, folds = TriangleMesh(last, way.mesh.faces), way.folds
    diagonal = way.target.diagonal
    areas, missed = final.vertex_areas, MissedSurface(0.0, 0.0)
    if way.ends_on_vertices:
        distances = np.linalg.norm(last - way.target.vertices, axis=1) / diagonal
        surface = distance_95 = weighted_quantile(distances, areas, 0.95)
        turned, poor = np.zeros(len(final.faces), bool), distances > _FAR
    else:
        distances = folds.finder.find_closest(final.vertices, control).distances / diagonal
        distance_95 = weighted_quantile(distances, areas, 0.95)
        near = spread_closest_points(final, folds.finder.closest, control)
        surface = float(np.quantile(near.distances, 0.95)) / diagonal
        yield Progress(0.4, message)
        turned = folds.agreements(final.vertices, control) < 0.0
        poor = distances > _FAR
        poor[final.faces[turned | folds.collapsed(final.vertices)]] = True
        yield Progress(0.7, message)
        missed = missed_surface(way.target, final, _FAR * diagonal, control)
    return {
        "distance": float(areas @ distances / areas.sum()),
        "distance_95": distance_95,
        "surface_95": surface,
        "turned": int(turned.sum()),
        "poor": np.flatnonzero(poor),
        "missed": missed.missed,
        "beyond": missed.beyond,
    }
