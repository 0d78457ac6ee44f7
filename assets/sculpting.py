# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solids as signed distance functions, and a grid to which they are added or from which they are carved.

A `Solid` is a function of coordinates that is negative inside, together with a box around it. `Clay` keeps the combined
field on a regular grid; adding a solid changes only the part of the grid that it can reach, so fine grids are fast.

The distance to an ellipsoid, the smooth minimum and the extrusion follow Inigo Quilez, "Distance functions" and
"Smooth minimum", https://iquilezles.org/articles/.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.ndimage import map_coordinates
from skimage.measure import marching_cubes

REACH = 0.3
"""How far outside its box a solid still changes the field; no blend may be wider."""

Point = Sequence[float]
Field = np.ndarray


@dataclass(frozen=True)
class Solid:
    """A body: `distance(x, y, z)` is negative inside; `low` and `high` are the corners of a box around it."""

    distance: Callable[[Field, Field, Field], Field]
    low: np.ndarray
    high: np.ndarray


def smooth_minimum(first: Field, second: Field, blend: float) -> Field:
    """Return the minimum of two fields, rounded where they differ by less than `blend`."""
    if blend == 0:
        return np.minimum(first, second)
    overlap = np.maximum(blend - np.abs(first - second), 0) / blend
    return np.minimum(first, second) - overlap * overlap * (blend / 4)


def rounded_intersection(first: Field, second: Field) -> Field:
    """Return the intersection of two fields, with the exact distance outside the corner between them."""
    outside = np.sqrt(np.maximum(first, 0) ** 2 + np.maximum(second, 0) ** 2)
    return outside + np.minimum(np.maximum(first, second), 0)


def spline(points: np.ndarray, steps: int, closed: bool = False) -> np.ndarray:
    """Return the Catmull-Rom curve through the rows of `points`, with `steps` pieces between two of them."""
    before, after = (points[-1], points[:2]) if closed else (2 * points[0] - points[1], 2 * points[-1] - points[-2])
    padded = np.vstack([before, points, after])
    t = np.linspace(0, 1, steps, endpoint=False)[:, None]
    pieces = []
    for p0, p1, p2, p3 in zip(padded[:-3], padded[1:-2], padded[2:-1], padded[3:], strict=True):
        pieces.append(p1 + 0.5 * t * (p2 - p0 + t * (2 * p0 - 5 * p1 + 4 * p2 - p3 + t * (3 * (p1 - p2) + p3 - p0))))
    return np.vstack([*pieces, padded[-2][None]])


def ellipsoid(center: Point, radii: Point, forward: Point = (1, 0, 0)) -> Solid:
    """Return an ellipsoid whose first axis points `forward` and whose second axis is horizontal."""
    center, radii = np.asarray(center, float), np.asarray(radii, float)
    along = np.asarray(forward, float) / np.linalg.norm(forward)
    level = np.cross([0, 0, 1], along)
    level /= np.linalg.norm(level)
    axes = np.array([along, level, np.cross(along, level)])

    def distance(x: Field, y: Field, z: Field) -> Field:
        x, y, z = x - center[0], y - center[1], z - center[2]
        local = [(axis[0] * x + axis[1] * y + axis[2] * z) / radius for axis, radius in zip(axes, radii, strict=True)]
        scaled = np.sqrt(sum(q * q for q in local))
        slope = np.sqrt(sum((q / radius) ** 2 for q, radius in zip(local, radii, strict=True)))
        return scaled * (scaled - 1) / np.maximum(slope, 1e-6)

    reach = np.sqrt(((axes * radii[:, None]) ** 2).sum(0))
    return Solid(distance, center - reach, center + reach)


