# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph two shapes of different topology with the meshes of both.

The mesh of each shape follows the blends of a morph (:mod:`.followed_surfaces`): the first one forward, the second one
backward. One replaces the other at the time at which both fit the morph best.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.visible_gap import VisibleGap
from ...geometry.solids.orientation import orient_outward
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..morphs.computation import Computation
from ..morphs.layouts import path_blends
from ..morphs.morph import morph
from ..morphs.morph_inputs import MorphInputs
from ..morphs.morph_problem import MorphFrame
from ..morphs.morph_settings import MorphSettings
from .followed_surfaces import Moment, followed, turned_around
from .key_paths import KeyPath
from .refined_samples import RefinedPath
from .straight_pieces import FittedPieces, StayNear, fitted_pieces

# Number of steps of the morph that the meshes follow, and how often their number is doubled by interpolation.
_STEPS, _DOUBLINGS = 24, 2
# Steps at which the meshes may be swapped: each follows three steps at least, as the interpolation needs, or none.
_SWAPS = (0, *range(3, _STEPS - 2), _STEPS)
# Fractions of the work until the morph is computed, until the first and the second mesh have followed it, until they
# are swapped, and until the first path is in straight pieces.
_MORPHED, _HALFWAY, _FOLLOWED, _SWAPPED, _FIRST = 0.7, 0.82, 0.94, 0.97, 0.985
# Meshes that are farther from the morph than this fraction of the diagonal, when they are swapped, are rejected.
_MOST = 0.02
# Vertices that are farther outside of it are marked.
_FAR = 0.01


@dataclass(frozen=True)
class SwappedMeshes:
    """Paths of the meshes of two shapes until they replace each other.

    Attributes
    ----------
    first : KeyPath or None
        From the first shape towards the second one; its last time is `time`. None if `time` is 0, so that only the
        second mesh moves.
    second : KeyPath or None
        From the second shape towards the first one, with times from there: the last one is ``1 - time``. None if
        `time` is 1.
    time : float
        When the second mesh replaces the first one.
    gap : float
        Distance from the morph within which 98 % of both surfaces are at this time, as a fraction of the diagonal.
    """

    first: KeyPath | None
    second: KeyPath | None
    time: float
    gap: float

    @property
    def paths(self) -> list[KeyPath]:
        """The paths of the meshes that move."""
        return [path for path in (self.first, self.second) if path is not None]

    def record(self) -> dict[str, object]:
        """Return all figures, ready for JSON."""
        return {"time": self.time, "gap": self.gap, "shapes": [path.record() for path in self.paths]}


def swapped_meshes(
    inputs: MorphInputs, error: float, settings: MorphSettings, control: Control, computation: Computation
) -> Work[SwappedMeshes]:
    """Find the paths of the meshes of two shapes.

    Parameters
    ----------
    inputs : MorphInputs
        The two meshes, in scene units.
    error : float
        Largest distance of vertices from their path, as a fraction of the diagonal of the shape they move to.
    settings : MorphSettings
        How the morph is made.
    control : Control
        Stops the work.
    computation : Computation
        Where the morph is computed.

    Raises
    ------
    InputError
        Not two shapes, or at no time both meshes fit the morph.
    """
    if len(inputs.shapes) != 2:
        raise InputError("Two Meshes needs two shapes; there are {count}.", count=len(inputs.shapes))
    meshes, names = [orient_outward(shape) for shape in inputs.shapes], inputs.names
    computed = _moments(replace(inputs, shapes=meshes), settings, control, computation)
    moments = yield from within(computed, 0.0, _MORPHED)
    ways = []
    for own, order, begin, end in ((0, moments, _MORPHED, _HALFWAY), (1, turned_around(moments), _HALFWAY, _FOLLOWED)):
        message = Sentence("Following the morph with {name}", {"name": names[own]})
        ways.append((yield from within(followed(meshes[own], order, message, control), begin, end)))
    forward, backward = ways[0], ways[1][::-1]
    message = Sentence("Swapping {first} for {second}", {"first": names[0], "second": names[1]})
    swap = yield from within(_best_swap(meshes, forward, backward, moments, message, control), _FOLLOWED, _SWAPPED)
    gaps = [
        VisibleGap.between(TriangleMesh(points[swap], mesh.faces), moments[swap].surface, control)
        for mesh, points in zip(meshes, (forward, backward), strict=True)
    ]
    size = moments[swap].surface.diagonal
    gap = max(own.most for own in gaps) / size
    if gap > _MOST:
        raise InputError(
            "Between {first} and {second} the surface tears, or their meshes are too coarse to follow it: at best, "
            "they are {gap:.1%} of their size away from the morph. Set Basis to Even, or choose another output, such "
            "as Player.",
            first=names[0],
            second=names[1],
            gap=gap,
        )
    first = last = None
    if swap > 0:
        work = _pieces(forward[: swap + 1], error * meshes[1].diagonal, message, control)
        pieces = yield from within(work, _SWAPPED, _FIRST)
        first = _key_path(pieces, names[1], gaps[0], size)
    if swap < _STEPS:
        work = _pieces(backward[swap:][::-1], error * meshes[0].diagonal, message, control)
        pieces = yield from within(work, _FIRST, 1.0)
        last = _key_path(pieces, names[0], gaps[1], size)
    return SwappedMeshes(first, last, swap / _STEPS, gap)


