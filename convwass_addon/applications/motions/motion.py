# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The interface of motions: positions of all inputs in a blend with given weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...one_line import one_line

# Weight that a shape keeps when it is moved onto another; shapes of weight zero are not moved.
_LEFT = 1e-3


@dataclass(frozen=True)
class MovedShape:
    """An input, moved towards the other inputs of a blend.

    Attributes
    ----------
    rest : TriangleMesh
        The input at rest in scene space, possibly with its triangles subdivided.
    vertices : (n, 3) float64
        Moved vertices of `rest`, scene units.
    parents : (m,) int64 or None
        The triangle of the input that contains each triangle of `rest`; None if nothing was subdivided.
    """

    rest: TriangleMesh
    vertices: NDArray[np.float64]
    parents: NDArray[np.int64] | None = None

    __repr__ = one_line("rest", "vertices")

    @cached_property
    def mesh(self) -> TriangleMesh:
        """The moved surface, with the triangles of `rest`."""
        return TriangleMesh(self.vertices, self.rest.faces)

    @cached_property
    def finder(self) -> ClosestPointFinder:
        """Closest-point finder of the moved surface."""
        return ClosestPointFinder(self.mesh.corners)

    def scaled(self, factor: float, center: NDArray[np.float64]) -> MovedShape:
        """Return the moved shape scaled about a point, (3,)."""
        return replace(self, vertices=center + factor * (self.vertices - center))


class Motion(Protocol):
    """Moves the inputs of a morph towards each other; only the remaining difference is transported.

    A motion can be sent to another process, and moves shapes identically there.
    """

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every input in the blend with these weights, which sum to one; None for inputs without weight.

        An input with a weight of one is returned unchanged. The result depends on the weights alone, so a path that
        returns to the same weights returns to the same shapes.
        """
        ...


def weights_between(count: int, pair: tuple[int, int], time: float) -> list[float]:
    """Return the weights of `count` shapes on the way from one of a pair to the other, at a time from 0 to 1."""
    weights = [0.0] * count
    weights[pair[0]], weights[pair[1]] = 1.0 - time, time
    return weights


def ways_between(pairs: Sequence[tuple[int, int]]) -> list[tuple[int, int]]:
    """Return the ways from either shape of every pair to the other one."""
    return [way for pair in pairs for way in (pair, pair[::-1])]


def unmoved(motion: Motion, count: int, index: int) -> MovedShape:
    """Return one of `count` shapes alone: at rest, with the triangles that a motion gives it."""
    return motion.moved([float(other == index) for other in range(count)])[index]


def arriving(motion: Motion, count: int, one: int, other: int) -> MovedShape:
    """Return one of `count` shapes moved onto another, as far as a motion brings it there."""
    return motion.moved(weights_between(count, (other, one), _LEFT))[one]


def motion_figures(about: Mapping[str, object]) -> dict[str, object]:
    """Return the part of a frame's record about the choice of a motion; empty if there was no choice."""
    return {"motion": dict(about)} if about else {}
