# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The quality benchmark's cases, one per process: ``python -m benchmarks.quality_cases CASE OPTIONS`` prints JSON."""

from __future__ import annotations

from dataclasses import asdict
from itertools import pairwise

import numpy as np

from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.geometry.meshes.centroid import centroid
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.geometry.solids.occupancy import occupancy
from tests.transport.ellipsoids import Ellipsoid, intersection_over_union

from .blends import Pair, baked, density_at, own_surface, read_meshes, surface_at
from .measures import (
    Topology,
    densest_cells,
    edge_width,
    inside,
    largest_second_difference,
    mean_surface_distance,
    overlap_with_ball,
    thin_volume,
    topology,
)
from .processes import run_case
from .rods import Legged

TIMES = (0.25, 0.5, 0.75)
THIN_TIMES = (0.1, 0.5, 0.9)
# Thin parts are those that a ball of this radius cannot enter.
_THIN_RADIUS = 3.0


def ellipsoid_pairs(cells: int, count: int = 5) -> list[tuple[Ellipsoid, Ellipsoid]]:
    """Return the pair used in the tests and `count` random pairs in a cube of `cells`."""
    scale = cells / 64
    fixed = (
        Ellipsoid.rotated(scale * np.array([30, 31, 33]), scale * np.array([20, 9, 8]), [0.3, 0.5, 0.2]),
        Ellipsoid.rotated(scale * np.array([34, 33, 31]), scale * np.array([9, 18, 10]), [-0.4, 0.2, 0.9]),
    )
    draw = np.random.default_rng(4)

    def random() -> Ellipsoid:
        center = cells / 2 + scale * draw.uniform(-3, 3, 3)
        return Ellipsoid.rotated(center, scale * draw.uniform(7, 20, 3), draw.uniform(-np.pi, np.pi, 3))

    return [fixed, *((random(), random()) for _ in range(count))]


def ellipsoids(cells: int, sharpness: float | None) -> dict[str, object]:
    """Measure the overlap of the densest cells and of surfaces with the exact blend of two ellipsoids."""
    settings = MorphSettings(resolution=cells, sharpness=sharpness)
    lattice = Lattice((cells,) * 3, 1.0, np.zeros(3), np.zeros((2, 3)))
    found = {"cells": [], "exact": [], "linear": [], "possible": []}
    for first, second in ellipsoid_pairs(cells):
        densities = np.stack([first.occupancy(cells), second.occupancy(cells)])
        for t in TIMES:
            blend = first.barycenter(second, t)
            dense = densest_cells(density_at(densities, lattice, t, settings), blend.volume)
            found["cells"].append(intersection_over_union(dense, blend.occupancy(cells, 1)))
            for name, volumes in (("exact", [blend.volume] * 2), ("linear", [first.volume, second.volume])):
                found[name].append(_overlap(surface_at(densities, volumes, t, settings), blend))
            found["possible"].append(_overlap(own_surface(blend.occupancy(cells)), blend))
    return found


def handles(paths: list[str], cells: int, frames: int, sharpness: float | None) -> dict[str, object]:
    """Compute the topology of every frame of a bake, and of the two shapes at the same resolution."""
    settings = MorphSettings(resolution=cells, motion="transport", sharpness=sharpness)
    pair = Pair.read(paths, cells, settings.sigma)
    ends = [topology(own_surface(filled)) for filled in pair.densities]
    found = [topology(mesh) for mesh in baked(pair.shapes, frames, settings)]
    return {"ends": [_record(end) for end in ends], "frames": [_record(frame) for frame in found]}


def edges(paths: list[str], cells: int, sharpness: float | None, blur: float | None) -> dict[str, object]:
    """Measure the width of the border halfway between two shapes, and of the shapes themselves."""
    settings = MorphSettings(resolution=cells, sharpness=sharpness, blur=blur)
    pair = Pair.read(paths, cells, settings.sigma)
    density = density_at(pair.densities, pair.lattice, 0.5, settings)
    return {
        "blend": edge_width(density, float(pair.volumes.mean())),
        "ends": [edge_width(f, v) for f, v in zip(pair.densities.astype(float), pair.volumes, strict=True)],
    }


