# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors, materials and vertex groups of shapes, transferred to the vertices of a blend."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.closest_points import ClosestPointFinder, ClosestPoints


class Paint(Protocol):
    """The color of a material everywhere on a shape."""

    def at(self, places: ClosestPoints) -> NDArray[np.float32]:
        """Return scene linear RGBA at points of the shape, (n, 4)."""


@dataclass(frozen=True)
class Plain:
    """A single color.

    Attributes
    ----------
    color : (r, g, b, a)
        Scene linear.
    """

    color: tuple[float, float, float, float]

    def at(self, places: ClosestPoints) -> NDArray[np.float32]:
        """Return the color for every point."""
        return np.tile(np.array(self.color, dtype=np.float32), (len(places.triangles), 1))


@dataclass(frozen=True)
class Painted:
    """Colors stored at the corners of triangles.

    Attributes
    ----------
    corners : (m, 3, 4) float32
        RGBA, scene linear.
    """

    corners: NDArray[np.float32]

    def at(self, places: ClosestPoints) -> NDArray[np.float32]:
        """Interpolate within the triangles."""
        return places.interpolated(self.corners).astype(np.float32)


@dataclass(frozen=True)
class Textured:
    """An image mapped to the triangles by UV coordinates.

    Attributes
    ----------
    pixels : (h, w, 4) float32
        RGBA, scene linear; the bottom row first.
    uvs : (m, 3, 2) float32
        Texture coordinates of the corners of triangles.
    repeats : bool
        Whether the image repeats beyond its edges; otherwise its edge pixels are extended.
    """

    pixels: NDArray[np.float32]
    uvs: NDArray[np.float32]
    repeats: bool = True

    def at(self, places: ClosestPoints) -> NDArray[np.float32]:
        """Sample the image bilinearly.

        Coordinates are interpolated within one triangle: means over several triangles would cross seams.
        """
        height, width = self.pixels.shape[:2]
        where = places.interpolated(self.uvs) * (width, height) - 0.5
        low = np.floor(where).astype(np.int64)
        share = (where - low).astype(np.float32)
        result = np.zeros((len(where), 4), np.float32)
        for right in (0, 1):
            for up in (0, 1):
                column, row = low[:, 0] + right, low[:, 1] + up
                if self.repeats:
                    column, row = column % width, row % height
                else:
                    column, row = np.clip(column, 0, width - 1), np.clip(row, 0, height - 1)
                weight = np.abs(1 - right - share[:, 0]) * np.abs(1 - up - share[:, 1])
                result += weight[:, None] * self.pixels[row, column]
        return result


@dataclass(frozen=True)
class Appearance:
    """Colors, materials and vertex groups of one shape.

    Attributes
    ----------
    corners : (m, 3, 3) float64
        Triangles, in the same space as the origins of blends.
    materials : (m,) int64
        Material of every triangle.
    paints : tuple of Paint
        One per material.
    faces : (m, 3) int64
        Vertices of the triangles.
    groups : mapping of str to (v,) float32
        Weights of the vertices by the name of their group.
    """

    corners: NDArray[np.float64]
    materials: NDArray[np.int64]
    paints: tuple[Paint, ...]
    faces: NDArray[np.int64]
    groups: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)

    @cached_property
    def finder(self) -> ClosestPointFinder:
        """The closest-point finder of the shape, created on first use."""
        return ClosestPointFinder(self.corners)

    @property
    def is_even(self) -> bool:
        """Whether the appearance is the same everywhere."""
        return len(self.paints) == 1 and isinstance(self.paints[0], Plain) and not self.groups

    def at(self, points: NDArray) -> Seen:
        """Sample the appearance at the points of the surface closest to given points, (n, 3)."""
        if self.is_even:
            nowhere = ClosestPoints(np.zeros(len(points), np.int64), np.empty((0, 3)), np.empty(0))
            return Seen(self.paints[0].at(nowhere), nowhere.triangles, {})
        return self.seen(self.finder.find_about(points))

    def seen(self, places: ClosestPoints) -> Seen:
        """Return what there is at places of the shape."""
        materials = self.materials[places.triangles]
        colors = np.empty((len(materials), 4), np.float32)
        for index in np.unique(materials):
            own = materials == index
            there = ClosestPoints(places.triangles[own], places.shares[own], places.distances[own])
            colors[own] = self.paints[index].at(there)
        groups = {
            name: places.interpolated(weights[self.faces][..., None])[:, 0].astype(np.float32)
            for name, weights in self.groups.items()
        }
        return Seen(colors, materials, groups)


