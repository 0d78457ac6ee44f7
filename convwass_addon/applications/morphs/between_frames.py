# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends between the frames of a path, such as 7.35, solved from the potentials of the frames around them.

The potentials of a barycenter are smooth functions of its weights, so interpolated potentials are nearly right, and one
or two rounds at the finest level are enough. Interpolating densities instead would give a cross-fade. An unblended
shape has no potentials; next to it, blends start from their only neighbor that has some.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Literal

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ...transport import Barycenter, Inputs, KernelTooNarrowError, barycenter_between, barycenter_from_neighbor
from ..workers import frame_workers, thread_count
from .blend_solver import SolvedBlend
from .blending import solve_blends, surfaced_frame
from .computation import Computation
from .frame_cache import BakeCache
from .layouts import Blend, pairs_of
from .morph import morph
from .morph_inputs import MorphInputs
from .morph_problem import MorphFrame, MorphProblem
from .morph_settings import MorphSettings
from .plated_shapes import with_plates
from .preparing import VOXEL_SHARE, prepared_problem
from .resting_problem import RestingProblem
from .runs import Run, as_solved, runs_elsewhere, runs_in_threads, runs_of
from .transport_problem import MorphPart
from .volumes import fitting_workers

# Fraction of the progress at which the missing frames have been computed.
_ABOUT_SHARE = 0.6
# Limit for rounds from two neighbors. If they are too far apart for that, a solve from coarse to fine is cheaper.
_MOST_ROUNDS = 8


@dataclass(frozen=True)
class Place:
    """A position on a path.

    Attributes
    ----------
    blend : Blend
        The blend at this position, with its place on a sheet.
    about : tuple of int
        The index of the frame at this position, or of the two frames around it.
    share : float
        Position between these two, from 0 to 1; 0 at a frame.
    """

    blend: Blend
    about: tuple[int, ...]
    share: float


def places_at(path: Sequence[Blend], numbers: Sequence[float]) -> list[Place]:
    """Return the positions of these frame numbers, arranged in one row of a sheet.

    Parameters
    ----------
    path : sequence of Blend
        The frames of a path; the first has number 0.
    numbers : sequence of float
        Such as 7.35, which lies between the frames 7 and 8.

    Raises
    ------
    InputError
        No numbers, duplicate ones, or numbers outside the path.
    """
    last = len(path) - 1
    if not numbers:
        raise InputError("Name at least one frame number, such as 7.35.")
    for index, number in enumerate(numbers):
        if not 0 <= number <= last:
            raise InputError(
                "Frame number {number:g} is not on the path, which has the frames 0-{last}.", number=number, last=last
            )
        if number in numbers[:index]:
            raise InputError("Frame number {number:g} is there twice; name each number once.", number=number)
    return [_place(path, number, column) for column, number in enumerate(numbers)]


def _place(path: Sequence[Blend], number: float, column: int) -> Place:
    about = tuple(range(math.floor(number), math.ceil(number) + 1))
    share = number - about[0]
    first, second = path[about[0]].weights, path[about[-1]].weights
    weights = tuple((1.0 - share) * one + share * other for one, other in zip(first, second, strict=True))
    return Place(Blend(weights, place=(float(column), 0.0)), about, share)


def between_frames(
    inputs: MorphInputs,
    path: Sequence[Blend],
    numbers: Sequence[float],
    settings: MorphSettings,
    computation: Computation,
    control: Control = UNINTERRUPTED,
) -> Work[None]:
    """Compute the blends at some positions of a path from the frames around them.

    Frames that the cache does not hold are computed and stored first. A position at a frame gets that frame. If the
    inputs move, blends are computed and cached like those of the path, with the same motion.

    Parameters
    ----------
    inputs, settings, control
        As for :func:`.morph.morph`; the inputs must not be animated.
    path, numbers
        As for :func:`places_at`; the blends at these positions are computed.
    computation : Computation
        Needs a cache, which may hold all frames of the path, some, or none. An executor computes missing frames; blends
        between frames are always computed here.

    Yields
    ------
    Progress
        The payloads are the :class:`.morph_problem.MorphFrame` of every number, in the order of the numbers.

    Raises
    ------
    InputError, ResourceError
        Before the first frame, if the numbers, the inputs or the settings are invalid.
    """
    places = places_at(path, numbers)
    if settings.motion != "transport":
        blends = [place.blend for place in places]
        pairs = pairs_of(path)
        return (yield from morph(inputs, blends, settings, control, computation=computation, pairs=pairs))
    plated = with_plates(inputs, settings)
    store = computation.cache.of(inputs, settings)
    runs = _runs_about(places, path)
    missing = {index: run for index, run in enumerate(runs) if not store.holds(run)}
    if not missing and all(len(place.about) == 1 for place in places):
        frames = _stored_frames(store, runs, path)
        yield from _reported(0.0, len(places), (_frame_itself(place, frames) for place in places))
        return None
    workers = computation.workers
    threads = thread_count(workers)
    side_by_side = min(workers or 1, max(len(missing), len(places)))
    problem = yield from prepared_problem(plated, settings, side_by_side, threads, control)
    problem = problem.with_detail_of(plated.shapes)
    most = workers or fitting_workers(problem.lattice, plated.shapes, plated.matching.count, threads)
    yield from _complete(store, problem, missing, control, most, computation.executor)
    frames = _stored_frames(store, runs, path)
    with frame_workers(most) as threads:
        pending = [threads.submit(_frame_at, problem, place, frames, control) for place in places]
        start = _ABOUT_SHARE if missing else VOXEL_SHARE
        yield from _reported(start, len(places), (future.result() for future in pending))


