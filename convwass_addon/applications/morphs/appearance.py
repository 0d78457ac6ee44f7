# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is on the surface of shapes, transferred to a blend: colors, materials, vertex groups, UV maps, attributes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ...geometry.meshes.closest_points import ClosestPointFinder, ClosestPoints
from .carried_uvs import UvMap, home_triangles


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
    """What is on the surface of one shape.

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
    uv_maps : mapping of str to UvMap
        By their names on blends.
    fields : mapping of str to (m, 3, d) float32
        Other values at the corners of triangles, by their names on blends.
    """

    corners: NDArray[np.float64]
    materials: NDArray[np.int64]
    paints: tuple[Paint, ...]
    faces: NDArray[np.int64]
    groups: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)
    uv_maps: Mapping[str, UvMap] = field(default_factory=dict)
    fields: Mapping[str, NDArray[np.float32]] = field(default_factory=dict)

    @cached_property
    def finder(self) -> ClosestPointFinder:
        """The closest-point finder of the shape, created on first use."""
        return ClosestPointFinder(self.corners)

    @property
    def is_even(self) -> bool:
        """Whether the appearance is the same everywhere."""
        plain = len(self.paints) == 1 and isinstance(self.paints[0], Plain)
        return plain and not (self.groups or self.uv_maps or self.fields)

    @cached_property
    def labels(self) -> NDArray[np.int64]:
        """The part of every triangle, (m,): those of one part have one material and one island of each UV map."""
        columns = [self.materials, *(own.charts for own in self.uv_maps.values())]
        return np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)[1].reshape(-1)

    def homes(
        self,
        seen: Seen,
        faces: NDArray[np.int64],
        origins: NDArray[np.floating],
        known: NDArray[np.integer] | None = None,
        owners: NDArray[np.int64] | None = None,
    ) -> NDArray[np.int64]:
        """Return the triangles that those of a blend belong to; see :func:`.carried_uvs.home_triangles`."""
        return home_triangles(self.finder, self.labels, seen.places, faces, origins, known, owners)

    def at(self, points: NDArray) -> Seen:
        """Sample the appearance at the points of the surface closest to given points, (n, 3)."""
        if self.is_even:
            nowhere = ClosestPoints(np.zeros(len(points), np.int64), np.empty((0, 3)), np.empty(0))
            return Seen(self.paints[0].at(nowhere), nowhere.triangles, {}, nowhere)
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
        fields = {name: places.interpolated(values).astype(np.float32) for name, values in self.fields.items()}
        return Seen(colors, materials, groups, places, fields)


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
    places : ClosestPoints
        Where on the shape; without meaning for shapes that look the same everywhere.
    fields : dict of str to (n, d) float32
        Other values.
    """

    colors: NDArray[np.float32]
    materials: NDArray[np.int64]
    groups: dict[str, NDArray[np.float32]]
    places: ClosestPoints
    fields: dict[str, NDArray[np.float32]] = field(default_factory=dict)


@dataclass(frozen=True)
class Carried:
    """The appearance that a blend takes from the inputs.

    Attributes
    ----------
    weights : tuple of float
        Weight of every input.
    inputs : dict of int to Seen
        At the vertices, by the index of the input; inputs of weight 0 are left out.
    slots : FaceSlots
        Material slots at the triangles.
    uvs : dict of str to (m, 3, 2) float32
        UVs of the corners of triangles.
    """

    weights: tuple[float, ...]
    inputs: dict[int, Seen]
    slots: FaceSlots
    uvs: dict[str, NDArray[np.float32]] = field(default_factory=dict)

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
    origins: NDArray[np.float32],
    faces: NDArray[np.int64],
    appearances: Sequence[Appearance],
    weights: Sequence[float],
    triangles: NDArray[np.integer] | None = None,
    owners: NDArray[np.int64] | None = None,
) -> Carried:
    """Transfer the appearance of the inputs to a blend.

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
    triangles : (k, m) int, optional
        The triangle of every input that each triangle lies on, -1 for none.
    owners : (m,) int64, optional
        Polygon of each triangle, if they are joined to quads.
    """
    seen: dict[int, Seen] = {}
    slots = np.zeros((len(faces), len(appearances)), np.int64)
    uvs: dict[str, NDArray[np.float32]] = {}
    for index, (own, appearance, weight) in enumerate(zip(origins, appearances, weights, strict=True)):
        if weight > 0:
            there = appearance.at(own)
            seen[index] = _softened(there, faces)
            if appearance.uv_maps or appearance.materials.any():
                known = None if triangles is None else triangles[index]
                homes = appearance.homes(there, faces, own, known, owners)
                slots[:, index] = appearance.materials[homes]
                uvs |= {name: uv_map.at(there.places, faces, own, homes) for name, uv_map in appearance.uv_maps.items()}
    return Carried(tuple(float(weight) for weight in weights), seen, FaceSlots.of(slots), uvs)


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

    @classmethod
    def of(cls, slots: NDArray[np.int64]) -> FaceSlots:
        """Find the combinations that occur, given the slot of every input at every triangle, (m, k)."""
        sizes = slots.max(axis=0, initial=0) + 1
        # Numbers are sorted much faster than rows.
        numbers, faces = np.unique(np.ravel_multi_index(tuple(slots.T), sizes), return_inverse=True)
        combinations = np.stack(np.unravel_index(numbers, sizes), axis=1)
        return cls([tuple(map(int, row)) for row in combinations], faces.reshape(-1))


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
