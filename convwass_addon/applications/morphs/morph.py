# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack

from ...geometry.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..motions.guides import Guide
from ..usable_meshes import require_surface
from .animation import Animation
from .bake_plan import BakePlan
from .computation import USUAL_COMPUTATION, Computation
from .frame_cache import BakeCache
from .layouts import Blend, pairs_of
from .morph_problem import MorphFrame
from .morph_settings import MorphSettings
from .part_labels import FaceLabels, matching_of
from .plated_shapes import PlatedShapes
from .remaking import BakeReview, Remaking
from .runs import Run, SolvedRun, as_solved, runs_of

# Fraction of the progress at which all blends have been computed once.
_REVIEWED_FROM = 0.95


def morph(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    blends: Sequence[Blend],
    settings: MorphSettings,
    control: Control = UNINTERRUPTED,
    *,
    labels: Sequence[FaceLabels] | None = None,
    guides: Sequence[Guide] = (),
    computation: Computation = USUAL_COMPUTATION,
    animation: Animation | None = None,
    pairs: Sequence[tuple[int, int]] | None = None,
) -> Work[None]:
    """Compute the blends of shapes.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        The inputs in a common space; they may be open, self-intersecting, disconnected or inside-out.
    names : sequence of str
        Names of the shapes, for messages.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the previous blend.
    settings : MorphSettings
        How the morph is made.
    control : Control
        Cancels the job; checked between iterations, in every computing thread.
    labels : sequence of FaceLabels, optional
        Parts of the shapes; parts of the same name travel together.
    guides : sequence of mappings from int to int, optional
        Points that correspond: each maps indices of shapes to one of their vertices. They guide the motion.
    computation : Computation
        Which blends are computed, and where; by default all, by the threads of this machine.
    animation : Animation, optional
        The inputs of a path at all of its frames, with the vertices in the order of `shapes`: every blend uses them as
        they are at its frame. Motions are determined for `shapes`. If the triangles of an input change from frame to
        frame, there is no motion.
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
    for shape, name in zip(shapes, names, strict=True):
        require_surface(shape, name)
    plated = PlatedShapes.of(shapes, settings, matching_of(labels, names), animation)
    runs = runs_of(blends, computation.wanted)
    pairs = pairs_of(blends) if pairs is None else pairs
    cache = computation.cache
    store = None if cache is None else cache.of(shapes, names, labels, settings, guides, pairs, animation)
    missing = {index: run for index, run in enumerate(runs) if store is None or not store.holds(run)}
    plan = BakePlan(
        shapes=plated.shapes,
        names=names,
        blends=blends,
        pairs=pairs,
        settings=settings,
        matching=plated.matching,
        guides=guides,
        runs=missing,
        keeps_potentials=store is not None and store.keeps_potentials,
        computation=computation,
        animation=plated.animation,
    )
    # If other parts of the morph are computed elsewhere, no decisions over all of it are possible here.
    reviewed = blends if computation.wanted is None else ()
    review = BakeReview(reviewed, _unblended(reviewed, plated.shapes, plated.animation))
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


def _unblended(
    blends: Sequence[Blend], shapes: Sequence[TriangleMesh], animation: Animation | None
) -> dict[Blend, TriangleMesh]:
    """Return the meshes of blends that are a single input, as it is at their time."""
    alone = {blend: blend.source for blend in blends if blend.source is not None}
    if animation is None:
        return {blend: shapes[index] for blend, index in alone.items()}
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
