# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph flat shapes: indicators in a plane as distributions, barycenters, outlines (Solomon et al., Figs. 12, 13)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..morphs.layouts import Blend
from ..morphs.morph import in_order
from ..morphs.moving_problem import solve_moving_blends
from ..morphs.runs import as_solved, runs_of, solved_in_threads
from ..workers import thread_count
from .flat_blending import solve_flat_blends
from .flat_motion import chosen_flat_motion
from .flat_moving import FlatMovingProblem
from .flat_problem import flat_problem, pieces_of
from .flat_settings import FlatSettings
from .flat_shapes import FlatInput
from .steady_frames import steady_frames

# Fractions of the progress after rasterizing the shapes, and after choosing the motion.
_BEGUN, _CHOSEN = 0.05, 0.3


def flat_morph(
    shapes: Sequence[FlatInput],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: FlatSettings,
    control: Control = UNINTERRUPTED,
    *,
    workers: int | None = None,
    wanted: range | None = None,
) -> Work[None]:
    """Compute the blends of flat shapes.

    Parameters
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs, each in its own plane, with the same axes.
    names : sequence of str
        Names of the shapes, for messages.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the previous blend.
    settings : FlatSettings
        Settings of the morph.
    control : Control
        Cancels the work.
    workers : int, optional
        Threads that compute short runs of blends in parallel; by default one per processor, as far as memory allows.
        The frames do not depend on it.
    wanted : range, optional
        Indices of the blends to compute; runs are always computed as a whole. Only if all blends are computed, those
        of a path are compared with their neighbors; see :mod:`.steady_frames`.

    Yields
    ------
    Progress
        The payloads are every finished :class:`.flat_frames.FlatFrame`, in the order of the blends.

    Raises
    ------
    InputError
        Before the first frame, if the inputs or the settings are invalid.
    """
    threads = thread_count(workers)
    if not shapes or len(shapes) != len(names):
        raise InputError("A morph needs at least two shapes; select or name one more.")
    runs = dict(enumerate(runs_of(blends, wanted)))
    yield Progress(0.0, Sentence("Laying out the grid"))
    control.check()
    pieces = pieces_of(shapes, names, settings)
    problem = flat_problem(shapes, pieces, names, settings)
    yield Progress(_BEGUN, Sentence("Drew the shapes on the grid"))
    work = chosen_flat_motion(pieces, names, blends, settings, problem.lattice.centers, control)
    choice = yield from within(work, _BEGUN, _CHOSEN)
    problem = replace(problem, motion=choice.record)
    threads = min(threads, len(runs))
    fitting = problem.lattice.fitting_workers(len(shapes), len(problem.transport.parts), threads)
    total = sum(map(len, runs.values()))
    solve = partial(solve_flat_blends, problem)
    if choice.motion is not None:
        moving = FlatMovingProblem.of(problem, shapes, choice.motion, blends, control)
        solve, problem = partial(solve_moving_blends, moving), moving.still
    with solved_in_threads(solve, problem.transport.effort, runs, control, fitting) as pending:
        frames = in_order(list(runs.values()), runs, as_solved(pending, control), None)
        if _are_steadied(blends, settings, wanted):
            frames = steady_frames(frames, problem, control)
        for done, frame in enumerate(frames, start=1):
            fraction = _CHOSEN + (1.0 - _CHOSEN) * done / total
            yield Progress(fraction, Sentence("Blend {done} of {total}", {"done": done, "total": total}), frame)


def _are_steadied(blends: Sequence[Blend], settings: FlatSettings, wanted: range | None) -> bool:
    """Return whether blends are compared with their neighbors: on whole paths, unless transport was requested."""
    along = all(blend.frame is not None for blend in blends)
    mended = settings.mend and settings.output == "outlines" and settings.level != "half-max"
    return along and mended and settings.motion != "transport" and wanted is None
