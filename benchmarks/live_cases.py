# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live blends, a case per process: ``python -m benchmarks.live_cases CASE OPTIONS`` prints one line of JSON."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.live.field_sources import (
    StandInSource,
    TransportSource,
    box_of_shapes,
    estimated_field_bytes,
)
from convwass_addon.applications.live.filling_lattice import LEVELS, count_of_nodes
from convwass_addon.applications.live.level_fields import mixed
from convwass_addon.applications.live.live_blends import FADE, LiveBlends, quick_settings
from convwass_addon.applications.live.live_settings import LiveSettings
from convwass_addon.applications.live.live_shapes import LiveShape, LiveShapes
from convwass_addon.applications.live.weight_layouts import layout_of
from convwass_addon.applications.morphs.extraction import LevelDensity, estimated_level_density, level_density
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.applications.morphs.preparing import sketchable_problem
from convwass_addon.applications.morphs.volumes import Lattice
from convwass_addon.bridge.objects import write_triangles
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained

from .blends import ASSETS, read_meshes
from .measures import mean_surface_distance
from .processes import peak_megabytes, run_case

# Number of blends to compare with solved ones, and of blends drawn in sequence while a handle moves back and forth.
_COMPARED, _DRAWN = 9, 60
# Tolerance of the solved blends for comparison: a tenth of the lattice's tolerance.
_EXACT = 1e-3
# Seconds between two shown shapes, speed of the handle per second, and seconds for a blend of the lattice.
_FRAME, _SPEED, _NODE = 1.0 / 30.0, 0.25, 0.08


