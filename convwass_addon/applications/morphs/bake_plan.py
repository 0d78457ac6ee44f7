# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Start a bake: prepare the shapes, choose a motion, show previews, and start computing the runs."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import AbstractContextManager, ExitStack
from dataclasses import dataclass, replace

import numpy as np

from ...geometry.meshes.welding import ClosedSeams
from ...geometry.solids.orientation import orient_outward
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..memory import check_memory, fitting_beside
from ..motions.guides import check_guides
from ..motions.motion_choice import MotionChoice
from ..motions.motion_memory import MotionMemory
from ..motions.motion_request import MotionRequest
from ..motions.posed_motion import PosedMotion
from ..workers import thread_count
from .blend_problem import BlendProblem
from .blend_store import BlendStore
from .computation import Computation
from .first_preview import first_preview
from .following_problem import FollowingProblem
from .kept_blends import KeptBlends
from .layouts import Blend
from .morph_inputs import MorphInputs
from .morph_problem import MorphFrame, MorphProblem
from .morph_settings import MorphSettings
from .moving_problem import MovingProblem
from .preparing import VOXEL_SHARE, sketchable_problem, with_connectivity
from .resting_problem import RestingProblem
from .runs import (
    RUN_LENGTH,
    Pending,
    Run,
    SketchedRuns,
    as_sketched,
    runs_elsewhere,
    runs_in_threads,
    sketched_runs_in_threads,
)
from .solving_again import Asked, again_elsewhere, again_in_threads
from .volumes import Lattice, fitting_workers

# Fractions of the progress bar for previews, if there are any, and for the motion.
_PREVIEW_SHARE, _MOTION_SHARE = 0.12, 0.3
# Solved blends are kept in at most this many bytes, and in half of the free memory. 24 blends of a horse and a bird
# take 56 MB at 100 cells.
_MOST_KEPT = 1 << 29
# Moved blends are kept with at most this many bytes of grids, and in a quarter of the free memory. 24 blends of a horse
# and a cow take 230 MB at 100 cells.
_MOST_KEPT_MOVED = 1 << 28


@dataclass(frozen=True)
class MorphPreview:
    """A preview of a frame that is not finished yet.

    Attributes
    ----------
    frame : MorphFrame
        The blend with a coarse mesh.
    """

    frame: MorphFrame


@dataclass(frozen=True)
class BegunRuns:
    """Runs that are being solved.

    Attributes
    ----------
    pending : dict
        The index of the run for each future.
    fraction : float
        Fraction of the work that is done when they have been started.
    problem : BlendProblem
        The problem that the runs solve, possibly without the connectivity of the shapes.
    """

    pending: Pending
    fraction: float
    problem: BlendProblem


