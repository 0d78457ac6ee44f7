# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guided motion of flat shapes whose outlines are mapped onto each other completely."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.closed_curves import boundary_of
from ...geometry.coverage import coverage
from ...geometry.foldover_free import DeformedTriangles
from ...geometry.planar_fill import Boundary
from ...progress import Control
from ..motions.carriers import Carrier, carrier_of
from ..motions.choosing import MotionChoice
from ..motions.coherence import FULL_COHERENCE
from ..motions.guided_motion import GuidedMotion, GuidedPair
from ..motions.guided_settings import GuidedSettings
from ..motions.laid_meshes import Laid
from ..motions.shape_deformations import ShapeDeformation, split_deformation
from .agreeing_motion import AgreeingMotion
from .outline_meshes import filled_outline, outline_knots, outline_mesh
from .outline_pairs import OutlinedShape, ShapePair, matched_shapes
from .sheets import Sheet
from .sliding_outlines import least_distorted

# Edge length of the triangles, relative to the size of the shape.
_TRIANGLES = 0.028
# Limbs do not swing if more than this share of the area overlaps itself then, at some moments; and cells along the
# longest side of the grid on which that is measured.
_MOST_OVERLAP, _MOMENTS, _CELLS = 0.01, (0.75, 0.5, 0.25), 128
# Carriers have at least this number of vertices, and are never coarser than the shapes.
_VERTICES = 6000


@dataclass(frozen=True)
class MovedSheets:
    """Flat shapes that move as a body.

    Attributes
    ----------
    sheets : tuple of Sheet
        The shapes.
    choice : MotionChoice
        Their motion.
    distortion : float
        By how much it distorts their insides: 3 for similar shapes, 4 to 25 for letters.
    overlap : float
        Largest share of their area that overlaps itself on the way.
    """

    sheets: tuple[Sheet, ...]
    choice: MotionChoice
    distortion: float = 0.0
    overlap: float = 0.0


def outline_motion(
    parts: Sequence[Boundary],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    coherence: float,
    control: Control,
) -> MovedSheets | None:
    """Return the guided motion of flat shapes, or None if their outlines do not match.

    Parameters
    ----------
    parts : sequence of Boundary
        The shapes.
    names : sequence of str
        Names of the shapes, for messages.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    coherence : float
        As for :class:`.GuidedSettings`.
    control : Control
        Stops the work.
    """
    shapes = [OutlinedShape.of(part) for part in parts]
    found = _Matched.of(shapes, pairs, least_distorted, control)
    if found is None:
        return None
    moved = _moved(found, names, coherence, control)
    if found.swings and moved.overlap > _MOST_OVERLAP:
        placed = _moved(_Matched.of(shapes, pairs, _as_placed, control), names, coherence, control)
        moved = min(moved, placed, key=lambda own: own.overlap)
    return moved


@dataclass(frozen=True)
class _Matched:
    """Flat shapes, with points that are holes of other ones, and the matches of those that occur together."""

    shapes: list[OutlinedShape]
    matches: dict[tuple[int, int], ShapePair]

    @classmethod
    def of(
        cls,
        shapes: Sequence[OutlinedShape],
        pairs: Sequence[tuple[int, int]],
        choose: Callable[[Sequence[ShapePair], Control], ShapePair],
        control: Control,
    ) -> _Matched | None:
        """Match shapes; None if some do not match. Of several matches, one is chosen."""
        grown, matches = list(shapes), {}
        for one, other in pairs:
            control.check()
            found = matched_shapes(grown[one], grown[other])
            if not found:
                return None
            match = choose(found, control)
            matches[one, other], grown[one], grown[other] = match, match.first, match.second
        # Later pairs have added points to the shapes.
        whole = {
            (one, other): replace(match, first=grown[one], second=grown[other])
            for (one, other), match in matches.items()
        }
        return cls(grown, whole)

    @property
    def swings(self) -> bool:
        """Whether limbs swing in a match."""
        return any(own.swings for match in self.matches.values() for own in match.outer)


