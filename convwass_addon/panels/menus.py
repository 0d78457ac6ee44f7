# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Entries in Blender's menus, so that the operator search (F3) finds them."""

from __future__ import annotations

import bpy

from ..operators.live_morph import CONVWASS_OT_live_morph
from ..operators.morph_bake import CONVWASS_OT_bake_morph
from ..operators.texture_bake import CONVWASS_OT_bake_textures
from ..properties.live import LiveProperties
from ..properties.morphs import MorphProperties
from ..properties.one_mesh import TextureProperties
from .sidebar import fill_operator


def register() -> None:
    """Append the entries."""
    bpy.types.VIEW3D_MT_object.append(_draw)


def unregister() -> None:
    """Remove them."""
    bpy.types.VIEW3D_MT_object.remove(_draw)


def _draw(menu: bpy.types.Menu, context: bpy.types.Context) -> None:
    menu.layout.separator()
    operator = menu.layout.operator(CONVWASS_OT_bake_morph.bl_idname, icon="MOD_REMESH")
    fill_operator(operator, context.scene.convwass_morph, MorphProperties)
    operator = menu.layout.operator(CONVWASS_OT_live_morph.bl_idname, icon="PLAY")
    fill_operator(operator, context.scene.convwass_morph, MorphProperties)
    fill_operator(operator, context.scene.convwass_live, LiveProperties)
    operator = menu.layout.operator(CONVWASS_OT_bake_textures.bl_idname, icon="TEXTURE")
    fill_operator(operator, context.scene.convwass_textures, TextureProperties)
