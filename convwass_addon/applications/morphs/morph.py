# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack

from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..usable_meshes import require_surface
from .bake_plan import BakePlan
from .computation import USUAL_COMPUTATION, Computation
from .frame_cache import BakeCache
from .layouts import Blend, pairs_of
from .morph_inputs import MorphInputs
from .morph_problem import MorphFrame
from .morph_settings import MorphSettings
from .plated_shapes import with_plates
from .remaking import BakeReview, Remaking
from .runs import Run, SolvedRun, as_solved, runs_of

# Fraction of the progress at which all blends have been computed once.
_REVIEWED_FROM = 0.95


def morph(
    inputs: MorphInputs,
    blends: Sequence[Blend],
    settings: MorphSettings,
    control: Control = UNINTERRUPTED,
    *,
    computation: Computation = USUAL_COMPUTATION,
    pairs: Sequence[tuple[int, int]] | None = None,
) -> Work[None]:
    """Compute the blends of shapes.

    Parameters
    ----------
    inputs : MorphInputs
        The shapes, and what is known of how they correspond.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the previous blend.
    settings : MorphSettings
        How the morph is made.
    control : Control
        Cancels the job; checked between iterations, in every computing thread.
    computation : Computation
        Which blends are computed, and where; by default all, by the threads of this machine.
    pairs : sequence of (int, int), optional
        Pairs of inputs that the motion has to suit, smaller index first; by default those that occur together in
        `blends`.

    Yields
    ------
    Progress
        The payloads are every finished :class:`.morph_problem.MorphFrame` in the order of the blends, and every
        :class:`.bake_plan.MorphPreview`. A frame that is revised once all frames between two shapes are known is
        yielded again at the end, and replaces the earlier one; see :mod:`.remaking`.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, if the inputs or the settings are invalid.
    """
    for shape, name in zip(inputs.shapes, inputs.names, strict=True):
        require_surface(shape, name)
    plated = with_plates(inputs, settings)
    runs = runs_of(blends, computation.wanted)
    pairs = pairs_of(blends) if pairs is None else pairs
    cache = computation.cache
    store = None if cache is None else cache.of(inputs, settings, pairs)
    missing = {index: run for index, run in enumerate(runs) if store is None or not store.holds(run)}
    plan = BakePlan(
        inputs=plated,
        blends=blends,
        pairs=pairs,
        settings=settings,
        runs=missing,
        keeps_potentials=store is not None and store.keeps_potentials,
        computation=computation,
    )
    # If other parts of the morph are computed elsewhere, no decisions over all of it are possible here.
    reviewed = blends if computation.wanted is None else ()
    review = BakeReview(reviewed, _unblended(reviewed, plated))
    with ExitStack() as stack:
        solved: Iterator[SolvedRun] = iter(())
        fraction, problem = 0.0, None
        if missing:
            begun = yield from plan.begun(stack, control)
            solved, fraction, problem = as_solved(begun.pending, control), begun.fraction, begun.problem
        total = sum(map(len, runs))
        span = (_REVIEWED_FROM if review.is_needed else 1.0) - fraction
        for done, frame in enumerate(in_order(runs, missing, solved, store), start=1):
            review.add(frame)
            ends = done == total and review.is_done()
            share = 1.0 if ends else fraction + span * done / total
            yield Progress(share, Sentence("Blend {done} of {total}", {"done": done, "total": total}), frame)
        remaking = Remaking(plan, runs, store, problem, control)
        yield from within(remaking.fitted(review), fraction + span, 1.0)


def _unblended(blends: Sequence[Blend], inputs: MorphInputs) -> dict[Blend, TriangleMesh]:
    """Return the meshes of blends that are a single input, as it is at their time."""
    alone = {blend: blend.source for blend in blends if blend.source is not None}
    animation = inputs.animation
    if animation is None:
        return {blend: inputs.shapes[index] for blend, index in alone.items()}
    return {blend: animation.shapes[index].at(animation.time_of(blend.weights)) for blend, index in alone.items()}


def in_order(
    runs: Sequence[Run], missing: dict[int, Run], solved: Iterator[SolvedRun], store: BakeCache | None
) -> Iterator[MorphFrame]:
    """Yield the frames of all runs in order, from the cache or as they are solved, which may be in any order."""
    ready: dict[int, list[MorphFrame]] = {}
    for index, run in enumerate(runs):
        if index not in missing:
            yield from store.load(run)
            continue
        while index not in ready:
            done = next(solved)
            if store is not None:
                store.save(run=runs[done.index], frames=done.frames)
            ready[done.index] = done.frames
        yield from ready.pop(index)
