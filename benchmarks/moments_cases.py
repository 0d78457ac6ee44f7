# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moments of players, a pair per process: ``python -m benchmarks.moments_cases CASE OPTIONS`` prints JSON."""

from __future__ import annotations

import time
from collections.abc import Sequence

import bpy
import numpy as np

from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.morphs.fields.stored_fields import field_cells
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.players.player import make_player
from convwass_addon.bridge.morphs.players.player_inputs import detail, interpolation, morph_value
from convwass_addon.bridge.morphs.stored import frame_objects, stored_settings
from convwass_addon.bridge.objects import triangle_mesh, write_mesh
from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .coherence_pairs import HELD_BACK, TUNED, Ends
from .measures import mean_surface_distance
from .processes import run_case

# Steps of the bake; every other blend is left out and compared.
_STEPS = 24


def between(pair: str, cells: int, motion: str, kept: int) -> dict[str, object]:
    """Bake a morph, keep some of its blends, and compare moments of a player with blends that were left out.

    Parameters
    ----------
    pair : str
        Name of a pair of the benchmark of coherence.
    cells : int
        Resolution.
    motion : str
        As in the settings.
    kept : int
        Number of steps between the blends that are kept; divides half of the steps of the bake.
    """
    ends = {own.name: own for own in (*TUNED, *HELD_BACK)}[pair].ends()
    return compared(baked(ends, cells, motion), 2 * kept)


def baked(ends: Ends, cells: int, motion: str) -> bpy.types.Collection:
    """Bake two shapes in an empty scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    inputs = []
    for name, mesh in (("A", ends.first), ("B", ends.second)):
        obj = bpy.data.objects.new(name, bpy.data.meshes.new(name))
        bpy.context.scene.collection.objects.link(obj)
        write_mesh(obj.data, mesh)
        inputs.append(obj)
    bpy.context.view_layer.update()
    settings = MorphSettings(resolution=cells, motion=motion)
    options = {"layout": "PATH", "frames": _STEPS}
    job = MorphJob(inputs, path_blends(2, _STEPS), settings, options, 1)
    for report in job.steps():
        job.write(report)
    return job.finish(hide_inputs=True)


def compared(collection: bpy.types.Collection, steps: int) -> dict[str, object]:
    """Keep every `steps`-th blend of a baked path, and compare a player with those halfway between."""
    frames = frame_objects(collection)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    left_out = {place: triangle_mesh(frames[place], depsgraph) for place in range(steps // 2, len(frames), steps)}
    longest = max(float(np.ptp(triangle_mesh(obj, depsgraph).vertices, axis=0).max()) for obj in frames)
    for place, obj in enumerate(frames):
        if place % steps:
            bpy.data.objects.remove(obj)
    begun = time.process_time()
    player = make_player(collection, between="INTERPOLATED")
    stored = time.process_time() - begun
    player.animation_data.action = None
    cell = longest / field_cells(stored_settings(collection))
    found: dict[str, object] = {"stored": stored, "blends": len(frame_objects(collection))}
    for name, interpolates, lays in (("mixed", True, False), ("laid", True, True), ("nearest", False, False)):
        interpolation(player).set(interpolates)
        detail(player).set(lays)
        distances, volumes, times = [], [], []
        for place, solved in left_out.items():
            morph_value(player).set(place / _STEPS)
            begun = time.process_time()
            shown = _shown(player)
            times.append(time.process_time() - begun)
            distances.append(mean_surface_distance(shown, solved) / cell)
            volumes.append(abs(shown.volume / solved.volume - 1.0))
        found |= {f"{name} distance": _mean_and_worst(distances), f"{name} volume": _mean_and_worst(volumes)}
        found[f"{name} ms"] = 1e3 * float(np.median(times))
    return found


def _shown(player: bpy.types.Object) -> TriangleMesh:
    bpy.context.view_layer.update()
    return triangle_mesh(player, bpy.context.evaluated_depsgraph_get())


def _mean_and_worst(values: Sequence[float]) -> tuple[float, float]:
    return float(np.mean(values)), float(np.max(values))


if __name__ == "__main__":
    run_case(between)
