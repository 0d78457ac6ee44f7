# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A live morph: blends of two to four shapes at any weights, while the lattice they are mixed from is being filled.

One thread points at weights and takes the shape there; another one works. Until the lattice around the hand is there,
it solves the blend that is pointed at. It fills the lattice from coarse to fine and nearest to the hand first, then
looks for the motion of the shapes, and fills a lattice of moved shapes. Where the hand rests, it solves the blend in
full.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...errors import Cancelled, InputError, ResourceError
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.orientation import orient_outward
from ...progress import Control, Progress, Result, Work, within
from ...sentence import Sentence
from ..morphs.extraction import estimated_level_density
from ..morphs.layouts import Blend, pairs_of
from ..morphs.morph_problem import MorphProblem
from ..morphs.morph_settings import MorphSettings
from ..morphs.moving_problem import MovingProblem
from ..morphs.plated_shapes import with_plates
from ..morphs.preparing import sketchable_problem, with_connectivity
from ..morphs.volumes import Lattice
from ..motions.motion_choice import MotionChoice
from ..motions.motion_memory import MotionMemory
from ..motions.motion_request import MotionRequest
from .field_memory import FieldMemory
from .field_sources import FieldSource, MovingSource, StandInSource, TransportSource, box_of_shapes
from .filling_lattice import FAR, LEVELS, FillingLattice, Mixture, count_of_nodes, fitting_levels
from .full_blends import FullBlend, FullSolver
from .layered_fields import LEAST_REST, LayeredFields
from .level_fields import colors_at, mixed
from .live_settings import LiveSettings
from .live_shapes import LiveShape, LiveShapes
from .shape_colors import ShapeColors
from .weight_layouts import checked_weights, layout_of

FADE = 0.4
"""Seconds within which a finer level of the lattice takes over."""

# On finer lattices blends are solved on one of so many cells until the lattice is there.
_FINE, _STAND_IN = 56, 48
# Smaller weights are zero: a frame of a long bake has no smaller ones.
_LEAST_WEIGHT = 1.0 / 500.0
# On pads 16 steps are accurate to 0.03 cells (docs/performance, "Live blends"), and refining them takes up to four
# times the memory.
_FAR_ON_PADS = np.inf
# Blends at the hand are solved to this tolerance, twice the usual one, until the lattice is there.
_HAND_TOLERANCE = 2e-2
# Plain transport is filled to this level while the motion is not known.
_WITHOUT_MOTION = LEVELS[:2]
# Shares of the progress: until the plain lattice is filled, and until the motion is found.
_PLAIN_SHARE, _MOTION_SHARE = 0.3, 0.5