@dataclass(frozen=True)
class Seen:
    """The appearance of a shape at some points.

    Attributes
    ----------
    colors : (n, 4) float32
        RGBA, scene linear.
    materials : (n,) int64
        Index of the material.
    groups : dict of str to (n,) float32
        Weights of vertex groups.
    """

    colors: NDArray[np.float32]
    materials: NDArray[np.int64]
    groups: dict[str, NDArray[np.float32]]


@dataclass(frozen=True)
class Carried:
    """The appearance that the vertices of a blend take from the inputs.

    Attributes
    ----------
    weights : tuple of float
        Weight of every input.
    inputs : dict of int to Seen
        By the index of the input; inputs of weight 0 are left out.
    """

    weights: tuple[float, ...]
    inputs: dict[int, Seen]

    @property
    def color(self) -> NDArray[np.float32]:
        """Weighted mean of the inputs' colors, (n, 4)."""
        return sum(np.float32(self.weights[index]) * seen.colors for index, seen in self.inputs.items())

    @property
    def groups(self) -> dict[str, NDArray[np.float32]]:
        """Weighted means of the vertex groups that all of these inputs have, (n,) each."""
        names = set.intersection(*(set(seen.groups) for seen in self.inputs.values()))
        first = next(iter(self.inputs.values()))
        return {
            name: sum(np.float32(self.weights[index]) * seen.groups[name] for index, seen in self.inputs.items())
            for name in first.groups
            if name in names
        }


def carried(
    origins: NDArray[np.float32], faces: NDArray[np.int64], appearances: Sequence[Appearance], weights: Sequence[float]
) -> Carried:
    """Transfer the appearance of the inputs to the vertices of a blend.

    Colors are averaged over the faces around every vertex: image edges finer than the mesh would become jagged.

    Parameters
    ----------
    origins : (k, n, 3) float32
        From :func:`.origins.blend_origins`.
    faces : (m, 3) int64
        Triangles of the blend.
    appearances : sequence of Appearance
        One per input.
    weights : (k,)
        Weights of the blend.
    """
    seen = {
        index: _softened(appearance.at(own), faces)
        for index, (own, appearance, weight) in enumerate(zip(origins, appearances, weights, strict=True))
        if weight > 0
    }
    return Carried(tuple(float(weight) for weight in weights), seen)


@dataclass(frozen=True)
class FaceSlots:
    """The material slots of the inputs on the triangles of a blend.

    Attributes
    ----------
    combinations : list of tuple of int
        One slot of every input; 0 for those without weight.
    faces : (m,) int64
        Index of the combination of every triangle.
    """

    combinations: list[tuple[int, ...]]
    faces: NDArray[np.int64]


def face_slots(
    taken: Carried, faces: NDArray[np.int64], triangles: NDArray[np.int32] | None, appearances: Sequence[Appearance]
) -> FaceSlots:
    """Determine the material slots that the triangles of a blend get from the inputs.

    Parameters
    ----------
    taken : Carried
        The appearance at the vertices of the blend.
    faces : (m, 3) int64
        Triangles of the blend.
    triangles : (k, m) int32 or None
        The triangle of every input that each triangle lies on, -1 for none. Without it, a triangle takes the slot of
        most of its corners.
    appearances : sequence of Appearance
        One per input.
    """
    slots = np.zeros((len(faces), len(appearances)), np.int64)
    for index, seen in taken.inputs.items():
        if not appearances[index].materials.any():
            continue
        a, b, c = seen.materials[faces].T
        slots[:, index] = np.where(b == c, b, a)
        if triangles is not None:
            known = triangles[index] >= 0
            slots[known, index] = appearances[index].materials[triangles[index][known]]
    combinations, own = np.unique(slots, axis=0, return_inverse=True)
    return FaceSlots([tuple(map(int, row)) for row in combinations], own.reshape(-1))


def _softened(seen: Seen, faces: NDArray[np.int64]) -> Seen:
    """Average colors over the faces around every vertex, where a face has the mean color of its corners."""
    corners, count = faces.ravel(), len(seen.colors)
    about = np.bincount(corners, minlength=count)
    colors = seen.colors.copy()
    for channel in range(colors.shape[1]):
        of_faces = seen.colors[faces, channel].mean(axis=1)
        sums = np.bincount(corners, np.repeat(of_faces, 3), count)
        np.divide(sums, about, out=colors[:, channel], where=about > 0, casting="same_kind")
    return replace(seen, colors=colors)
