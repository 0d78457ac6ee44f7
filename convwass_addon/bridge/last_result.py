# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The data-block to replace by a new result."""

from __future__ import annotations

from collections.abc import Iterable

import bpy


def last_result(results: Iterable[bpy.types.ID], name: str) -> bpy.types.ID | None:
    """Return the last result among data-blocks that are marked as such; None if there is none.

    Copies of a result are marked, too. The result is the one that still has its name, or else the first one.

    Parameters
    ----------
    results : iterable of bpy.types.ID
        The marked data-blocks; those that are linked from other files are ignored.
    name : str
        The name that the result was given.
    """
    own = [result for result in results if result.library is None]
    return next((result for result in own if result.name == name), next(iter(own), None))