class LiveBlends:
    """Blends at any weights, and the work that makes them better.

    Parameters
    ----------
    shapes : LiveShapes
        What to blend.
    settings : MorphSettings
        How; the resolution is that of `live`.
    live : LiveSettings
        Resolution and memory.
    clock : callable
        Seconds that pass while finer levels take over.
    motions : MotionMemory, optional
        Motions that are in it are not searched for again; others are found when plain blends are there.

    Raises
    ------
    InputError, ResourceError
        Another number of shapes than two to four, or settings that cannot work.
    """

    def __init__(
        self,
        shapes: LiveShapes,
        settings: MorphSettings,
        live: LiveSettings,
        clock: Callable[[], float] = time.monotonic,
        motions: MotionMemory | None = None,
    ) -> None:
        count = len(shapes.inputs.shapes)
        self.layout = layout_of(count)
        self.notices: list[Sentence] = []
        self._given, self._live, self._clock = shapes, live, clock
        self._motions = motions or MotionMemory()
        self._settings = replace(settings, resolution=live.live_resolution, carry=bool(shapes.appearances))
        # What cannot work is refused at once; sheets are found by the thread that works.
        self._lay_out(shapes)
        self._fields = LayeredFields()
        self._problem: MorphProblem | None = None
        self._full: FullSolver | None = None
        self._moving: MovingProblem | None = None
        self._colors: tuple[ShapeColors, ...] = ()
        self._nodes: FieldSource | None = None
        self._at_hand: FieldSource | None = None
        self._hand = tuple(np.full(count, 1.0 / count).tolist())
        self._motion_is_known = settings.motion == "transport" or settings.coherence == 0.0
        self._rests = self._solved_hand_last = False
        self._rest_control: Control | None = None
        self._solved: FullBlend | None = None
        self._last_shape: LiveShape | None = None
        self._last_made_of: tuple[object, ...] = ()
        self._fraction = 0.0
        self.version = 0

    # For the thread that shows blends.

    @property
    def hand(self) -> tuple[float, ...]:
        """The weights that are pointed at, (k,), of sum 1."""
        return self._hand

    def point(self, weights: Sequence[float]) -> None:
        """Point at other weights, (k,): negative ones count as zero, and they need not sum to 1.

        Raises
        ------
        InputError
            Another number of weights than shapes, or weights that are no numbers or all zero.
        """
        values = checked_weights(weights, len(self._hand))
        values = np.where(values < _LEAST_WEIGHT, 0.0, values)
        hand = tuple((values / values.sum()).tolist())
        if hand == self._hand:
            return
        self._hand, self._rests = hand, False
        if self._rest_control is not None:
            self._rest_control.cancel()

    def rest(self) -> None:
        """Ask for a full solve of the blend that is pointed at, until another one is."""
        self._rests = True

    @property
    def has_work(self) -> bool:
        """Whether :meth:`work` would find something to do."""
        return self._nodes is None or self._next_task() is not None

    @property
    def coverage(self) -> float:
        """Share of the blend that is pointed at that comes from a lattice, 0 to 1."""
        return self._fields.coverage(self._hand, self._clock())

    def settle(self) -> None:
        """Forget lattices that newer ones have taken over from."""
        self._fields.settle(self._clock())

    def shown(self) -> LiveShape | None:
        """Return the blend that is pointed at as well as it is known by now; None before the first one is there.

        While that is the same as at the last call, so is the object that is returned.
        """
        hand, solved = self._hand, self._solved
        if solved is not None and solved.weights == hand:
            return self._remembered((solved,), solved.shown)
        found = self._fields.mixture(hand, self._clock())
        if not found.fields:
            return None
        return self._remembered((hand, *found.fields, *found.shares), lambda center: self._mixed_shape(found, center))

    def _remembered(self, made_of: tuple[object, ...], make: Callable[[NDArray[np.float64]], LiveShape]) -> LiveShape:
        """Make a shape at its center, unless the last one was made of the same."""
        if len(made_of) != len(self._last_made_of) or any(
            own is not other and own != other for own, other in zip(made_of, self._last_made_of, strict=True)
        ):
            self._last_shape, self._last_made_of = make(np.asarray(self._hand) @ self._lattice.centers), made_of
        return self._last_shape

    def _mixed_shape(self, found: Mixture, center: NDArray[np.float64]) -> LiveShape:
        mesh = mixed(found.fields, np.array(found.shares) / sum(found.shares)).surface()
        colors = colors_at(found.fields, found.shares, mesh.vertices)
        vertices = mesh.vertices * self._lattice.spacing + self._lattice.origin
        return LiveShape(TriangleMesh(vertices, mesh.faces), center, colors=colors)

    @property
    def bytes(self) -> int:
        """Memory that the fields take."""
        return self._fields.bytes

    @property
    def filled(self) -> int:
        """Blends in the lattice."""
        return self._fields.filled

    # For the thread that works.

    def work(self, control: Control) -> Work[None]:
        """Do all there is to do, the most urgent first; call again when :attr:`has_work`.

        Raises
        ------
        InputError, ResourceError
            Shapes that cannot be blended.
        """
        yield from self._prepared(control)
        while (task := self._next_task()) is not None:
            control.check()
            yield from task(control)

    def _next_task(self) -> Callable[[Control], Work[None]] | None:
        urgent = self._urgent_task()
        if urgent is not None:
            return urgent
        if self._fields.newest.next_wanted(self._hand) is not None:
            return self._fill_node
        return None if self._motion_is_known else self._find_motion

    def _urgent_task(self) -> Callable[[Control], Work[None]] | None:
        """Return what the user is waiting for."""
        hand, base, solved = self._hand, self._fields.oldest, self._fields.hand
        if self._at_hand is None:
            return None
        if base is None or base.mixture(hand, self._clock()).rest >= LEAST_REST:
            known = solved is not None and solved.weights == hand
            is_base_there = base is not None and base.is_whole(LEVELS[0])
            # Between two blends at the hand, one for the lattice: the hand may never stand still.
            waits = base is not None and self._solved_hand_last
            return None if known or is_base_there or waits else self._solve_hand
        waits = self._rests and self._motion_is_known and self._fields.newest.is_whole(LEVELS[0])
        known = self._solved is not None and self._solved.weights == hand
        return self._solve_rest if waits and not known else None

    def _prepared(self, control: Control) -> Work[None]:
        """Find sheets, and voxelize the shapes; of fine lattices a coarser one first, for the first blend."""
        if self._nodes is not None:
            return
        self._lay_out(replace(self._given, inputs=with_plates(self._given.inputs, self._settings)))
        self._colors = tuple(ShapeColors.of(appearance) for appearance in self._shapes.appearances)
        if self._settings.resolution > _FINE:
            coarse = replace(quick_settings(self._settings), resolution=_STAND_IN, blur=None)
            problem = yield from self._voxelized(coarse, control)
            self._at_hand = StandInSource(problem, self._lattice, self._box, self._colors)
            yield from self._solve_hand(control)
        self._problem = yield from self._attended(self._voxelized(self._settings, control), control)
        if self._at_hand is None:
            quick = replace(self._problem.transport, settings=quick_settings(self._settings))
            problem = replace(self._problem, transport=quick)
            self._at_hand = TransportSource(problem, self._box, control, estimated_level_density, self._colors)
        self._nodes = TransportSource(self._problem, self._box, control, colors=self._colors)
        levels = self._fitting()
        if not self._motion_is_known:
            levels = tuple(steps for steps in levels if steps in _WITHOUT_MOTION)
        self._fields.cover(self._empty_lattice(levels))

    def _lay_out(self, shapes: LiveShapes) -> None:
        """Lay out the grid around shapes."""
        meshes = shapes.inputs.shapes
        self._shapes = shapes
        self._lattice = Lattice.around(meshes, self._settings.resolution, self._settings.sigma)
        self._box = box_of_shapes(meshes, self._lattice)
        self._memory = FieldMemory(shapes, self._lattice, self.layout, self._live.live_memory)

    def _empty_lattice(self, levels: Sequence[int]) -> FillingLattice:
        far = FAR if self.layout.count == 2 else _FAR_ON_PADS
        return FillingLattice(self.layout, levels, self._memory.most(self._fields), FADE, far)

    def _voxelized(self, settings: MorphSettings, control: Control) -> Work[MorphProblem]:
        inputs = self._shapes.inputs
        work = sketchable_problem(inputs, settings, 1, len(inputs.shapes), control)
        return (yield from within(work, 0.0, 0.0))

    def _fitting(self) -> tuple[int, ...]:
        """Return the levels of the lattice that there is memory for, and say so where these are not all."""
        levels = fitting_levels(self.layout, self._memory.most(self._fields))
        if levels != LEVELS:
            needed = count_of_nodes(self.layout, LEVELS) * self._memory.field_bytes(self._fields) / 1e6
            notice = Sentence(
                "A lattice of {finest} steps needs {needed:.0f} MB; there is memory for {levels} steps",
                {"finest": LEVELS[-1], "needed": needed, "levels": levels[-1]},
            )
            # The estimate becomes more accurate with the first blends.
            self.notices[:] = [*(own for own in self.notices if own.template != notice.template), notice]
        return levels

    def _report(self, message: Sentence, fraction: float = 0.0) -> Progress[None]:
        self._fraction = max(self._fraction, fraction)
        return Progress(self._fraction, message)

    def _solve_hand(self, control: Control) -> Work[None]:
        """Solve the blend that is pointed at."""
        hand = self._hand
        self._fields.set_hand(hand, self._at_hand.field(hand, control))
        self._solved_hand_last = True
        self.version += 1
        yield self._report(Sentence("Blending"))

    def _fill_node(self, control: Control) -> Work[None]:
        """Solve the blend at the next node of the newest lattice."""
        layer = self._fields.newest
        wanted = layer.next_wanted(self._hand)
        self._solved_hand_last = False
        layer.add(wanted.node, self._nodes.field(wanted.weights, control), self._clock())
        self.version += 1
        yield self._report(Sentence("{count} blends", {"count": self.filled}), self._share_of(layer))

    def _share_of(self, layer: FillingLattice) -> float:
        """Return the share of the work that is done from how far a lattice is filled."""
        if self._moving is not None:
            return _MOTION_SHARE + (1.0 - _MOTION_SHARE) * layer.fraction
        return layer.fraction * (1.0 if self._motion_is_known else _PLAIN_SHARE)

    def _solve_rest(self, control: Control) -> Work[None]:
        """Solve the blend that is pointed at as a bake does, unless the hand moves on."""
        yield self._report(Sentence("Solving the blend in full"))
        blend = Blend(self._hand)
        self._rest_control = Control(control)
        try:
            if blend.weights != self._hand:
                return
            if self._full is None:
                self._full = FullSolver.at_rest(self._shapes, self._problem)
            solved = self._full.solve(blend, self._rest_control)
        except Cancelled:
            control.check()
            return
        finally:
            self._rest_control = None
        self._solved = solved
        self.version += 1
        yield self._report(Sentence("Solved"))

    def _find_motion(self, control: Control) -> Work[None]:
        """Find how the shapes move, and begin a lattice of moved shapes; or go on with this one."""
        blends = [Blend(self.layout.weights(node, LEVELS[0])) for node in self.layout.nodes(LEVELS[0])]
        try:
            choice = yield from self._attended(self._choosing(blends, control), control)
        except (InputError, ResourceError) as error:
            self.notices.append(Sentence("Transported without a motion: {reason}", {"reason": error.sentence}))
            choice = MotionChoice("transport", "FAILED")
        self._motion_is_known = True
        if choice.motion is None:
            self._fields.newest.extend(self._fitting(), self._clock())
            return
        still = with_connectivity(replace(self._problem, motion=choice.record()), 1)
        names, matching = self._shapes.inputs.names, self._shapes.inputs.matching
        self._begin_motion(MovingProblem.of(still, choice.motion, blends, names, matching, control))

    def _choosing(self, blends: Sequence[Blend], control: Control) -> Work[MotionChoice]:
        inputs, settings = self._shapes.inputs, self._settings
        outward = [orient_outward(mesh) for mesh in inputs.shapes]
        pairs = pairs_of(blends)
        request = MotionRequest(outward, inputs.names, pairs, settings.motion, settings.coherence, inputs.guides)
        return (yield from within(self._motions.chosen(request, control), _PLAIN_SHARE, _MOTION_SHARE))

    def _begin_motion(self, moving: MovingProblem) -> None:
        """Lay a lattice of moved shapes over the one of plain transport."""
        source = MovingSource(moving, self._colors)
        self._fields.cover(self._empty_lattice(self._fitting()))
        self._nodes, self._moving, self._full = source, moving, FullSolver(self._shapes, moving)

    def _attended(self, work: Work[Result], control: Control) -> Work[Result]:
        """Do some work, and between two of its reports one thing that the user is waiting for."""
        while True:
            try:
                report = next(work)
            except StopIteration as done:
                return done.value
            yield self._report(report.message, report.fraction)
            task = self._urgent_task()
            if task is not None:
                yield from task(control)


def quick_settings(settings: MorphSettings) -> MorphSettings:
    """Return the settings for blends that are looked at until better ones are there."""
    return replace(settings, tolerance=max(settings.stopping_error, _HAND_TOLERANCE))
