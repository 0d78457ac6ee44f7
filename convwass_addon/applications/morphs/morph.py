# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph meshes of any topology: solids as distributions, Wasserstein barycenters, surfaces.

Section 7 of Solomon et al. 2015, "Shape interpolation": every shape is the normalized indicator of its interior, blends
are barycenters, and a level set of each barycenter is the blended shape.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ..far_meshes import refuse_far
from ..motions.guides import Guide
from .animation import Animation
from .bake_plan import BakePlan
from .frame_cache import BakeCache, FrameCache
from .layouts import Blend
from .morph_problem import MorphFrame
from .morph_settings import MorphSettings
from .part_labels import FaceLabels, matched, unparted
from .remaking import BakeReview, Remaking
from .runs import Run, SolvedRun, as_solved, runs_of

# Share of the progress at which all blends are there for the first time.
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
    workers: int | None = None,
    executor: Executor | None = None,
    cache: FrameCache | None = None,
    wanted: range | None = None,
    previews: bool = False,
    looked_at: int = 0,
    animation: Animation | None = None,
) -> Work[None]:
    """Make the blends of the shapes, one after the other.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        The inputs in one space; open, self-intersecting, disconnected and inside-out ones are welcome.
    names : sequence of str
        What messages call them.
    blends : sequence of Blend
        In an order in which neighbors are similar: each solve starts from the one before.
    settings : MorphSettings
        How.
    control : Control
        Ends the job when cancelled; checked between iterations, in whatever thread computes.
    labels : sequence of FaceLabels, optional
        Parts of the shapes; those of the same name travel together.
    guides : sequence of mappings from int to int, optional
        Points that belong together: for some of the shapes, by their numbers, a vertex of each. They guide the motion.
    workers : int, optional
        Threads that compute short runs of blends side by side; by default one per processor, as far as memory allows.
    executor : concurrent.futures.Executor, optional
        Where to compute the runs instead, in other processes or on other machines;
        `control` is then checked by the one who waits for them, and runs that have begun are left to end by themselves.
        The frames are the same wherever they are computed.
    cache : FrameCache, optional
        Frames that are in it are not computed again, and those that are computed are put into it at once.
    wanted : range, optional
        Indices of blends to make; all of a run is made where one of its blends is wanted, so that frames do not depend
        on how a morph was split.
    previews : bool
        Whether to solve the coarse levels of all blends first, and yield what can be seen of them; not where an
        executor of the caller's computes, nor on a grid that has no coarser one, nor of more runs than there is memory
        for. The frames are the same.
    looked_at : int
        Number of the blend that is being looked at, of those that are made: previews near to it come first.

    animation : Animation, optional
        The inputs of a path at all of its frames, in the order of their vertices in `shapes`: every blend takes them as
        they are at its frame. Motions are chosen for `shapes`, and keep their maps; where the triangles of an input
        change from frame to frame, there is none.

    Yields
    ------
    Progress
        The payloads are every finished :class:`.morph_problem.MorphFrame` in the order of the blends, and every
        :class:`.bake_plan.MorphPreview`. A frame that is changed once all frames between two shapes are known comes
        again after them, and takes the place of the one before; see :mod:`.remaking`.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, where the inputs or the settings cannot work.
    """
    if workers is not None and workers < 1:
        raise InputError("There must be at least one worker.")
    for shape, name in zip(shapes, names, strict=True):
        if not len(shape.faces):
            raise InputError("{name} has no faces with an area; choose an object with a surface.", name=name)
        refuse_far(shape)
    matching = unparted(len(shapes)) if labels is None else matched(labels, names)
    runs = runs_of(blends, wanted)
    followed = [] if animation is None else animation.meshes
    store = None if cache is None else cache.of([*shapes, *followed], names, labels, settings, guides)
    missing = {index: run for index, run in enumerate(runs) if store is None or not store.holds(run)}
    plan = BakePlan(
        shapes=shapes,
        names=names,
        blends=blends,
        settings=settings,
        matching=matching,
        guides=guides,
        runs=missing,
        keeps_potentials=store is not None and store.keeps_potentials,
        workers=workers,
        executor=executor,
        previews=previews,
        looked_at=looked_at,
        animation=animation,
    )
    # Part of a morph may be made elsewhere: only whoever has all of it decides over all of it.
    review = BakeReview(blends if wanted is None else ())
    with ExitStack() as stack:
        solved: Iterator[SolvedRun] = iter(())
        fraction, problem = 0.0, None
        if missing:
            begun = yield from plan.begun(stack, control)
            solved, fraction, problem = as_solved(begun.pending, control), begun.fraction, begun.problem
        total = sum(map(len, runs))
        span = (_REVIEWED_FROM if review.is_needed else 1.0) - fraction
        for done, frame in enumerate(in_order(runs, missing, solved, store), start=1):
            review.hear(frame)
            ends = done == total and review.is_done()
            share = 1.0 if ends else fraction + span * done / total
            yield Progress(share, Sentence("Blend {done} of {total}", {"done": done, "total": total}), frame)
        remaking = Remaking(plan, runs, store, problem, control)
        yield from within(remaking.fitted(review), fraction + span, 1.0)


def in_order(
    runs: Sequence[Run], missing: dict[int, Run], solved: Iterator[SolvedRun], store: BakeCache | None
) -> Iterator[MorphFrame]:
    """Yield the frames of all runs in their order, from the cache or as they are solved, which may be in any order."""
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
