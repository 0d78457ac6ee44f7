# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What renders do with an object besides showing its materials: its pass index, and which rays see it."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

_SETTINGS = (
    "pass_index",
    "lightgroup",
    "is_holdout",
    "is_shadow_catcher",
    "visible_camera",
    "visible_diffuse",
    "visible_glossy",
    "visible_transmission",
    "visible_volume_scatter",
    "visible_shadow",
)


def take_render_settings(obj: bpy.types.Object, sources: Sequence[bpy.types.Object]) -> None:
    """Give an object the settings for renders in which all of some other objects agree."""
    for name in _SETTINGS:
        values = {getattr(source, name) for source in sources}
        if len(values) == 1:
            setattr(obj, name, values.pop())
    for name in ("receiver_collection", "blocker_collection"):
        linked = {getattr(source.light_linking, name) for source in sources}
        if len(linked) == 1:
            setattr(obj.light_linking, name, linked.pop())
