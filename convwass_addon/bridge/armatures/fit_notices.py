# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user should know of an armature that was fitted."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...sentence import Sentence
from .rigs import is_posed


def short_notice(names: Sequence[str]) -> list[Sentence]:
    """Say which bones have come out without length."""
    if not names:
        return []
    return [
        Sentence(
            "These bones came out without length and are tiny now: {names}; pin more joints near them.",
            {"names": ", ".join(names)},
        )
    ]


def unweighted_notice(count: int, body: bpy.types.Object) -> list[Sentence]:
    """Say that automatic weights have left vertices out."""
    if not count:
        return []
    return [
        Sentence(
            "Automatic weights left {count} of {total} vertices of {object} without a bone; merge doubles, join loose "
            "parts and remove inner faces, or paint there.",
            {"count": count, "total": len(body.data.vertices), "object": body.name},
        )
    ]


def posed_notice(rig: bpy.types.Object) -> list[Sentence]:
    """Say that what has been fitted is not what is seen, where the rig is posed."""
    if not is_posed(rig):
        return []
    return [
        Sentence(
            "{object} is posed, and was fitted at rest, as Edit Mode shows it; clear its pose to see it so.",
            {"object": rig.name},
        )
    ]