def _runs_about(places: Sequence[Place], path: Sequence[Blend]) -> list[Run]:
    """Return the runs that hold the frames around some positions, without duplicates and in order."""
    frames = sorted({index for place in places for index in place.about})
    return list(dict.fromkeys(run for index in frames for run in runs_of(path, range(index, index + 1))))


def _complete(
    store: BakeCache,
    problem: MorphProblem,
    missing: dict[int, Run],
    control: Control,
    workers: int,
    executor: Executor | None,
) -> Work[None]:
    """Compute the runs that are not in the cache."""
    if not missing:
        return
    keeping = RestingProblem(replace(problem, keeps_potentials=True))
    with ExitStack() as stack:
        if executor is None:
            pending = stack.enter_context(runs_in_threads(keeping, missing, control, workers))
        else:
            pending = stack.enter_context(runs_elsewhere(keeping, missing, executor))
        for done, run in enumerate(as_solved(pending, control), start=1):
            store.save(missing[run.index], run.frames)
            fraction = VOXEL_SHARE + (_ABOUT_SHARE - VOXEL_SHARE) * done / len(missing)
            counts = {"done": done, "total": len(missing)}
            yield Progress(fraction, Sentence("Frames to start from, {done} of {total} runs", counts))


def _stored_frames(store: BakeCache, runs: Sequence[Run], path: Sequence[Blend]) -> dict[int, MorphFrame]:
    """Return the frames of some runs by their index in the path; there may be several scene frames between them."""
    places = {blend: index for index, blend in enumerate(path)}
    return {places[frame.blend]: frame for run in runs for frame in store.load(run)}


def _reported(start: float, total: int, frames: Iterator[MorphFrame]) -> Work[None]:
    for done, frame in enumerate(frames, start=1):
        message = Sentence("Blend {done} of {total}", {"done": done, "total": total})
        yield Progress(start + (1.0 - start) * done / total, message, frame)


def _frame_itself(place: Place, frames: dict[int, MorphFrame]) -> MorphFrame:
    return replace(frames[place.about[0]], blend=place.blend)


def _frame_at(problem: MorphProblem, place: Place, frames: dict[int, MorphFrame], control: Control) -> MorphFrame:
    """Return the frame at a position, or a blend that starts from its neighbors."""
    if len(place.about) == 1:
        return _frame_itself(place, frames)
    known = [frames[index] for index in place.about if _usable(frames[index], problem)]
    found = _started(problem, place, known, control) if _agree(known) else None
    if found is None:
        (found,) = solve_blends(problem, [place.blend], control)
    return replace(found, record=found.record | {"between": place.about})


def _usable(frame: MorphFrame, problem: MorphProblem) -> bool:
    """Whether a frame has potentials that fit this problem; unblended inputs have none."""
    lattice, least = problem.lattice, problem.settings.sigma
    return len(frame.potentials) == len(problem.transport.parts) and all(
        part.suit(lattice.shape, frame.blend.weights) and least <= part.sigma <= max(lattice.shape)
        for part in frame.potentials
    )


def _agree(known: Sequence[MorphFrame]) -> bool:
    """Whether there are frames to start from, all solved with the same blur."""
    return len({tuple(part.sigma for part in frame.potentials) for frame in known}) == 1


def _started(problem: MorphProblem, place: Place, known: Sequence[MorphFrame], control: Control) -> MorphFrame | None:
    """Solve from the potentials of one or two neighbors; return None if that does not converge quickly."""
    solved, sigmas = [], [part.sigma for part in known[0].potentials]
    volumes = problem.transport.blend_volumes(place.blend)
    limits = problem.transport.entropy_limits(volumes)
    for index, (part, limit) in enumerate(zip(problem.transport.parts, limits, strict=True)):
        starts = [frame.potentials[index].barycenter(frame.blend.weights) for frame in known]
        inputs = _inputs(part, problem, sigmas[index])
        try:
            solved.append(_solve_from(starts, place, inputs, limit, problem.settings, control))
        except KernelTooNarrowError:
            return None
        if not solved[-1].converged:
            return None
    blend = SolvedBlend(place.blend, tuple(solved), tuple(sigmas), volumes)
    return surfaced_frame(problem, blend, control=control)


def _inputs(part: MorphPart, problem: MorphProblem, sigma: float) -> Inputs:
    return part.inputs if sigma == part.inputs.domain.sigma else part.inputs.on(problem.lattice.grid(sigma))


def _solve_from(
    starts: Sequence[Barycenter],
    place: Place,
    inputs: Inputs,
    limit: Literal["max"] | float | None,
    settings: MorphSettings,
    control: Control,
) -> Barycenter:
    """Solve one part from both neighbors, or from one next to a shape, which has no potentials."""
    options = {
        "sharpness": settings.sharpness_at(place.blend.weights),
        "entropy_limit": limit,
        "reach": settings.reach,
        "tolerance": settings.stopping_error,
        "debias_tolerance": settings.debias_stopping_error_at(place.blend.weights),
        # As in a bake, an automatic blur is widened instead of continuing in logarithms.
        "numerics": "scaling" if settings.blur is None else "automatic",
        "control": control,
    }
    if len(starts) == 2:
        rounds = min(_MOST_ROUNDS, settings.max_iterations)
        return barycenter_between(*starts, place.share, inputs, max_iterations=rounds, **options)
    return barycenter_from_neighbor(
        starts[0], place.blend.weights, inputs, max_iterations=settings.max_iterations, **options
    )
