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

import numpy as np

from ...geometry.contours import outline_enclosing
from ...geometry.coverage import coverage
from ...geometry.flat_mending import FlatConnectivity, FlatMending
from ...geometry.outlines import Outline
from ...geometry.planar_fill import filled_boundary
from ..morphs.coinciding_solids import CoincidingSolids
from .flat_blending import finished_frame
from .flat_frames import FlatFrame
from .flat_outlines import own_outline
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
        source = frame.blend.source
        if source is None:
            return cls(frame, frame.outline, FlatConnectivity(**frame.record["found"]))
        own = own_outline(problem.transport.occupancy(source), problem.silhouettes[source])
        outline = problem.lattice.to_scene(own.outline, frame.blend.weights)
        return cls(frame, outline, problem.connectivity[source])


def steady_frames(frames: Iterable[FlatFrame], problem: FlatProblem) -> Iterator[FlatFrame]:
    """Yield the frames of a path, some of them replaced; a frame is at most three frames late.

    Parameters
    ----------
    frames : iterable of FlatFrame
        In order, with outlines that enclose the interpolated area.
    problem : FlatProblem
        The problem whose grid they were extracted on.
    """
    before: _Counted | None = None
    waiting: list[_Counted] = []
    for frame in frames:
        waiting.append(_Counted.of(frame, problem))
        while waiting:
            after = next((one for one in waiting if _agree(before, one)), None)
            if after is None and before is not None and len(waiting) <= _MOST_FRAMES:
                break
            before = _fitted(waiting.pop(0), before, after, problem)
            yield before.frame
    yield from (one.frame for one in waiting)


def _agree(before: _Counted | None, after: _Counted) -> bool:
    return before is not None and before.connectivity == after.connectivity


def _fitted(one: _Counted, before: _Counted | None, after: _Counted | None, problem: FlatProblem) -> _Counted:
    """Return a frame, or instead the mean of two that agree, if this has the same topology as they."""
    if after is None or _agree(before, one) or one.frame.blend.source is not None:
        return one
    mean = _Counted.of(_mean(one, before, after, problem), problem)
    return mean if _agree(before, mean) else one


def _mean(one: _Counted, before: _Counted, after: _Counted, problem: FlatProblem) -> FlatFrame:
    """Return the mean of two frames in place of one between them, with its area."""
    numbers = [each.frame.blend.frame for each in (before, one, after)]
    share = (numbers[1] - numbers[0]) / (numbers[2] - numbers[0])
    lattice = problem.lattice
    area = one.outline.area / lattice.spacing**2
    occupancies = []
    for other in (before, after):
        corner, scale = lattice.corner(other.frame.blend.weights), 1.0 / lattice.spacing
        boundary = filled_boundary([np.asarray(ring) for ring in other.outline.rings], "even-odd")
        occupancies.append(coverage(boundary.moved(-corner * scale, scale), lattice.shape))
    density = CoincidingSolids.of(occupancies, (1.0 - share, share), area).density
    mending = FlatMending(outline_enclosing(density, area), density)
    figures = {**one.frame.record, "mean_of_neighbors": True}
    return finished_frame(problem, one.frame.blend, mending, figures, one.frame.origins)
