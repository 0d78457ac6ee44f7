# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects are rendered over time."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import bpy

from .animation_time import returning, show_time
from .keyframes import is_shown
from .objects import shown_objects


def shown_at(objects: Sequence[bpy.types.Object], times: Iterable[float]) -> list[tuple[bpy.types.Object, ...]]:
    """Return which objects are rendered at each of some times of the animation, in their order.

    Their keys are read directly. Only for those that NLA strips or drivers show, the scene goes through all times; its
    current frame is restored.
    """
    times = list(times)
    if all(_has_only_keys(obj) for obj in objects):
        return [tuple(obj for obj in objects if is_shown(obj, time)) for time in times]
    scene, found = bpy.context.scene, []
    with shown_objects(objects, scene), returning(scene):
        for time in times:
            show_time(scene, time)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            found.append(tuple(obj for obj in objects if not obj.evaluated_get(depsgraph).hide_render))
    return found


def _has_only_keys(obj: bpy.types.Object) -> bool:
    data = obj.animation_data
    return data is None or not (data.nla_tracks or data.drivers)