def _as_placed(matches: Sequence[ShapePair], control: Control) -> ShapePair:
    """Return the match of two shapes as they are placed."""
    return matches[0]


def _moved(matched: _Matched, names: Sequence[str], coherence: float, control: Control) -> MovedSheets:
    """Return the motion of matched shapes."""
    shapes, matches = matched.shapes, matched.matches
    knots = outline_knots(shapes, matches)
    sheets = tuple(_sheet(shape, own) for shape, own in zip(shapes, knots, strict=True))
    # Nothing is left for what resists stretching.
    most = max(len(sheet.mesh.vertices) for sheet in sheets)
    settings = GuidedSettings(coherence=min(coherence, FULL_COHERENCE), carrier_vertices=max(2 * most, _VERTICES))
    none = np.empty(0, np.int64)
    carriers = tuple(
        carrier_of(sheet.mesh, name, none, settings.carrier_vertices, control)
        for sheet, name in zip(sheets, names, strict=True)
    )
    deformations: dict[tuple[int, int], ShapeDeformation] = {}
    distortion = 0.0
    for (one, other), match in matches.items():
        ends = carriers[one], carriers[other]
        there, home = _filled(ends[0], match, control), _filled(ends[1], match.swapped(), control)
        distortion = max(distortion, there.distortion, home.distortion)
        deformations[one, other] = split_deformation(*ends, _laid(there), None, control)
        deformations[other, one] = split_deformation(*ends[::-1], _laid(home), deformations[one, other], control)
    known = {pair: _figures(match) for pair, match in matches.items()}
    motion = AgreeingMotion(GuidedMotion(carriers, deformations, known, settings))
    turned = max((abs(pair.turn) for pair in known.values()), default=0.0)
    choice = MotionChoice("guided", "OUTLINES", motion, turned=turned)
    overlap = max((_overlap(sheets, motion, pair) for pair in matches), default=0.0)
    return MovedSheets(sheets, choice, distortion, overlap)


def _overlap(sheets: Sequence[Sheet], motion: AgreeingMotion, pair: tuple[int, int]) -> float:
    """Return the largest share of the area of two moved shapes that overlaps itself, at some moments of their way."""
    found = []
    for share in _MOMENTS:
        weights = np.zeros(len(sheets))
        weights[list(pair)] = share, 1.0 - share
        moved = sheets[pair[0]].moved(motion.moved(weights)[pair[0]])
        low, high = moved.bounds
        spacing = float((high - low).max()) / _CELLS
        cells = tuple(np.ceil((high - low) / spacing).astype(int))
        covered = coverage(moved.moved(-low / spacing, 1.0 / spacing), cells).sum() * spacing**2
        found.append(1.0 - float(covered) / moved.area)
    return max(found)


def _figures(match: ShapePair) -> GuidedPair:
    """Return the figures of a match; of several regions, those of the worst and of the one that turned most."""
    work = max(own.cost for own in match.outer)
    turn = max((own.turn for own in match.outer), key=abs)
    return GuidedPair(float(np.exp(-work)), 0, 1.0, float(np.degrees(turn)))


def _sheet(shape: OutlinedShape, knots: Sequence[NDArray[np.float64]]) -> Sheet:
    """Triangulate a shape, with vertices at the knots of every curve."""
    exact = [curve.with_places(own) for curve, own in zip(shape.curves, knots, strict=True)]
    return Sheet.attached(boundary_of(exact), outline_mesh(shape, knots, _TRIANGLES))


def _filled(carrier: Carrier, match: ShapePair, control: Control) -> DeformedTriangles:
    """Move the mesh of the first shape so that its outline lies on that of the second one."""
    return filled_outline(carrier.unit, carrier.mesh, match, control)


def _laid(filled: DeformedTriangles) -> Laid:
    """Return positions in space."""
    points = filled.points
    return Laid(np.column_stack([points, np.zeros(len(points))]), np.ones(len(points)))