def _moments(
    inputs: MorphInputs, settings: MorphSettings, control: Control, computation: Computation
) -> Work[list[Moment]]:
    """Compute the surfaces of the morph, with both shapes at its ends."""
    frames: dict[int, MorphFrame] = {}
    unseen = replace(computation, previews=False)
    for report in morph(inputs, path_blends(2, _STEPS), settings, control, computation=unseen):
        if isinstance(report.payload, MorphFrame):
            frames[report.payload.blend.frame] = report.payload
        yield Progress(report.fraction, report.message)
    inner = [_moment(frames[number]) for number in range(1, _STEPS)]
    return [Moment(0.0, inputs.shapes[0]), *inner, Moment(1.0, inputs.shapes[1])]


def _moment(frame: MorphFrame) -> Moment:
    """Return the surface of a blend, which moves from the first shape to the second."""
    before, after = frame.velocity_points.astype(np.float64)
    return Moment(frame.blend.weights[1], frame.mesh, after - before)


def _best_swap(
    meshes: Sequence[TriangleMesh],
    forward: Sequence[NDArray[np.float64]],
    backward: Sequence[NDArray[np.float64]],
    moments: Sequence[Moment],
    message: Sentence,
    control: Control,
) -> Work[int]:
    """Return the moment at which the worse one of both meshes is closest to the surface."""
    errors = {}
    for index in _SWAPS:
        yield Progress(len(errors) / len(_SWAPS), message)
        surface, both = moments[index].surface, (forward[index], backward[index])
        placed = [TriangleMesh(points, mesh.faces) for points, mesh in zip(both, meshes, strict=True)]
        errors[index] = max(VisibleGap.between(own, surface, control).most for own in placed)
    return min(errors, key=errors.__getitem__)


def _pieces(
    samples: Sequence[NDArray[np.float64]], most: float, message: Sentence, control: Control
) -> Work[FittedPieces]:
    """Follow samples, one for each step of the morph, by few straight pieces."""
    path = RefinedPath.of(np.stack(samples), _DOUBLINGS)
    return (yield from fitted_pieces(path, [StayNear(path, most)], message, control))


def _key_path(pieces: FittedPieces, name: str, gap: VisibleGap, size: float) -> KeyPath:
    """Return a path to a surface of some diagonal, with the gap between them."""
    times = tuple(end / (_STEPS * 2**_DOUBLINGS) for end in pieces.ends)
    poor = np.flatnonzero(gap.outside > _FAR * size)
    mean, most, deviation = gap.mean / size, gap.most / size, pieces.deviation / size
    return KeyPath(name, times, pieces.positions, None, deviation, mean, most, turned=0, poor=poor, surface_95=most)
