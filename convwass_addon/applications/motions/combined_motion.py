# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A guided motion, and warps that remove the difference that remains between two shapes halfway."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.surface_rotations import surface_rotations
from ...progress import Control, Work, as_part
from .guided_motion import GuidedMotion
from .motion import MovedShape, weights_between
from .motion_request import MotionRequest
from .warp_motion import WarpEffort, WarpMotion, warp_motion


@dataclass(frozen=True)
class CombinedMotion:
    """A guided motion, and a warp between the halfway states of every pair; a :class:`.motion.Motion`.

    With weights w, s = w_j / (w_i + w_j), the displacement d_ij(s) of shape i by the warp, and the rotations R_ij of
    its surface from halfway to its state in the blend, the vertices are displaced by the sum of (w_i + w_j) f(s) R_ij
    d_ij(s) over the other shapes j. The warp was made for the halfway states, so f decreases from 1 halfway to
    `arrival` where the shape has become the other.

    Attributes
    ----------
    guided : GuidedMotion
        The motion of the shapes before the warps.
    warps : mapping of (int, int) to WarpMotion
        The warp between the two shapes of a pair, smaller index first.
    arrival : float
        How much of the warp is applied to a shape that has become the other, from 0 to 1.
    """

    guided: GuidedMotion
    warps: Mapping[tuple[int, int], WarpMotion]
    arrival: float

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        shapes = self.guided.moved(weights)
        active = [index for index, weight in enumerate(weights) if weight > 0]
        added: dict[int, NDArray[np.float64]] = {index: np.zeros_like(shapes[index].vertices) for index in active}
        for pair in combinations(active, 2):
            total = weights[pair[0]] + weights[pair[1]]
            warp = self.warps[pair]
            warped = warp.moved([weights[index] / total for index in pair])
            for place, index in enumerate(pair):
                # The warp may have divided more triangles; vertices of the shape come first.
                count = len(added[index])
                half_way = warp.rests[place].mesh.vertices[:count]
                turns = surface_rotations(half_way, shapes[index].vertices, shapes[index].rest.faces)
                displaced = warped[place].vertices[:count] - half_way
                share = total * self._applied(1.0 - weights[index] / total)
                added[index] += share * np.einsum("nij,nj->ni", turns, displaced)
        return [
            None if shape is None else MovedShape(shape.rest, shape.vertices + added[index], shape.parents)
            for index, shape in enumerate(shapes)
        ]

    def _applied(self, progress: float) -> float:
        """Return how much of its warp is applied to a shape on its way to another, from 0 to 1."""
        if progress <= 0.5:
            return 1.0
        return self.arrival + (1.0 - self.arrival) * np.sin(np.pi * progress) ** 2

    def with_coherence(self, coherence: float) -> CombinedMotion:
        """Return the same motion with another coherence, without recomputation.

        The warps between the halfway states do not change.

        Raises
        ------
        InputError
            The coherence is not between 0 and 1.
        """
        warps = {pair: warp.with_coherence(coherence) for pair, warp in self.warps.items()}
        return CombinedMotion(self.guided.with_coherence(coherence), warps, self.arrival)


def combined_motion(
    guided: GuidedMotion, request: MotionRequest, effort: WarpEffort, arrival: float, control: Control
) -> Work[CombinedMotion]:
    """Compute the warps that complete a guided motion.

    Parameters
    ----------
    guided : GuidedMotion
        The motion of the shapes before the warps, prepared for the pairs of the request.
    request : MotionRequest
        The names of the shapes for messages, the pairs, and the coherence.
    effort : WarpEffort
        The effort of the warps.
    arrival : float
        See :class:`CombinedMotion`.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The coherence is not between 0 and 1.
    """
    warps, names, pairs = {}, request.names, request.pairs
    for number, pair in enumerate(pairs):
        moved = guided.moved(weights_between(len(names), pair, 0.5))
        work = warp_motion(
            [moved[index].mesh for index in pair],
            [names[index] for index in pair],
            [(0, 1)],
            request.coherence,
            control,
            effort,
        )
        warps[pair] = yield from as_part(work, number, len(pairs))
    return CombinedMotion(guided, warps, arrival)