def tube(points: Sequence[Point], radii: Sequence[float], steps: int = 6, closed: bool = False) -> Solid:
    """Round tube along a spline; the radius follows the same spline."""
    rows = spline(np.column_stack([np.asarray(points, float), radii]), steps, closed)
    path, radius = rows[:, :3], rows[:, 3]

    def distance(x: Field, y: Field, z: Field) -> Field:
        nearest = np.inf
        for start, end, first, last in zip(path[:-1], path[1:], radius[:-1], radius[1:], strict=True):
            step = end - start
            qx, qy, qz = x - start[0], y - start[1], z - start[2]
            t = np.clip((qx * step[0] + qy * step[1] + qz * step[2]) / (step @ step), 0, 1)
            gap = np.sqrt((qx - t * step[0]) ** 2 + (qy - t * step[1]) ** 2 + (qz - t * step[2]) ** 2)
            nearest = np.minimum(nearest, gap - (first + t * (last - first)))
        return nearest

    return Solid(distance, (path - radius[:, None]).min(0), (path + radius[:, None]).max(0))


def ribbon(points: Sequence[Point], widths: Sequence[float], thickness: Sequence[float], across: Point) -> Solid:
    """Return a tube of elliptical section: half-widths in the direction `across`, half-heights perpendicular to it."""
    rows = spline(np.column_stack([np.asarray(points, float), widths, thickness]), 5)
    path = rows[:, :3]
    across = np.asarray(across, float)

    def piece(start: np.ndarray, end: np.ndarray, x: Field, y: Field, z: Field) -> Field:
        step = end[:3] - start[:3]
        along = step / np.linalg.norm(step)
        side = across - (across @ along) * along
        side /= np.linalg.norm(side)
        normal = np.cross(along, side)
        qx, qy, qz = x - start[0], y - start[1], z - start[2]
        t = np.clip((qx * step[0] + qy * step[1] + qz * step[2]) / (step @ step), 0, 1)
        qx, qy, qz = qx - t * step[0], qy - t * step[1], qz - t * step[2]
        width, height = start[3] + t * (end[3] - start[3]), start[4] + t * (end[4] - start[4])
        a = (qx * side[0] + qy * side[1] + qz * side[2]) / width
        b = (qx * normal[0] + qy * normal[1] + qz * normal[2]) / height
        c = (qx * along[0] + qy * along[1] + qz * along[2]) / height
        scaled = np.sqrt(a * a + b * b + c * c)
        slope = np.sqrt((a / width) ** 2 + (b / height) ** 2 + (c / height) ** 2)
        return scaled * (scaled - 1) / np.maximum(slope, 1e-6)

    def distance(x: Field, y: Field, z: Field) -> Field:
        nearest = np.inf
        for start, end in pairwise(rows):
            nearest = np.minimum(nearest, piece(start, end, x, y, z))
        return nearest

    reach = rows[:, 3:].max(1)[:, None]
    return Solid(distance, (path - reach).min(0), (path + reach).max(0))


