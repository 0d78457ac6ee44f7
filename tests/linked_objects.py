# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects that are linked from other files."""

from __future__ import annotations

from pathlib import Path

import bpy


def linked_object(path: str | Path, name: str) -> bpy.types.Object:
    """Link an object of another file to the scene."""
    with bpy.data.libraries.load(str(path), link=True) as (_, wanted):
        wanted.objects = [name]
    (linked,) = wanted.objects
    bpy.context.scene.collection.objects.link(linked)
    return linked


def linked_to_new_file(name: str, folder: Path) -> bpy.types.Object:
    """Save the file to a folder, start an empty one, and link an object of the saved file to it."""
    path = folder / "library.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return linked_object(path, name)