@dataclass(frozen=True)
class BakePlan:
    """What is to be computed, and how; attributes not listed here are described at :func:`.morph.morph`.

    Attributes
    ----------
    runs : dict
        The runs that have to be computed.
    keeps_potentials : bool
        Whether frames keep potentials, from which blends next to them can be solved.
    """

    inputs: MorphInputs
    blends: Sequence[Blend]
    pairs: Sequence[tuple[int, int]]
    settings: MorphSettings
    runs: dict[int, Run]
    keeps_potentials: bool
    computation: Computation

    def begun(self, stack: ExitStack, control: Control) -> Work[BegunRuns]:
        """Start all runs; closing the stack stops what computes them."""
        if self._shows and self.inputs.animation is None:
            yield from self._first_preview(control)
        problem, fraction = (yield from self.prepared(control)), self._chosen_at
        # The runs of inputs at rest go on from their sketches, but previews of moving inputs are of no use to runs.
        if isinstance(problem, RestingProblem):
            if self._shows and problem.still.transport.sketch_depth:
                return (yield from self._sketched(problem, stack, control))
            threads = min(self._fitting(problem.lattice), len(self.inputs.shapes))
            problem = replace(problem, still=with_connectivity(problem.still, threads, control))
        elif self._shows:
            yield from self._moved_previews(problem, control)
            fraction += _PREVIEW_SHARE
        if self.computation.executor is None:
            runs = runs_in_threads(problem, self.runs, control, self._fitting(problem.lattice))
        else:
            runs = runs_elsewhere(problem, self.runs, self.computation.executor)
        return BegunRuns(stack.enter_context(runs), fraction, problem)

    def prepared(self, control: Control) -> Work[RestingProblem | MovingProblem]:
        """Return the problem shared by all blends; without the connectivity of the shapes if they do not move."""
        side_by_side = min(self.computation.workers or 1, len(self.runs))
        problem = yield from sketchable_problem(self.inputs, self.settings, side_by_side, self._threads, control)
        if self.inputs.animation is not None and not self.inputs.animation.keeps_topology:
            return self._following(problem, MotionChoice("transport", "TOPOLOGY"), control)
        choice = yield from self._motion(control)
        if self.inputs.animation is not None:
            return self._following(problem, choice, control)
        problem = replace(problem, keeps_potentials=self.keeps_potentials, motion=choice.record())
        if choice.motion is None:
            return self._resting(problem.with_detail_of(self.inputs.shapes))
        still = with_connectivity(problem, min(self._fitting(problem.lattice), len(self.inputs.shapes)), control)
        blends, names, matching = self.blends, self.inputs.names, self.inputs.matching
        return self._fitted(MovingProblem.of(still, choice.motion, blends, names, matching, control, self.pairs))

    def _following(self, problem: MorphProblem, choice: MotionChoice, control: Control) -> FollowingProblem:
        """Return the problem shared by all blends of animated inputs."""
        outward = [orient_outward(shape) for shape in self.inputs.shapes]
        animation, motion = self.inputs.animation, None
        if animation.keeps_topology:
            animation = animation.facing([shape.faces for shape in outward])
        if choice.motion is not None:
            coherence = self.settings.coherence
            motion = PosedMotion.of(choice.motion, outward, self.inputs.names, self.pairs, coherence, control)
        recorded = replace(problem, motion=choice.record())
        still = with_connectivity(recorded, min(self._threads, len(self.inputs.shapes)), control)
        names, matching = self.inputs.names, self.inputs.matching
        return self._fitted(FollowingProblem.around(still, motion, animation, outward, names, matching))

    def again(
        self, problem: BlendProblem, runs: dict[int, Run], asked: Asked, control: Control
    ) -> AbstractContextManager[Pending]:
        """Compute blends of some runs again; see :mod:`.solving_again`."""
        if self.computation.executor is None:
            return again_in_threads(problem, runs, asked, control, self._fitting(problem.lattice))
        return again_elsewhere(problem, runs, asked, self.computation.executor)

    @property
    def _shows(self) -> bool:
        """Whether previews are shown."""
        return self.computation.previews and self.computation.executor is None

    @property
    def _threads(self) -> int:
        return thread_count(self.computation.workers)

    @property
    def _chosen_at(self) -> float:
        """Fraction of the work that is done when the motion has been chosen."""
        return VOXEL_SHARE + (0.0 if self.settings.motion == "transport" else _MOTION_SHARE)

    def _fitting(self, lattice: Lattice) -> int:
        """Return how many threads can solve at the same time."""
        workers = self.computation.workers
        return workers or fitting_workers(lattice, self.inputs.shapes, self.inputs.matching.count, self._threads)

    def _resting(self, problem: MorphProblem) -> RestingProblem:
        """Let inputs at rest keep blends that are solved here, in half of the memory that the bake leaves free."""
        if self.computation.executor is not None:
            return RestingProblem(problem)
        return RestingProblem(
            problem, KeptBlends(self._room(problem.lattice, 2, _MOST_KEPT), finest=self.keeps_potentials)
        )

    def _fitted(self, moving: MovingProblem) -> MovingProblem:
        """Check the memory that moving inputs need, and let them keep blends in a quarter of what is left."""
        check_memory(moving.lattice.memory(self.inputs.shapes, 1, self.inputs.matching.count), self.settings.resolution)
        return replace(moving, kept=BlendStore(self._room(moving.lattice, 4, _MOST_KEPT_MOVED)))

    def _room(self, lattice: Lattice, parts: int, most: int) -> int:
        """Return one of so many parts of the memory that the bake leaves free, in bytes; at most `most`."""
        needed = lattice.memory(self.inputs.shapes, self._fitting(lattice), self.inputs.matching.count)
        return fitting_beside(needed, parts, most)

    def _motion(self, control: Control) -> Work[MotionChoice]:
        """Choose how the shapes move."""
        kind, coherence = self.settings.motion, self.settings.coherence
        moving, guides = self.inputs.shapes, self.inputs.guides
        # With "transport" the shapes are oriented when they are voxelized.
        if kind != "transport":
            check_guides(guides, moving, self.inputs.names)
            closed = [ClosedSeams.of(shape) for shape in moving]
            guides = [{shape: int(closed[shape].merged[vertex]) for shape, vertex in guide.items()} for guide in guides]
            moving = [orient_outward(own.mesh) for own in closed]
        request = MotionRequest(moving, self.inputs.names, self.pairs, kind, coherence, guides)
        memory = self.computation.motions or MotionMemory()
        return (yield from within(memory.chosen(request, control), VOXEL_SHARE, self._chosen_at))

    def _sketched(self, problem: RestingProblem, stack: ExitStack, control: Control) -> Work[BegunRuns]:
        """Start runs with their coarse levels, and show these."""
        most = self._fitting(problem.lattice)
        needed = problem.lattice.memory(self.inputs.shapes, most, self.inputs.matching.count)
        chosen = self._previewed(problem.still.transport.sketch_bytes, needed)
        sketched = stack.enter_context(sketched_runs_in_threads(problem, self.runs, chosen, control, most))
        yield from self._previews(sketched, control)
        return BegunRuns(sketched.frames, self._chosen_at + _PREVIEW_SHARE, problem)

    def _first_preview(self, control: Control) -> Work[None]:
        """Show one blend first, more coarsely than the other previews."""
        blend = self._seen_blend()
        seen = None
        if blend is not None:
            seen = first_preview(self.inputs, blend, self.settings, control)
        if seen is not None:
            yield Progress(0.0, Sentence("First preview"), MorphPreview(seen))

    def _seen_blend(self) -> Blend | None:
        """Return the blend nearest to the displayed one that is not an unblended shape, or None."""
        blends = {
            index * RUN_LENGTH + place: blend for index, run in self.runs.items() for place, blend in enumerate(run)
        }
        mixed = [index for index, blend in blends.items() if blend.source is None]
        seen = self.computation.looked_at
        return blends[min(mixed, key=lambda index: abs(index - seen))] if mixed else None

    def _previewed(self, bytes_each: int, needed: int) -> list[int]:
        """Choose the runs to preview, nearest to the displayed blend first, as many as fit in memory."""
        seen = self.computation.looked_at // RUN_LENGTH
        nearest = sorted(self.runs, key=lambda index: abs(index - seen))
        fitting = fitting_beside(needed, bytes_each, sum(map(len, self.runs.values())))
        return nearest[
            : np.searchsorted(np.cumsum([len(self.runs[index]) for index in nearest]), fitting, side="right")
        ]

    def _previews(self, runs: SketchedRuns, control: Control) -> Work[None]:
        total = len(runs.sketches)
        for done, frame in enumerate(as_sketched(runs, control), start=1):
            yield self._preview(done, total, frame)

    def _moved_previews(self, problem: MovingProblem, control: Control) -> Work[None]:
        """Show the moved inputs in place of unfinished blends."""
        blends = [blend for run in self.runs.values() for blend in run if blend.source is None]
        for done, blend in enumerate(blends, start=1):
            control.check()
            yield self._preview(done, len(blends), problem.preview(blend))

    def _preview(self, done: int, total: int, frame: MorphFrame) -> Progress[MorphPreview]:
        message = Sentence("Preview {done} of {total}", {"done": done, "total": total})
        return Progress(self._chosen_at + _PREVIEW_SHARE * done / total, message, MorphPreview(frame))
