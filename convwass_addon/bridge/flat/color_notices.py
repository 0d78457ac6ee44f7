# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find flat objects whose blends do not have the colors of their materials."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...sentence import Sentence
from ..morphs.materials import has_color_of_nodes


def color_notices(inputs: Sequence[bpy.types.Object]) -> list[Sentence]:
    """Return a notice about materials that blends show in their viewport colors, since nodes give their colors."""
    drawn = [obj for obj in inputs if obj.type != "GREASEPENCIL"]
    found = [(obj, slot.material) for obj in drawn for slot in obj.material_slots if slot.material is not None]
    found = [(obj, material) for obj, material in found if has_color_of_nodes(material)]
    if not found:
        return []
    names, materials = (", ".join(dict.fromkeys(block.name for block in blocks)) for blocks in zip(*found, strict=True))
    return [
        Sentence(
            "Blends show the viewport colors of {materials} ({names}), not their textures; choose these colors in "
            "Material > Viewport Display.",
            {"materials": materials, "names": names},
        )
    ]
