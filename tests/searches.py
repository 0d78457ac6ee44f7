# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Count how often code looks through all objects, collections or scenes of the file."""

from __future__ import annotations

from collections import Counter

import bpy

# Properties of objects for which Blender looks through the whole file.
_SEARCHING = ("children", "children_recursive", "users_collection", "users_scene")


def counted_searches(monkeypatch, *modules):
    """Count what modules read of ``bpy.data``, and the properties of objects that search it, by their names."""
    counts = Counter()
    for name in _SEARCHING:
        monkeypatch.setattr(bpy.types.Object, name, _counted(name, counts))
    for module in modules:
        monkeypatch.setattr(module, "bpy", _Blender(counts))
    return counts


def _counted(name, counts):
    found = bpy.types.Object.__dict__[name].fget

    def searched(obj):
        counts[name] += 1
        return found(obj)

    return property(searched)


class _Blender:
    """The module bpy, counting what is read of its data."""

    def __init__(self, counts):
        self.data = _Data(counts)

    def __getattr__(self, name):
        return getattr(bpy, name)


class _Data:
    def __init__(self, counts):
        self._counts = counts

    def __getattr__(self, name):
        self._counts[name] += 1
        return getattr(bpy.data, name)