class Clock:
    """A clock that advances only when told to."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        """Return the elapsed seconds."""
        return self.now


class Shown:
    """The mesh object that shows blends."""

    def __init__(self) -> None:
        self._object = bpy.data.objects.new("Live", bpy.data.meshes.new("Live"))
        bpy.context.scene.collection.objects.link(self._object)

    def show(self, shape: LiveShape) -> None:
        """Write a blend and let Blender evaluate it."""
        write_triangles(self._object.data, shape.mesh)
        self._object.location = shape.center
        bpy.context.view_layer.update()
        self._object.evaluated_get(bpy.context.evaluated_depsgraph_get())


def lattice(names: Sequence[str], cells: int, steps: int) -> dict[str, object]:
    """Fill a lattice by plain transport; then draw blends and compare them with solved ones.

    Parameters
    ----------
    names : sequence of str
        Sample shapes.
    cells : int
        Along the longest side.
    steps : int
        0 for the complete lattice; otherwise memory is limited so that the lattice ends at this number of steps.
    """
    shapes, clock, shown = _shapes(names), Clock(), Shown()
    begun, wall = time.process_time(), time.perf_counter()
    live = LiveBlends(shapes, MorphSettings(motion="transport"), _settings(cells, steps, shapes), clock=clock)
    work = live.work(Control())
    while live.shown() is None:
        next(work)
    shown.show(live.shown())
    first, first_wall = time.process_time() - begun, time.perf_counter() - wall
    drained(work)
    filled = time.process_time() - begun
    clock.now += 2.0 * FADE
    live.settle()
    drawing = [_drawn(live, shown, weights) for weights in _path(len(names), _DRAWN)]
    distances, volumes = _compared(live, shapes, cells, _scattered(len(names), _COMPARED))
    return {
        "first": first,
        "first_wall": first_wall,
        "fill": filled,
        "blends": live.filled,
        "megabytes": live.bytes / 1e6,
        "draw": 1e3 * float(np.median(drawing)),
        "draw_best": 1e3 * float(np.percentile(drawing, 10)),
        "distance": float(np.mean(distances)),
        "distance_worst": float(np.max(distances)),
        "volume": float(np.mean(volumes)),
        "volume_worst": float(np.max(volumes)),
        "peak": peak_megabytes(),
    }


def hand(names: Sequence[str], cells: int, solved: int) -> dict[str, object]:
    """Solve blends at the handle one after the other, as before the lattice is filled.

    Parameters
    ----------
    names, cells
        As for `lattice`.
    solved : int
        Number of cells that the blends are solved on.
    """
    shapes, shown = _shapes(names), Shown()
    quick = quick_settings(MorphSettings(resolution=solved)).tolerance
    source, box = _source(shapes, cells, solved, quick, estimated_level_density)
    times = []
    for weights in _path(len(names), _DRAWN):
        begun = time.thread_time()
        mesh = mixed([source.field(weights)], [1.0]).surface()
        shown.show(LiveShape(TriangleMesh(mesh.vertices / max(box.shape), mesh.faces), np.zeros(3)))
        times.append(time.thread_time() - begun)
    return {"draw": 1e3 * float(np.median(times)), "draw_best": 1e3 * float(np.percentile(times, 10))}


def jumps(names: Sequence[str], cells: int) -> dict[str, object]:
    """Move the handle at constant speed: before the lattice is filled, while finer levels take over, and afterwards."""
    shapes, clock = _shapes(names), Clock()
    live = LiveBlends(shapes, MorphSettings(motion="transport"), LiveSettings(live_resolution=cells), clock=clock)
    work, ends, before = live.work(Control()), 0.0, None
    found: dict[str, list[float]] = {"solving": [0.0], "filling": [0.0], "filled": [0.0]}
    for weights in _steady(len(names)):
        live.point(weights)
        is_whole = False
        while clock.now >= ends and not is_whole:
            is_whole = next(work, None) is None
            ends += _NODE
        shape = live.shown()
        if before is not None and shape is not None:
            stage = "solving" if live.coverage < 1.0 - 1e-3 else "filled" if is_whole else "filling"
            found[stage].append(mean_surface_distance(before, shape.mesh) * cells)
        before = None if shape is None else shape.mesh
        clock.now += _FRAME
    return {stage: float(np.max(moved)) for stage, moved in found.items()}


def _steady(count: int) -> list[NDArray[np.float64]]:
    """Return the weights of a handle that moves repeatedly from a third to two thirds and back."""
    frames = int((6.0 if count == 2 else 16.0) / _FRAME)
    place = np.arange(frames) * _FRAME * _SPEED
    share = 1.0 / 3.0 + np.abs((place % (2.0 / 3.0)) - 1.0 / 3.0)
    return [np.array([1.0 - own, own]) if count == 2 else np.array([0.8 * (1 - own), 0.8 * own, 0.2]) for own in share]


def _drawn(live: LiveBlends, shown: Shown, weights: NDArray[np.float64]) -> float:
    """Return the CPU seconds from weights to the evaluated mesh."""
    begun = time.thread_time()
    live.point(weights)
    shown.show(live.shown())
    return time.thread_time() - begun


def _compared(
    live: LiveBlends, shapes: LiveShapes, cells: int, scattered: Sequence[NDArray[np.float64]]
) -> tuple[list[float], list[float]]:
    """Return the distances of mixed surfaces from solved ones, in cells, and the relative errors of their volumes."""
    source, _ = _source(shapes, cells, cells, _EXACT)
    lattice = Lattice.around(shapes.inputs.shapes, cells, MorphSettings(resolution=cells).sigma)
    distances, volumes = [], []
    for weights in scattered:
        live.point(weights)
        shown, field = live.shown().mesh, source.field(live.hand)
        own = TriangleMesh((shown.vertices - lattice.origin) / lattice.spacing, shown.faces)
        distances.append(mean_surface_distance(own, mixed([field], [1.0]).surface()))
        volumes.append(abs(own.volume / field.volume - 1.0))
    return distances, volumes


def _source(
    shapes: LiveShapes,
    cells: int,
    solved: int,
    tolerance: float | None = None,
    read: Callable[..., LevelDensity] = level_density,
) -> tuple[TransportSource | StandInSource, object]:
    settings = MorphSettings(resolution=solved, motion="transport", tolerance=tolerance)
    problem = drained(sketchable_problem(shapes.inputs, settings, 1))
    fine = Lattice.around(shapes.inputs.shapes, cells, MorphSettings(resolution=cells).sigma)
    box = box_of_shapes(shapes.inputs.shapes, fine)
    if cells == solved:
        return TransportSource(problem, box, read=read), box
    return StandInSource(problem, fine, box), box


def _shapes(names: Sequence[str]) -> LiveShapes:
    meshes = read_meshes([ASSETS / f"{name}.ply" for name in names])
    return LiveShapes(MorphInputs.of(meshes, tuple(names)))


def _settings(cells: int, steps: int, shapes: LiveShapes) -> LiveSettings:
    """Return settings for which the lattice ends at a number of steps, or at the finest level."""
    if not steps:
        return LiveSettings(live_resolution=cells)
    fine = Lattice.around(shapes.inputs.shapes, cells, MorphSettings(resolution=cells).sigma)
    layout = layout_of(len(shapes.inputs.names))
    count = count_of_nodes(layout, [own for own in LEVELS if own <= steps])
    blends = [layout.weights(node, LEVELS[0]) for node in layout.nodes(LEVELS[0])]
    megabytes = estimated_field_bytes(shapes.inputs.shapes, fine, blends) * count / 1e6
    return LiveSettings(live_resolution=cells, live_memory=int(np.ceil(megabytes)))


def _path(count: int, frames: int) -> list[NDArray[np.float64]]:
    """Return the weights of a handle that moves once around."""
    turn = 2.0 * np.pi * np.linspace(0.0, 1.0, frames)
    if count == 2:
        share = 0.5 + 0.47 * np.sin(turn + 0.1)
        return list(np.stack([1.0 - share, share], axis=1))
    return list(np.stack([1.0 / 3.0 + 0.3 * np.cos(turn + 2.0 * np.pi * own / 3.0) for own in range(3)], axis=1))


def _scattered(count: int, blends: int) -> list[NDArray[np.float64]]:
    """Return weights between the nodes of a lattice."""
    if count == 2:
        share = np.linspace(0.06, 0.94, blends) + 0.0105
        return list(np.stack([1.0 - share, share], axis=1))
    drawn = np.clip(np.random.default_rng(1).dirichlet(np.ones(count), blends), 0.03, None)
    return list(drawn / drawn.sum(axis=1, keepdims=True))


if __name__ == "__main__":
    run_case(lattice, hand, jumps)
