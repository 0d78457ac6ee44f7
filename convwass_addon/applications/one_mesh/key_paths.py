# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths of one mesh's vertices to other shapes, with a few key positions and straight lines between them.

The mesh is guided to each of the other shapes (:mod:`..motions.guided_motion`) and finally moved onto its surface. The
path is then replaced by the fewest straight pieces that leave no vertex farther from it than allowed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.fold_finder import FoldFinder
from ...geometry.mesh import TriangleMesh
from ...geometry.normals import vertex_normals
from ...geometry.orientation import orient_outward
from ...geometry.surface_projection import drawn_along_normals
from ...geometry.unfolding import unfolded
from ...geometry.weighted_quantile import weighted_quantile
from ...one_line import one_line
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..motions.guided_motion import GuidedMotion, guided_motion
from ..motions.guided_settings import GuidedSettings
from ..motions.guides import Guide
from .straight_pieces import fitted_pieces
from .turned_offsets import TurnedOffsets

# A map below this score leads some parts to the wrong place (the limit of the automatic choice of motions), and would
# distort the mesh.
_LEAST_SCORE = 0.6
# Number of samples of a path, some of which become key positions.
_SAMPLES = 65
# Fraction of the work for the motion.
_GUIDED = 0.8
# Vertices farther from the other surface than this fraction of its diagonal count as missing it.
_FAR = 0.01
# Motions move only shapes with weight, so the end of a path is evaluated at this small weight.
_CLOSE = 1e-6


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
    score : float
        Score of the map between the two shapes, 0 to 1.
    deviation : float
        Largest distance of a vertex from the original path, as a fraction of the other shape's diagonal.
    distance, distance_95 : float
        From the last position to the other surface, as fractions of its diagonal: mean over the area, and 95th
        percentile.
    turned : int
        Number of triangles that finally face away from the surface they lie on.
    poor : (p,) int64
        Misplaced vertices: those of flipped or collapsed triangles, and those farther than a hundredth of the diagonal
        from the surface.
    """

    name: str
    times: tuple[float, ...]
    positions: NDArray[np.float64]
    score: float
    deviation: float
    distance: float
    distance_95: float
    turned: int
    poor: NDArray[np.int64] = field(default_factory=lambda: np.empty(0, np.int64))

    __repr__ = one_line("name", "times", "positions")

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        names = ("name", "score", "deviation", "distance", "distance_95", "turned")
        return {**{name: getattr(self, name) for name in names}, "poor": len(self.poor), "times": list(self.times)}


def key_paths(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    accuracy: float,
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
    accuracy : float
        Largest distance of vertices from their path, as a fraction of the diagonal of the shape they move to.
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
            raise InputError(
                "{first} and {second} match too poorly ({score:.0%}) for one mesh to take both shapes. "
                "Add guides: corresponding points of both.",
                first=names[0],
                second=names[pair[1]],
                score=motion.pairs[pair].score,
            )
    return (yield from within(paths_along(motion, outward, names, accuracy, control), _GUIDED, 1.0))


def paths_along(
    motion: GuidedMotion, shapes: Sequence[TriangleMesh], names: Sequence[str], accuracy: float, control: Control
) -> Work[list[KeyPath]]:
    """Find the paths of the first shape's vertices to each of the other shapes along a motion.

    Parameters
    ----------
    motion : GuidedMotion
        The motion between the first shape and each of the others.
    shapes, names, accuracy, control
        As for :func:`key_paths`; the shapes must be oriented outward.
    """
    found = []
    for index in range(1, len(shapes)):
        message = Sentence("Projecting {first} onto {second}", {"first": names[0], "second": names[index]})
        yield Progress((index - 1) / (len(shapes) - 1), message)
        way = _Way.of(motion, index, shapes[0], shapes[index], control)
        found.append(_path(way, names[index], motion.pairs[0, index].score, accuracy, control))
    return found


@dataclass(frozen=True)
class _Way:
    """The mesh on its way to one of the shapes.

    `heights`, (n,), are the remaining distances to the other surface at the end, along the normals of the guided mesh;
    `mended` are further offsets of vertices near folds.
    """

    motion: GuidedMotion
    index: int
    mesh: TriangleMesh
    target: TriangleMesh
    heights: NDArray[np.float64]
    mended: TurnedOffsets

    @classmethod
    def of(cls, motion: GuidedMotion, index: int, mesh: TriangleMesh, target: TriangleMesh, control: Control) -> _Way:
        nothing = TurnedOffsets.of(mesh, mesh.vertices, np.zeros_like(mesh.vertices))
        way = cls(motion, index, mesh, target, np.zeros(len(mesh.vertices)), nothing)
        guided = way.guided(1.0)
        normals = vertex_normals(guided.vertices, mesh.faces)
        drawn = drawn_along_normals(guided, target, control)
        heights = np.einsum("nd,nd->n", drawn - guided.vertices, normals)
        laid = guided.vertices + heights[:, None] * normals
        final = unfolded(mesh, laid, target, control)
        # Normals change abruptly where the guided mesh folds, so vertices there get their whole offset as `mended`.
        mended = (final != laid).any(axis=1)
        heights[mended] = 0.0
        offsets = np.where(mended[:, None], final - guided.vertices, 0.0)
        return cls(motion, index, mesh, target, heights, TurnedOffsets.of(mesh, guided.vertices, offsets))

    def guided(self, t: float) -> TriangleMesh:
        """Return the guided mesh; at the end, its limit, since a shape without weight is not moved."""
        t = min(t, 1.0 - _CLOSE)
        weights = [0.0] * len(self.motion.carriers)
        weights[0], weights[self.index] = 1.0 - t, t
        moved = self.motion.moved(weights)[0]
        return TriangleMesh(moved.vertices[: len(self.mesh.vertices)], self.mesh.faces)

    def at(self, t: float) -> NDArray[np.float64]:
        """Return the vertices at a time from 0 to 1, (n, 3)."""
        if t == 0.0:
            return self.mesh.vertices
        guided = self.guided(t)
        drawn = guided.vertices + (t * self.heights)[:, None] * vertex_normals(guided.vertices, self.mesh.faces)
        return self.mended.added(drawn, guided.vertices, t)


def _path(way: _Way, name: str, score: float, accuracy: float, control: Control) -> KeyPath:
    """Choose the fewest positions for a path."""
    diagonal = float(np.linalg.norm(np.ptp(way.target.bounds, axis=0)))
    samples = []
    for t in np.linspace(0.0, 1.0, _SAMPLES):
        control.check()
        samples.append(way.at(float(t)))
    pieces = fitted_pieces(samples, accuracy * diagonal)
    times = tuple(end / (_SAMPLES - 1) for end in pieces.ends)
    final = TriangleMesh(samples[-1], way.mesh.faces)
    folds = FoldFinder.of(way.mesh, way.target)
    distances = folds.finder.find_closest(final.vertices, control).distances / diagonal
    turned = folds.agreements(final.vertices, control) < 0.0
    poor = distances > _FAR
    poor[final.faces[turned | folds.collapsed(final.vertices)]] = True
    areas = final.vertex_areas
    return KeyPath(
        name,
        times,
        pieces.positions,
        score,
        pieces.deviation / diagonal,
        float(areas @ distances / areas.sum()),
        weighted_quantile(distances, areas, 0.95),
        int(turned.sum()),
        np.flatnonzero(poor),
    )
