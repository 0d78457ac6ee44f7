# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fit a skeleton into a body: some joints are pinned, the others are laid out inside.

Solomon et al. 2015, section 7, "Skeleton layout".
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.inner_balls import inner_balls
from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..usable_meshes import refuse_far
from .skeleton_bodies import SkeletonBody, skeleton_body
from .skeleton_carrying import between_pins, carried
from .skeleton_checks import check_inside, check_loops, check_pins, named
from .skeleton_graph import JointGraph
from .skeleton_layout import Layout, LayoutProblem
from .skeleton_notices import bone_notices
from .skeleton_settings import SkeletonSettings
from .skeleton_settling import settled

# Chosen by eye; docs/performance, "Skeletons", lists what these and the other constants of the fit achieve.
# If the mean of a joint lies outside, the layout is repeated with a kernel wider by this factor, at most this often.
_NOTCH, _NOTCHES = 1.6, 2
# Depth below the surface, in diagonals of the body, to which joints outside are moved.
_DEPTH = 0.01


@dataclass(frozen=True)
class FittedSkeleton:
    """Positions of a skeleton's joints in a body.

    Attributes
    ----------
    positions : (v, 3) float64
        In the space of the body; pins keep their positions unless they were moved inside.
    inside : (v,) bool
        Whether each joint lies inside the body.
    winding : (v,) float64
        Winding number of the body at each joint: about 1 inside.
    projected : (v,) bool
        Joints that ended up outside and were moved to the nearest point inside.
    record : dict
        JSON-ready figures of the fit: `settings`, `gamma`, `iterations`, `marginal_error`, `converged`, `solves`,
        `vertices` of the surface used and `body`, how it was made, `links`, and the numbers of joints `inside` and
        `projected`.
    notices : tuple of Sentence
        Warnings for the user.
    """

    positions: NDArray[np.float64]
    inside: NDArray[np.bool_]
    winding: NDArray[np.float64]
    projected: NDArray[np.bool_]
    record: dict[str, object]
    notices: tuple[Sentence, ...]

    __repr__ = one_line("positions", "inside", "notices")


def fit_steps(
    mesh: TriangleMesh, graph: JointGraph, settings: SkeletonSettings, control: Control = UNINTERRUPTED
) -> Work[FittedSkeleton]:
    """Lay out the free joints of a skeleton inside a body.

    Parameters
    ----------
    mesh : TriangleMesh
        The body, in the space of the joints. May be open, in touching parts, with any number of vertices.
    graph : JointGraph
        The skeleton, with some joints pinned.
    settings : SkeletonSettings
        Settings of the fit.
    control : Control
        Stops the job when cancelled.

    Yields
    ------
    Progress
        Before every stage of the work.

    Returns
    -------
    FittedSkeleton

    Raises
    ------
    InputError, ResourceError
        Before the work starts: a skeleton without bones or with too few pins, pins outside the body or coincident, or a
        body that encloses nothing. The message says what to add.
    """
    refuse_far(mesh)
    check_pins(graph)
    kept = between_pins(graph)
    core = graph.part(kept)
    check_loops(core)
    yield Progress(0.0, Sentence("Preparing the body"))
    names = [name for name, is_pinned in zip(graph.names, graph.pinned, strict=True) if is_pinned]
    body = skeleton_body(mesh, graph.positions[graph.pinned], names, settings.thickness, control)
    placed, notices = _with_pins_inside(graph, body, settings)
    core = placed.part(kept)
    balls = inner_balls(body.surface) if settings.placement == "centered" else None
    problem = LayoutProblem(core, body, settings)
    gamma, inner = settings.gamma, np.empty(0, bool)
    for attempt in range(_NOTCHES + 1):
        yield Progress(0.1 + 0.2 * attempt, Sentence("Laying out {count} joints", {"count": int((~core.pinned).sum())}))
        layout = problem.solved(gamma, control)
        core_positions = (
            layout.positions if balls is None else settled(core, layout.positions, problem.lengths, balls, body.inside)
        )
        inner = body.inside.contains(core_positions)
        if balls is not None or inner[~core.pinned].all():
            break
        gamma = _NOTCH * layout.gamma
    positions = placed.positions.copy()
    positions[kept] = core_positions
    if not kept.all():
        positions = carried(graph, positions, kept)
        loose = {"names": named(graph, np.flatnonzero(~kept))}
        notices.append(Sentence("No pin lies beyond these joints, which keep their shape: {names}.", loose))
    fitted = _all_inside(placed, positions, body, notices)
    notices += bone_notices(core, fitted.positions[kept], problem.lengths, body)
    record = _record(layout, body, fitted, attempt + 1, settings)
    yield Progress(1.0, Sentence("Fitted {count} joints", {"count": int((~graph.pinned).sum())}))
    return replace(fitted, record=record, notices=tuple(notices))


def _with_pins_inside(
    graph: JointGraph, body: SkeletonBody, settings: SkeletonSettings
) -> tuple[JointGraph, list[Sentence]]:
    """Check that the pins lie inside, or move them inside and report it."""
    pins = np.flatnonzero(graph.pinned)
    outside = pins[~body.inside.contains(graph.positions[pins])]
    nearest = body.inside.nearest(graph.positions[outside], _DEPTH * body.surface.diagonal)
    if settings.outside_pins == "refuse" or not nearest.found.all():
        check_inside(graph, outside, nearest.positions)
    if not len(outside):
        return graph, []
    positions = graph.positions.copy()
    positions[outside] = nearest.positions
    moved = {"names": named(graph, outside)}
    return replace(graph, positions=positions), [Sentence("Pins moved into the body: {names}.", moved)]


def _all_inside(
    graph: JointGraph, positions: NDArray[np.float64], body: SkeletonBody, notices: list[Sentence]
) -> FittedSkeleton:
    """Move joints that ended up outside to the nearest point inside, and report it."""
    free = np.flatnonzero(~graph.pinned)
    outside = free[~body.inside.contains(positions[free])]
    nearest = body.inside.nearest(positions[outside], _DEPTH * body.surface.diagonal)
    positions[outside] = nearest.positions
    projected = np.zeros(len(positions), bool)
    projected[outside] = nearest.found
    if nearest.found.any():
        moved = {"names": named(graph, outside[nearest.found])}
        notices.append(Sentence("Moved into the body, as they came to lie outside: {names}.", moved))
    if not nearest.found.all():
        left = {"names": named(graph, outside[~nearest.found])}
        notices.append(Sentence("Outside the body: {names}. Pin more joints near them.", left))
    winding = body.inside.winding(positions)
    return FittedSkeleton(positions, winding > 0.5, winding, projected, {}, ())


def _record(
    layout: Layout, body: SkeletonBody, fitted: FittedSkeleton, solves: int, settings: SkeletonSettings
) -> dict[str, object]:
    solution = layout.solution
    error = solution.marginal_error
    return {
        "settings": settings.as_dict(),
        "gamma": float(layout.gamma),
        "iterations": int(solution.iterations),
        "marginal_error": float(error) if np.isfinite(error) else None,
        "converged": bool(solution.converged.all()),
        "solves": solves,
        "vertices": len(body.surface.vertices),
        "body": body.made,
        "links": layout.links,
        "inside": int(fitted.inside.sum()),
        "projected": int(fitted.projected.sum()),
    }
