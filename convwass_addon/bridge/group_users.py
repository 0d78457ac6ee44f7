# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Particle systems, cloth and soft bodies that use vertex groups: Blender refers to a group by its number."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import bpy


@contextmanager
def kept_group_users(mesh: bpy.types.Mesh) -> Iterator[None]:
    """Let all objects with a mesh use groups of the same names at the end of the context as at its beginning."""
    used = [(owner, place, getattr(owner, place)) for owner in _owners(mesh) for place in _places(owner)]
    try:
        yield
    finally:
        for owner, place, group in used:
            # Assigning a group resets simulations.
            if getattr(owner, place) != group:
                setattr(owner, place, group)


def _owners(mesh: bpy.types.Mesh) -> Iterator[bpy.types.bpy_struct]:
    """Yield all settings that may refer to a group of a mesh by its number."""
    for obj in bpy.data.objects:
        if obj.data != mesh:
            continue
        yield from obj.particle_systems
        for modifier in obj.modifiers:
            if modifier.type in ("CLOTH", "SOFT_BODY"):
                yield modifier.settings
            if modifier.type == "CLOTH":
                yield modifier.collision_settings


def _places(owner: bpy.types.bpy_struct) -> list[str]:
    """Return the properties that name a group."""
    known = owner.bl_rna.properties
    return [own.identifier for own in known if own.identifier.startswith("vertex_group_") and own.type == "STRING"]
