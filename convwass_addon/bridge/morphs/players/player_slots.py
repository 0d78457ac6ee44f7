# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The material slots of a player that its user has changed, kept while it gets other frames."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import bpy

from ..looks.frame_colors import seen_materials
from ..stand_ins import frames_modifier, shown_morph
from ..stored import frame_objects


@dataclass(frozen=True)
class ChangedSlot:
    """A slot with a material that none of the frames has, or with a material of the object instead of the mesh.

    Attributes
    ----------
    index : int
        Which slot.
    link : str
        "OBJECT" or "DATA".
    material : bpy.types.Material or None
        The material.
    """

    index: int
    link: str
    material: bpy.types.Material | None


def changed_slots(player: bpy.types.Object) -> list[ChangedSlot]:
    """Return the slots of a player that differ from those it was made with; its frames must still exist."""
    made = seen_materials(frames_modifier(player).node_group, frame_objects(shown_morph(player)))
    slots = (ChangedSlot(index, slot.link, slot.material) for index, slot in enumerate(player.material_slots))
    return [slot for slot in slots if slot.link == "OBJECT" or slot.material not in made]


def restore_slots(player: bpy.types.Object, slots: Iterable[ChangedSlot]) -> None:
    """Change slots of a player again, in ascending order; missing ones are added at the end."""
    for slot in slots:
        if slot.index >= len(player.material_slots):
            player.data.materials.append(None)
        place = player.material_slots[min(slot.index, len(player.material_slots) - 1)]
        place.link = slot.link
        place.material = slot.material
