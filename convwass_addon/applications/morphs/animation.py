# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Animated inputs: the mesh of each input at any time of a morph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.mesh import TriangleMesh


@dataclass(frozen=True)
class ShapeAnimation:
    """An input at several times.

    Attributes
    ----------
    times : tuple of float
        Ascending, in frames after the first one of the morph.
    meshes : tuple of TriangleMesh
        The input at these times, in scene space.
    """

    times: tuple[float, ...]
    meshes: tuple[TriangleMesh, ...]

    @cached_property
    def keeps_topology(self) -> bool:
        """Whether all meshes have the same triangles, so that vertices can be followed."""
        first = self.meshes[0]
        return all(len(own.vertices) == len(first.vertices) and _same(own.faces, first.faces) for own in self.meshes)

    def at(self, time: float) -> TriangleMesh:
        """Return the input at a time, interpolated linearly between known times and constant beyond them.

        If the triangles change, return the mesh of the nearest earlier time.
        """
        place = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 1))
        mesh = self.meshes[place]
        if place + 1 == len(self.times) or time <= self.times[place] or not self.keeps_topology:
            return mesh
        share = (time - self.times[place]) / (self.times[place + 1] - self.times[place])
        return TriangleMesh((1.0 - share) * mesh.vertices + share * self.meshes[place + 1].vertices, mesh.faces)

    def velocity(self, time: float) -> NDArray[np.float64]:
        """Return the velocity of the vertices at a time, (n, 3) per frame; only for meshes with the same triangles.

        It is the mean over one frame, or over its half within the known times at their ends.
        """
        first, last = np.clip((time - 0.5, time + 0.5), self.times[0], self.times[-1])
        if first == last:
            return np.zeros_like(self.meshes[0].vertices)
        return (self.at(last).vertices - self.at(first).vertices) / (last - first)


@dataclass(frozen=True)
class Animation:
    """All inputs of a path, animated.

    Attributes
    ----------
    shapes : tuple of ShapeAnimation
        One per input.
    stations : tuple of float
        Times at which each input is shown unblended.
    """

    shapes: tuple[ShapeAnimation, ...]
    stations: tuple[float, ...]

    @property
    def keeps_topology(self) -> bool:
        """Whether every input keeps its triangles."""
        return all(shape.keeps_topology for shape in self.shapes)

    def facing(self, faces: Sequence[NDArray[np.int64]]) -> Animation:
        """Return the same animation with other triangles of the same vertices, one array per input."""
        shapes = [
            replace(shape, meshes=tuple(TriangleMesh(mesh.vertices, own) for mesh in shape.meshes))
            for shape, own in zip(self.shapes, faces, strict=True)
        ]
        return replace(self, shapes=tuple(shapes))

    @property
    def meshes(self) -> list[TriangleMesh]:
        """The meshes of all inputs at all times."""
        return [mesh for shape in self.shapes for mesh in shape.meshes]

    def time_of(self, weights: Sequence[float]) -> float:
        """Return the time at which the blend of a path with these weights is shown."""
        return float(np.dot(weights, self.stations))


def _same(faces: NDArray[np.int64], other: NDArray[np.int64]) -> bool:
    return faces is other or np.array_equal(faces, other)
