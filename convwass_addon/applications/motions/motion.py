# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a morph asks of a motion: where every input is for a blend with given weights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.closest_points import ClosestPointFinder
from ...geometry.mesh import TriangleMesh
from ...one_line import one_line


@dataclass(frozen=True)
class MovedShape:
    """An input, moved towards the other inputs of a blend.

    Attributes
    ----------
    rest : TriangleMesh
        The input where it stands in the scene, perhaps with its triangles subdivided.
    vertices : (n, 3) float64
        Where the vertices of `rest` have moved to, scene units.
    parents : (m,) int64 or None
        Triangle of the input that every triangle of `rest` is a part of; None where nothing was subdivided.
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
        """Finds places on the moved surface."""
        return ClosestPointFinder(self.mesh.corners)


class Motion(Protocol):
    """Moves the inputs of a morph towards each other; only what still differs is then transported.

    A motion can be sent to another process, and gives the same shapes there.
    """

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every input as it is in the blend with these weights, which sum to one; None where the weight is zero.

        With a weight of one, the input itself. The result depends on the weights alone, so a path that comes back to
        the same weights comes back to the same shapes.
        """
        ...

    def record(self) -> dict[str, object]:
        """Say how well the motion fits, ready for JSON; its ``kind`` is what settings call it."""
        ...


def motion_figures(about: Mapping[str, object]) -> dict[str, object]:
    """Return what the record of a frame says about the choice of a motion; nothing where none was to be chosen."""
    return {"motion": dict(about)} if about else {}
