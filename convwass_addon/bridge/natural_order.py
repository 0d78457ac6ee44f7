# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The order of names in Blender's lists: numbers by their value, capital and small letters alike."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"(\d+)")


def natural_key(name: str) -> tuple[list[str | int], str]:
    """Return a key for sorting names, such as "Step 2" before "Step 10"."""
    # Every second part is a number.
    parts = [int(part) if place % 2 else part for place, part in enumerate(_NUMBER.split(name.casefold()))]
    return parts, name
