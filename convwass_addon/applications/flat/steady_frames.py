# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the numbers of regions and holes from changing for a few frames only.

Every blend is extracted by itself. Where two legs just touch, a hole appears in one frame, is missing in the next one
and comes back. Blends that differ for a few frames from those before and after them, which agree, are replaced by means
of these two.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ...errors import InputError
from ...geometry.level_sets.contours import outline_enclosing
from ...geometry.level_sets.flat_mending import FlatConnectivity, FlatMending
from ...geometry.plane.outlines import Outline
from ...geometry.plane.planar_fill import filled_boundary
from ...progress import UNINTERRUPTED, Control
from ..morphs.coinciding_solids import CoincidingSolids
from .flat_blending import finished_frame
from .flat_frames import FlatFrame
from .flat_problem import FlatProblem

# Longest run of frames that is replaced.
_MOST_FRAMES = 3


@dataclass(frozen=True)
class _Counted:
    """A frame with its outline in scene space, and the topology of that."""

    frame: FlatFrame
    outline: Outline
    connectivity: FlatConnectivity

    @classmethod
    def of(cls, frame: FlatFrame, problem: FlatProblem) -> _Counted:
        """Return a frame; an input with the outline that it has at the resolution of the problem."""
        source = frame.blend.source
        if source is None:
            return cls(frame, frame.outline, FlatConnectivity(**frame.record["found"]))
        return cls(frame, problem.outlines[source], problem.connectivity[source])

    @property
    def is_input(self) -> bool:
        return self.frame.blend.source is not None

    def agrees(self, other: _Counted) -> bool:
        return self.connectivity == other.connectivity


def steady_frames(
    frames: Iterable[FlatFrame], problem: FlatProblem, control: Control = UNINTERRUPTED
) -> Iterator[FlatFrame]:
    """Yield the frames of a path, some of them replaced; a frame is at most three frames late.

    A frame stays as it is if its mean has another topology than its neighbors. The record of the others has the entry
    `mean_of_neighbors`; its solver's figures are those of the replaced frame.

    Parameters
    ----------
    frames : iterable of FlatFrame
        In order, with outlines that enclose the interpolated area.
    problem : FlatProblem
        The problem on the grid of the frames.
    control : Control
        Stops the work; frames that wait for the next one are lost then.

    Raises
    ------
    Cancelled
        The work was cancelled.
    """
    before: _Counted | None = None
    waiting: list[_Counted] = []
    for frame in frames:
        waiting.append(_Counted.of(frame, problem))
        while waiting:
            after = _after(before, waiting)
            is_open = after is None and before is not None and not any(later.is_input for later in waiting)
            if is_open and len(waiting) <= _MOST_FRAMES:
                break
            control.check()
            current = waiting.pop(0)
            before = current if after in (None, current) else _steadied(current, before, after, problem)
            yield before.frame
    yield from (left.frame for left in waiting)


def _after(before: _Counted | None, waiting: list[_Counted]) -> _Counted | None:
    """Return the first waiting frame that agrees with the one before, up to the next input."""
    for later in waiting:
        if before is not None and later.agrees(before):
            return later
        if later.is_input:
            break
    return None


def _steadied(current: _Counted, before: _Counted, after: _Counted, problem: FlatProblem) -> _Counted:
    """Return the mean of two frames in place of one between them, or this one if the mean does not agree with them."""
    try:
        mean = _Counted.of(_mean(current, before, after, problem), problem)
    except InputError:
        # Frames that have nothing in common have no mean.
        return current
    return mean if mean.agrees(before) else current


def _mean(current: _Counted, before: _Counted, after: _Counted, problem: FlatProblem) -> FlatFrame:
    """Return the mean of two frames at the time and with the area of one between them."""
    first, own, last = (counted.frame.blend.frame for counted in (before, current, after))
    share = (own - first) / (last - first)
    area = current.outline.area / problem.lattice.spacing**2
    occupancies = [
        problem.lattice.filled(filled_boundary(end.outline.rings, "even-odd"), end.frame.blend.weights)
        for end in (before, after)
    ]
    density = CoincidingSolids.of(occupancies, (1.0 - share, share), area).density
    mending = FlatMending(outline_enclosing(density, area), density)
    figures = {**current.frame.record, "mean_of_neighbors": True}
    return finished_frame(problem, current.frame.blend, mending, figures, current.frame.origins)