def frustum(start: Point, end: Point, radii: tuple[float, float], edge: float) -> Solid:
    """Return a truncated cone from `start` to `end` with these radii; its rims are rounded with radius `edge`."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    length = np.linalg.norm(end - start)
    along = (end - start) / length
    cosine = length / np.hypot(length, radii[1] - radii[0])

    def distance(x: Field, y: Field, z: Field) -> Field:
        x, y, z = x - start[0], y - start[1], z - start[2]
        height = along[0] * x + along[1] * y + along[2] * z
        outward = np.sqrt(np.maximum(x * x + y * y + z * z - height * height, 0))
        mantle = (outward - radii[0] - height / length * (radii[1] - radii[0])) * cosine + edge
        caps = np.abs(height - length / 2) - length / 2 + edge
        return rounded_intersection(mantle, caps) - edge

    reach = max(radii)
    return Solid(distance, np.minimum(start, end) - reach, np.maximum(start, end) + reach)


def extruded(strokes: Sequence[Solid], half_depth: float, edge: float, blend: float) -> Solid:
    """Return strokes in the plane y = 0, joined over `blend`, extruded by `half_depth` both ways, edges rounded."""

    def distance(x: Field, y: Field, z: Field) -> Field:
        flat = np.float32(REACH)
        for stroke in strokes:
            flat = smooth_minimum(flat, stroke.distance(x, np.zeros((1, 1, 1)), z), blend)
        return rounded_intersection(flat + edge, np.abs(y) - half_depth + edge) - edge

    low = np.min([stroke.low for stroke in strokes], 0)
    high = np.max([stroke.high for stroke in strokes], 0)
    low[1], high[1] = -half_depth, half_depth
    return Solid(distance, low, high)


def both_sides(solid: Solid) -> Solid:
    """Return the union of a solid at y > 0 and its mirror image."""
    low, high = solid.low.copy(), solid.high.copy()
    low[1] = -high[1]
    return Solid(lambda x, y, z: solid.distance(x, np.abs(y), z), low, high)


class Clay:
    """A field on a regular grid, negative inside the solids added so far."""

    def __init__(self, low: Point, high: Point, spacing: float) -> None:
        self.spacing = spacing
        self.axes = [np.arange(a, b + spacing, spacing, dtype=np.float32) for a, b in zip(low, high, strict=True)]
        self.field = np.full([len(axis) for axis in self.axes], REACH, np.float32)

    def add(self, solid: Solid, blend: float = 0.0) -> Clay:
        """Add a solid; the joint is rounded over about `blend`."""
        window, distance = self._evaluate(solid)
        self.field[window] = smooth_minimum(self.field[window], distance, blend)
        return self

    def carve(self, solid: Solid, blend: float = 0.0) -> Clay:
        """Remove a solid; the rim is rounded over about `blend`."""
        window, distance = self._evaluate(solid)
        self.field[window] = -smooth_minimum(-self.field[window], distance, blend)
        return self

    def merge(self, other: Clay) -> Clay:
        """Add another field on the same grid, without blending."""
        np.minimum(self.field, other.field, out=self.field)
        return self

    def surface(self) -> tuple[np.ndarray, np.ndarray]:
        """Vertices (V, 3) and outward triangles (T, 3) of the zero level."""
        # A grid point on the surface would cause degenerate triangles.
        clear = np.copysign(np.maximum(np.abs(self.field), 0.02 * self.spacing), self.field)
        vertices, triangles, _, _ = marching_cubes(-clear, 0.0, gradient_direction="ascent", method="lewiner")
        return vertices * self.spacing + [axis[0] for axis in self.axes], triangles

    def relaxed(self, vertices: np.ndarray, triangles: np.ndarray, rounds: int) -> np.ndarray:
        """Distribute vertices more evenly over the zero level, projecting them back onto it after each move."""
        corners = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        valence = np.bincount(corners[:, 0], minlength=len(vertices))[:, None]
        gradient = np.gradient(self.field)
        origin = np.array([axis[0] for axis in self.axes])
        for _ in range(rounds):
            total = np.zeros_like(vertices)
            np.add.at(total, corners[:, 0], vertices[corners[:, 1]])
            vertices = vertices + 0.5 * (total / valence - vertices)
            for _ in range(2):
                where = ((vertices - origin) / self.spacing).T
                slope = np.stack([map_coordinates(part, where, order=1) for part in gradient], 1) / self.spacing
                height = map_coordinates(self.field, where, order=1)[:, None]
                # Blending flattens the slope; the lower bound limits the length of the step there.
                vertices = vertices - height * slope / np.maximum((slope * slope).sum(1, keepdims=True), 0.25)
        return vertices

    def _evaluate(self, solid: Solid) -> tuple[tuple[slice, ...], Field]:
        window = tuple(
            slice(*np.searchsorted(axis, (a - REACH, b + REACH)))
            for axis, a, b in zip(self.axes, solid.low, solid.high, strict=True)
        )
        x, y, z = (axis[part] for axis, part in zip(self.axes, window, strict=True))
        distance = solid.distance(x[:, None, None], y[None, :, None], z[None, None, :])
        return window, distance.astype(np.float32)
