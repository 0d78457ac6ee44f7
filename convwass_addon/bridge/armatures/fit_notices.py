# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Messages about a fitted armature."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...sentence import Sentence
from .rigs import is_posed


def short_notice(names: Sequence[str]) -> list[Sentence]:
    """Return a notice about bones that have lost their length."""
    if not names:
        return []
    return [
        Sentence(
            "These bones lost their length and are tiny now: {names}; pin more joints near them.",
            {"names": ", ".join(names)},
        )
    ]


def unweighted_notice(count: int, body: bpy.types.Object) -> list[Sentence]:
    """Return a notice about vertices without automatic weights."""
    if not count:
        return []
    return [
        Sentence(
            "Automatic weights left {count} of {total} vertices of {object} without a bone; merge doubles, join loose "
            "parts and remove inner faces, or paint weights there.",
            {"count": count, "total": len(body.data.vertices), "object": body.name},
        )
    ]


def posed_notice(rig: bpy.types.Object) -> list[Sentence]:
    """Return a notice if the rig is posed, so that the fit is not visible."""
    if not is_posed(rig):
        return []
    return [
        Sentence(
            "{object} is posed, but the fit applies to its rest position, as in Edit Mode; clear its pose to see the "
            "fit.",
            {"object": rig.name},
        )
    ]
