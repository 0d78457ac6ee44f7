# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find animated inputs of a morph, since a bake uses their shape in a single frame."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import bpy

from ....sentence import Sentence
from ...keyframes import has_animation

# Modifiers that are animated by themselves, or read animated files.
_SIMULATED = ("CLOTH", "SOFT_BODY", "FLUID", "DYNAMIC_PAINT", "OCEAN", "BUILD", "WAVE")
_FROM_FILES = ("MESH_SEQUENCE_CACHE", "MESH_CACHE")


def animation_notices(inputs: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return a notice that animated inputs are used in their shape at the current frame."""
    names = [obj.name for obj in inputs if is_animated(obj)]
    if not names:
        return []
    values = {"names": ", ".join(names), "frame": bpy.context.scene.frame_current}
    return [Sentence("The morph uses the animated {names} as they are in frame {frame}.", values)]


def is_animated(obj: bpy.types.Object) -> bool:
    """Return whether an object moves or deforms over time, as far as its settings show."""
    return any(has_animation(block) for block in data_of(obj)) or any(
        one.type in (*_SIMULATED, *_FROM_FILES) for one in obj.modifiers
    )


def data_of(obj: bpy.types.Object) -> Iterator[bpy.types.ID]:
    """Yield the data-blocks that determine shape and position of an object: its data, parents and modifier objects."""
    seen: set[bpy.types.ID] = set()
    waiting: list[bpy.types.ID | None] = [obj]
    while waiting:
        block = waiting.pop()
        if block is None or block in seen:
            continue
        seen.add(block)
        yield block
        if isinstance(block, bpy.types.Object):
            waiting += [block.data, block.parent, getattr(block.data, "shape_keys", None)]
            waiting += [getattr(one, "object", None) for one in block.modifiers]
            waiting += [getattr(one, "target", None) for one in block.constraints]
