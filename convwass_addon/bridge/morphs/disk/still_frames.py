# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The frame objects of a morph as meshes that are seen at their times: moved with parents, and with modifiers."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import bpy
import numpy as np

from ...animation_time import returning, show_time, time_of_frame
from ...element_values import element_values
from ...flat.frames_as_meshes import mesh_of_frame
from ...keyframes import VISIBILITY_PATHS, curves_of, drivers_of
from ...matrix_checks import require_finite
from ...objects import take_own_materials, transform_mesh
from ...visibility import shown_at, shown_objects, update_places


@dataclass(frozen=True)
class StillFrames:
    """Mesh objects that neither move nor have modifiers.

    Attributes
    ----------
    first : list of bpy.types.Object
        One per frame object, as it is when it is first shown.
    shown : list of tuple of bpy.types.Object
        Those that are shown at each time; others than the first ones where a frame object has changed by then.
    """

    first: list[bpy.types.Object]
    shown: list[tuple[bpy.types.Object, ...]]

    @property
    def all(self) -> list[bpy.types.Object]:
        """All of them, without duplicates."""
        return list(dict.fromkeys([*self.first, *(obj for group in self.shown for obj in group)]))


@contextmanager
def still_frames(frames: Sequence[bpy.types.Object], times: Sequence[float]) -> Iterator[StillFrames]:
    """Provide frame objects as they are seen: those that move, have modifiers or are curves as copies in world space.

    Parameters
    ----------
    frames : sequence of bpy.types.Object
        Frame objects of a morph.
    times : sequence of float
        Times of the animation; empty for the current one.

    Raises
    ------
    InputError
        The place of a frame is not finite.
    """
    scene = bpy.context.scene
    times = list(times) or [time_of_frame(scene, scene.frame_current_final)]
    update_places(frames, bpy.context.evaluated_depsgraph_get())
    for obj in frames:
        if obj.mode == "EDIT":
            obj.update_from_editmode()
        require_finite(obj.name, np.array(obj.matrix_world))
    shown = shown_at(frames, times)
    changing = [obj for obj in frames if _may_change(obj)]
    copies: dict[bpy.types.Object, list[bpy.types.Object]] = {obj: [] for obj in changing}
    try:
        with shown_objects(changing, scene):
            still = _copied(shown, times, copies)
            for obj, own in copies.items():
                if not own:
                    own.append(_copy(obj))
        yield StillFrames([copies[obj][0] if obj in copies else obj for obj in frames], still)
    finally:
        made = [copy for own in copies.values() for copy in own]
        bpy.data.batch_remove([*made, *(copy.data for copy in made)])


def _copied(
    shown: Sequence[tuple[bpy.types.Object, ...]],
    times: Sequence[float],
    copies: dict[bpy.types.Object, list[bpy.types.Object]],
) -> list[tuple[bpy.types.Object, ...]]:
    """Replace objects by copies of how they are at each time, which are added to those of each object."""
    if not any(obj in copies for group in shown for obj in group):
        return list(shown)
    still, scene = [], bpy.context.scene
    with returning(scene):
        for group, time in zip(shown, times, strict=True):
            changing = [obj for obj in group if obj in copies]
            if changing:
                show_time(scene, time)
            for obj in changing:
                _add(copies[obj], _copy(obj))
            still.append(tuple(copies[obj][-1] if obj in copies else obj for obj in group))
    return still


def _add(copies: list[bpy.types.Object], copy: bpy.types.Object) -> None:
    """Add a copy, unless it is like the last one."""
    if copies and np.array_equal(_points(copies[-1]), _points(copy)):
        bpy.data.batch_remove([copy, copy.data])
    else:
        copies.append(copy)


def _points(obj: bpy.types.Object) -> np.ndarray:
    return element_values(obj.data.vertices, "co", 3)


def _copy(obj: bpy.types.Object) -> bpy.types.Object:
    """Return a copy of an object as it is now, at the origin and not in a scene."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = obj.evaluated_get(depsgraph)
    matrix = evaluated.matrix_world.copy()
    require_finite(obj.name, np.array(matrix))
    mesh = mesh_of_frame(obj, evaluated, depsgraph)
    take_own_materials(mesh, obj)
    transform_mesh(mesh, matrix)
    copy = bpy.data.objects.new(obj.name, mesh)
    copy.color = obj.color
    return copy


def _may_change(obj: bpy.types.Object) -> bool:
    """Return whether an object shows something else than its own mesh at a fixed place."""
    data, curves = obj.animation_data, [*curves_of(obj), *drivers_of(obj)]
    animated = any(curve.data_path not in VISIBILITY_PATHS for curve in curves) or bool(data and data.nla_tracks)
    others = obj.parent or obj.constraints or obj.modifiers
    return bool(obj.type != "MESH" or animated or others or obj.data.shape_keys)
