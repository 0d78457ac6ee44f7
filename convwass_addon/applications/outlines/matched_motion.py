# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guided motion of flat shapes that are matched as they are, with all their limbs."""

from __future__ import annotations

from collections.abc import Sequence

from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion_choice import attempted
from ..workers import one_blas_thread
from .hole_openings import surplus_holes, with_open_holes
from .matched_outlines import only_placed
from .moved_sheets import MatchedShapes, MovedSheets, least_cost, moved_sheets
from .outline_pairs import KnownMatches, ShapePair
from .outlined_shape import OutlinedShape
from .region_counts import with_equal_counts
from .sliding_outlines import least_effort

MOST_REGIONS = 32
"""Shapes of more regions are not matched by their outlines."""

# Where shapes have different numbers of regions, those with less than the first of these shares of the area of what
# they belong to grow from points, and larger ones get pieces of it; or else all but the largest one grow.
_LEAST_SHARES = 0.1, 1.0
# Holes that the other shape has not are opened to the outside if that takes less than this share of the effort that
# shrinking to points takes, which is tried from this cost on, and for up to so many holes. By eye, shares up to 0.64
# are better opened, such as an O that becomes a C (0.13), a g that becomes a U (0.49) and a K that becomes a g (0.59),
# and shares from 0.73 on are not, such as a D that becomes an I (0.76) and a lock that becomes a bell (0.87).
_CLEARLY_LESS, _OPENED_FROM, _MOST_OPENED = 0.65, 6.0, 4
# Limbs do not swing if more than this share of the area overlaps itself then, at some moments.
_MOST_OVERLAP = 0.01
# If more than the first share overlaps where regions turn, they are also moved as they stand. Shares count this many
# times as much as the distortion then: a mouth that would turn across an eye bends (share 0.003, distortion 3.0 and as
# it stands 3.2), and an M that becomes a W beside an O turns, although it touches that (0.003, 3.4 and 14).
_TOUCHING, _COLLIDING = 0.001, 300.0


def have_few_regions(shapes: Sequence[OutlinedShape]) -> bool:
    """Return whether shapes have regions, and at most `MOST_REGIONS`."""
    return all(1 <= len(shape.regions) <= MOST_REGIONS for shape in shapes)


def matched_motion(
    shapes: Sequence[OutlinedShape],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    settings: GuidedSettings,
    known: KnownMatches,
    control: Control,
) -> MovedSheets | None:
    """Return the guided motion of flat shapes, or None if one has more than `MOST_REGIONS` regions, or none.

    Where one shape has fewer regions than another, these are divided, or those of the other one grow from points,
    whichever distorts the shapes less. Where one has more holes, these shrink to points, or are opened to the outside.

    Parameters
    ----------
    shapes : sequence of OutlinedShape
        The shapes.
    names : sequence of str
        Names of the shapes, for messages.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    settings : GuidedSettings
        Its `coherence` and `mean_stretch` are used.
    known : KnownMatches
        Matches curves around regions.
    control : Control
        Stops the work.
    """
    if not have_few_regions(shapes):
        return None
    completed = {_points(own): own for own in (with_equal_counts(shapes, pairs, share) for share in _LEAST_SHARES)}
    with one_blas_thread():
        closed, whole = None, shapes
        for own in completed.values():
            if closed is None or least_cost(own, pairs) < closed.cost:
                found = _best_moved(own, names, pairs, settings, known, control)
                if closed is None or found.cost < closed.cost:
                    closed, whole = found, own
        if closed.cost < _OPENED_FROM or not 0 < surplus_holes(whole, pairs) <= _MOST_OPENED:
            return closed
        opened = attempted(lambda: _best_moved(with_open_holes(whole, pairs), names, pairs, settings, known, control))
    return opened if opened is not None and opened.effort < _CLEARLY_LESS * closed.effort else closed


def _points(shapes: Sequence[OutlinedShape]) -> tuple[int, ...]:
    """Return how many regions of each shape are points, which tells ways to complete the shapes apart."""
    return tuple(sum(region.is_point for region in shape.regions) for shape in shapes)


def _best_moved(
    shapes: Sequence[OutlinedShape],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    settings: GuidedSettings,
    known: KnownMatches,
    control: Control,
) -> MovedSheets:
    """Return the motion of shapes of equal numbers of regions; these turn and their limbs swing unless they collide."""
    found = MatchedShapes.of(shapes, pairs, least_effort, known, control)
    moved = moved_sheets(found, names, settings, control)
    if (found.swings or found.unrolls) and moved.overlap > _MOST_OVERLAP:
        for choose in (_rolled if found.unrolls else _as_strokes, _as_placed):
            other = MatchedShapes.of(shapes, pairs, choose, known, control)
            if moved.overlap > _MOST_OVERLAP and (choose is not _as_strokes or other.unrolls):
                moved = min(moved, moved_sheets(other, names, settings, control), key=_damage)
    if found.turns and moved.overlap > _TOUCHING:
        upright = MatchedShapes.of(shapes, pairs, _as_placed, KnownMatches(only_placed), control)
        placed = moved_sheets(upright, names, settings, control)
        moved = min(moved, placed, key=lambda own: own.distortion + _COLLIDING * own.overlap)
    return moved


def _damage(moved: MovedSheets) -> tuple[float, float]:
    """Return what is to be small: the overlap, and of motions without much of it the distortion."""
    return max(moved.overlap, _MOST_OVERLAP), moved.distortion


def _as_strokes(matches: Sequence[ShapePair], control: Control) -> ShapePair:
    """Return the match of two shapes as strokes, or as they are placed if they are none."""
    return next((match for match in matches if match.unrolled > 0.0), matches[0])


def _rolled(matches: Sequence[ShapePair], control: Control) -> ShapePair:
    """Return the match of two shapes that takes the least effort of those in which no stroke unrolls."""
    return least_effort([match for match in matches if match.unrolled == 0.0], control)


def _as_placed(matches: Sequence[ShapePair], control: Control) -> ShapePair:
    """Return the match of two shapes as they are placed."""
    return matches[0]
