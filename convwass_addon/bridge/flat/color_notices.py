# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find flat objects whose blends do not have the colors of their materials, or lack their lines."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...sentence import Sentence
from ..morphs.looks.materials import has_color_of_nodes
from .flat_objects import FlatObject
from .pencil_looks import has_painted_fill


def color_notices(inputs: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return notices about materials whose colors blends do not show, since nodes, gradients or images give them."""
    used = [(obj, slot.material) for obj in inputs for slot in obj.material_slots if slot.material is not None]
    textured = [(obj, own) for obj, own in used if obj.type != "GREASEPENCIL" and has_color_of_nodes(own)]
    painted = [(obj, own) for obj, own in used if obj.type == "GREASEPENCIL" and has_painted_fill(own)]
    notices = []
    if textured:
        notices.append(
            Sentence(
                "Blends show the viewport colors of {materials} ({names}), not their textures; choose these colors in "
                "Material > Viewport Display.",
                _names(textured),
            )
        )
    if painted:
        notices.append(
            Sentence(
                "Blends show the base colors of {materials} ({names}), not their gradients or images.", _names(painted)
            )
        )
    return notices


def line_notices(flats: Sequence[FlatObject], names: Sequence[str]) -> list[Sentence]:
    """Return a notice that names the drawings with lines along their fills, which only drawings can show."""
    drawn = [name for name, flat in zip(names, flats, strict=True) if any(flat.read.lines or ())]
    if not drawn:
        return []
    return [
        Sentence(
            "Blends leave out the lines around the fills of {names}; set Flat Frames to Drawings to keep them.",
            {"names": ", ".join(drawn)},
        )
    ]


def _names(found: Sequence[tuple[bpy.types.Object, bpy.types.Material]]) -> dict[str, str]:
    """Return the names of materials and of their objects, without duplicates."""
    names, materials = (", ".join(dict.fromkeys(block.name for block in blocks)) for blocks in zip(*found, strict=True))
    return {"materials": materials, "names": names}
