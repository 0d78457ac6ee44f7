# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the vertices of one mesh go to other shapes, as a few positions between which they go straight.

The mesh is guided to each of the other shapes (:mod:`..motions.guided_motion`) and drawn onto its surface at the end.
Straight pieces, as few as leave no vertex farther from its path than is allowed, take the place of the path.
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
from .straight_pieces import StayNear, fitted_pieces
from .turned_offsets import TurnedOffsets
from .volume_keeping import has_volume, with_even_volume
from .volume_on_pieces import KeepVolume

# A map below this score leads some parts to the wrong place (the limit of the automatic choice of motions), and a mesh
# that follows it would be mangled.
_LEAST_SCORE = 0.6
# Positions that are looked at to choose some of them.
_SAMPLES = 65
# Share of the work that the motion is.
_GUIDED = 0.8
# Vertices farther from the other surface than this share of its diagonal have not arrived.
_FAR = 0.01
# Largest relative error of the volume between keys.
_VOLUME = 0.01
# Shapes are only moved where they have weight; so near to the end nothing is left to see.
_CLOSE = 1e-6


@dataclass(frozen=True)
class KeyPath:
    """How the vertices of a mesh go to another shape.

    Attributes
    ----------
    name : str
        What the other shape is called.
    times : tuple of float
        When the positions are reached, increasing to 1; at 0 the mesh is as it is.
    positions : (k, n, 3) float64
        Of the vertices, scene units.
    score : float
        Of the map between the two shapes, 0 to 1.
    deviation : float
        By how much a vertex leaves the path between two positions, as a share of the other shape's diagonal.
    distance, distance_95 : float
        From the mesh at the end to the other surface, as shares of its diagonal: mean over the area, and what 95 % of
        the area stay below.
    turned : int
        Triangles that face away from the surface on which they end.
    poor : (p,) int64
        Vertices that are not where they should be: those of triangles that are turned over or have collapsed, and those
        farther than a hundredth of the diagonal from the surface.
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
    """Find how the vertices of the first shape go to each of the others.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        Where they stand, scene units: the mesh that is to change, and the shapes that it is to take.
    names : sequence of str
        What messages call them.
    accuracy : float
        By how much vertices may leave the path, as a share of the diagonal of the shape that they go to.
    settings : GuidedSettings
        How the mesh is guided.
    guides : sequence of mappings from int to int
        Points that belong together; see :func:`..motions.guided_motion.guided_motion`.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        Fewer than two shapes, a coherence at which the mesh does not arrive, or shapes between which there is no good
        map.
    """
    if len(shapes) < 2:
        raise InputError("Shape keys need a mesh and at least one shape for it to take.")
    if settings.way < 1.0:
        raise InputError("With a coherence below 0.5 the mesh does not arrive; set it to 0.5 or more.")
    outward = [orient_outward(shape) for shape in shapes]
    pairs = [(0, index) for index in range(1, len(shapes))]
    motion = yield from within(guided_motion(outward, names, pairs, settings, guides, control), 0.0, _GUIDED)
    for pair in pairs:
        if motion.pairs[pair].score < _LEAST_SCORE:
            raise InputError(
                "{first} and {second} agree too little ({score:.0%}) for one mesh to take both shapes. Add guides: "
                "points of both that belong together.",
                first=names[0],
                second=names[pair[1]],
                score=motion.pairs[pair].score,
            )
    return (yield from within(paths_along(motion, outward, names, accuracy, control), _GUIDED, 1.0))


def paths_along(
    motion: GuidedMotion, shapes: Sequence[TriangleMesh], names: Sequence[str], accuracy: float, control: Control
) -> Work[list[KeyPath]]:
    """Find how the vertices of the first shape go to each of the others along a motion.

    Parameters
    ----------
    motion : GuidedMotion
        Between the first shape and each of the others.
    shapes, names, accuracy, control
        As for :func:`key_paths`; the shapes facing outward.
    """
    found = []
    for index in range(1, len(shapes)):
        message = Sentence("Drawing {first} onto {second}", {"first": names[0], "second": names[index]})
        yield Progress((index - 1) / (len(shapes) - 1), message)
        way = _Way.of(motion, index, shapes[0], shapes[index], control)
        found.append(_path(way, names[index], motion.pairs[0, index].score, accuracy, control))
    return found


@dataclass(frozen=True)
class _Way:
    """The mesh on its way to one of the shapes.

    `heights`, (n,), is how far along its normals the guided mesh is from the other surface at the end; `mended` is what
    vertices near folds move besides.
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
        # Normals turn abruptly where the guided mesh folds, so vertices there get all of their offset in another way.
        mended = (final != laid).any(axis=1)
        heights[mended] = 0.0
        offsets = np.where(mended[:, None], final - guided.vertices, 0.0)
        return cls(motion, index, mesh, target, heights, TurnedOffsets.of(mesh, guided.vertices, offsets))

    def guided(self, t: float) -> TriangleMesh:
        """Return the mesh as it is guided; at the end, the limit from before, since there it has no weight."""
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
    """Choose the positions of a path, as few as can be."""
    diagonal = float(np.linalg.norm(np.ptp(way.target.bounds, axis=0)))
    samples = []
    for t in np.linspace(0.0, 1.0, _SAMPLES):
        control.check()
        samples.append(way.at(float(t)))
    criteria = []
    if has_volume(way.mesh):
        samples = with_even_volume(samples, way.mesh, control)
        criteria.append(KeepVolume.of(np.stack(samples), way.mesh.faces, _VOLUME))
    path = np.stack(samples)
    pieces = fitted_pieces(path, [StayNear(path, accuracy * diagonal), *criteria])
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
