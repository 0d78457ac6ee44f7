# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names in files: copies that are exported have those of their originals, without the numbers that Blender appends."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import bpy

_LENT = "Convwass Lent"


@contextmanager
def borrowed_names(pairs: Sequence[tuple[bpy.types.ID, bpy.types.ID]]) -> Iterator[None]:
    """Let copies have the names of their originals, which have others meanwhile.

    Linked data keeps its name, which a copy in this file can have, too. Of several copies of one original, the first
    one gets its name.

    Parameters
    ----------
    pairs : sequence of (bpy.types.ID, bpy.types.ID)
        Every copy, which must still exist in the end, and its original.
    """
    names = {original: original.name for _, original in pairs}
    lent = [original for original in names if original.library is None]
    for original in lent:
        original.name = _LENT
    try:
        for copy, original in pairs:
            copy.name = names[original]
        yield
    finally:
        for copy, _ in pairs:
            copy.name = _LENT
        for original in lent:
            original.name = names[original]
