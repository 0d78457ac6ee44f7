# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guided motions of tubes, such as ropes, snakes and springs: they move as their center lines bend."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotation_fields import rotation_matrices, rotation_vectors
from ...geometry.recognition.center_lines import sliced_tube
from ...progress import Control
from ..motions.coherence import way_at
from ..motions.motion import MovedShape
from ..motions.motion_choice import MotionChoice
from ..motions.motion_request import MotionRequest
from .tube import Tube, matched_tube

# Tubes bend if that is by at least this angle in total, in radians. Surfaces of others are mapped as well, with what
# they have besides, such as fins.
_LEAST_BEND = np.pi
# Shares of the second tube of a pair with which blends are tried.
_SAMPLES = np.linspace(0.0, 1.0, 9)


@dataclass(frozen=True)
class TubeMotion:
    """Moves tubes by how their center lines bend; a :class:`.motion.Motion`.

    Between neighboring pieces of its center line, a blend turns by the weighted mean of the rotation vectors with which
    the tubes turn, in frames that do not twist. Its length is the weighted mean, and so is its volume everywhere. The
    middle of the line is rotated by the weighted mean, and then all of it so that the axis of a spring stays upright.

    Attributes
    ----------
    tubes : tuple of Tube
        The shapes.
    way : float
        Fraction of the way towards the others that shapes move, from 0 to 1.
    directed : bool
        Whether blends are rotated so that their courses have the mean direction of those of the tubes.
    """

    tubes: tuple[Tube, ...]
    way: float
    directed: bool

    @classmethod
    def of(cls, tubes: Sequence[Tube], pairs: Sequence[tuple[int, int]], way: float) -> TubeMotion:
        """Return the motion of tubes, directed unless a blend of a pair leads nowhere."""
        motion = cls(tuple(tubes), way, False)
        unit = np.eye(len(tubes))
        blends = [(1.0 - share) * unit[one] + share * unit[other] for one, other in pairs for share in _SAMPLES]
        return replace(motion, directed=all(motion._undirected(blend).leads_somewhere for blend in blends))

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        shares = np.asarray(weights, np.float64) / sum(weights)
        moved: list[MovedShape | None] = []
        for index, tube in enumerate(self.tubes):
            if shares[index] == 0.0:
                moved.append(None)
                continue
            own = self.way * shares
            own[index] += 1.0 - self.way
            moved.append(MovedShape(tube.divided.mesh, tube.followed(self._blended(own)), tube.divided.parents))
        return moved

    def _blended(self, shares: NDArray[np.float64]) -> Tube:
        """Return the mean of the tubes, with the surface of the first one."""
        found = self._undirected(shares)
        return found.pointing(shares @ np.stack([tube.course for tube in self.tubes])) if self.directed else found

    def _undirected(self, shares: NDArray[np.float64]) -> Tube:
        def mean(values: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
            return np.tensordot(shares, np.stack(values), axes=1)

        first = self.tubes[0]
        turns, center = mean([tube.turns for tube in self.tubes]), mean([tube.center for tube in self.tubes])
        length = float(mean([np.array(tube.length) for tube in self.tubes]))
        radii = np.sqrt(mean([np.square(tube.radii) * tube.length for tube in self.tubes]) / length)
        middles = rotation_vectors(np.stack([tube.middle @ first.middle.T for tube in self.tubes]))
        middle = rotation_matrices((shares @ middles)[None])[0] @ first.middle
        return replace(first, turns=turns, middle=middle, length=length, radii=radii, center=center)


def tube_motion(request: MotionRequest, control: Control) -> MotionChoice | None:
    """Return the guided motion of tubes.

    Returns
    -------
    MotionChoice or None
        None if a shape is no tube, or if their center lines are alike.
    """
    tubes: list[Tube] = []
    for shape in request.shapes:
        sliced = sliced_tube(shape, control)
        if sliced is None:
            return None
        tubes.append(matched_tube(tubes[0], Tube.of(sliced)) if tubes else Tube.of(sliced))
    if all(tubes[one].bend_to(tubes[other]) < _LEAST_BEND for one, other in request.pairs):
        return None
    return MotionChoice("guided", "TUBES", TubeMotion.of(tubes, request.pairs, way_at(request.coherence)))