def legs(cells: int, motion: str, sharpness: float | None, level: str) -> dict[str, object]:
    """Measure the fraction of thin legs inside the blend of a body and its image, where the exact blend is known."""
    middle = np.full(3, cells / 2)
    first, second = {
        "moved": (Legged.at(np.subtract(middle, [4, 3, 2])), Legged.at(np.add(middle, [4, 3, 2]))),
        "shortened": (Legged.at(middle), Legged.at(middle, [1, 1, 0.6])),
        "spread": (Legged.at(middle), Legged.at(middle, [1.6, 1, 1])),
    }[motion]
    settings = MorphSettings(resolution=cells, sharpness=sharpness, level=level)
    densities = np.stack([first.occupancy(cells), second.occupancy(cells)])
    kept, possible = [], []
    for t in THIN_TIMES:
        blend = first.barycenter(second, t)
        truth = blend.occupancy(cells)
        mesh = surface_at(densities, [float(truth.sum())] * 2, t, settings)
        kept.append(float(inside(blend.thin_points(), mesh).mean()))
        possible.append(float(inside(blend.thin_points(), own_surface(truth)).mean()))
    return {"kept": kept, "possible": possible}


def thin(paths: list[str], cells: int, sharpness: float | None, level: str) -> dict[str, object]:
    """Measure the thin volume of blends relative to the interpolated one of the shapes, extracted in the same way."""
    settings = MorphSettings(resolution=cells, sharpness=sharpness, level=level)
    pair = Pair.read(paths, cells, settings.sigma)
    ends = [thin_volume(filled > 0.5, _THIN_RADIUS) for filled in pair.densities]
    found = []
    for t in THIN_TIMES:
        mesh = surface_at(pair.densities, pair.volumes, t, settings)
        filled = occupancy(mesh.corners, pair.lattice.shape) > 0.5
        found.append(thin_volume(filled, _THIN_RADIUS) / ((1 - t) * ends[0] + t * ends[1]))
    return {"ends": [end / v for end, v in zip(ends, pair.volumes, strict=True)], "share": found}


def stability(paths: list[str], cells: int, frames: int) -> dict[str, object]:
    """Measure volume, center and steps between the frames of a long bake, in cells."""
    settings = MorphSettings(resolution=cells, motion="transport")
    shapes = read_meshes(paths)
    meshes = baked(shapes, frames, settings)
    volumes = np.array([mesh.volume for mesh in meshes])
    centers = np.array([centroid(mesh) for mesh in meshes])
    steps = np.array([mean_surface_distance(a, b) for a, b in pairwise(meshes)])
    return {
        "volume": _curve(100.0 * volumes / volumes.mean()),
        "center": _curve(centers),
        "surface": _curve(steps),
        "mean": float(steps.mean()),
        "largest": float(steps.max()),
    }


def _overlap(mesh: TriangleMesh, ellipsoid: Ellipsoid) -> float:
    straight = (mesh.vertices - ellipsoid.center) @ np.linalg.inv(ellipsoid.stretch)
    return overlap_with_ball(TriangleMesh(straight, mesh.faces))


def _record(found: Topology) -> dict[str, int]:
    return {**asdict(found), "handles": found.handles}


def _curve(values: np.ndarray) -> dict[str, object]:
    """Return the longest step of a curve, its largest bend, and the frame of the bend."""
    lengths = np.abs(np.diff(values)) if values.ndim == 1 else np.linalg.norm(np.diff(values, axis=0), axis=1)
    bend, where = largest_second_difference(values)
    return {"step": float(lengths.max()), "bend": bend, "frame": where + 1}


if __name__ == "__main__":
    run_case(ellipsoids, handles, edges, legs, thin, stability)
