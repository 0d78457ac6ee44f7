# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read and check JSON in custom properties, which may be damaged."""

from __future__ import annotations

import json

import bpy


def parsed_table(text: str, schema: int) -> dict[str, object]:
    """Parse a table that was written with this schema.

    Raises
    ------
    TypeError, KeyError, ValueError, RecursionError
        It is damaged, holds NaN or infinity, or has another schema. The message says what is wrong.
    """
    data = json.loads(text, parse_constant=_no_number)
    if not isinstance(data, dict):
        raise TypeError("not a table")
    if data["schema"] != schema:
        raise ValueError(f"schema {data['schema']!r}, while this version reads {schema}")
    return data


def table_stored_with(block: bpy.types.ID, key: str) -> dict[str, object]:
    """Return the table in a custom property; an empty one if it is missing or damaged."""
    try:
        found = json.loads(block.get(key, "{}"))
    except (TypeError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def is_list_of(value: object, kind: type | tuple[type, ...]) -> bool:
    """Return whether a value is a list of items of a kind; a bool is no number."""
    return isinstance(value, list) and all(isinstance(item, kind) and not isinstance(item, bool) for item in value)


def _no_number(text: str) -> None:
    raise ValueError(f"{text} where a number belongs")
