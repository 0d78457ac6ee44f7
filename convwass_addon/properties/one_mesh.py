# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the images baked for one mesh, stored in the scene."""

from __future__ import annotations

import bpy
from bpy.props import PointerProperty

from ..applications.one_mesh.texture_settings import TextureSettings
from .from_schema import values_of, with_properties


@with_properties(TextureSettings)
class TextureProperties:
    """Properties of baked images, mixed into the scene's settings and the operator."""

    def texture_settings(self) -> TextureSettings:
        """Return the settings."""
        return TextureSettings(**values_of(self, TextureSettings))


class CONVWASS_PG_textures(TextureProperties, bpy.types.PropertyGroup):
    """Settings of baked images in a scene."""


_register_classes, _unregister_classes = bpy.utils.register_classes_factory((CONVWASS_PG_textures,))


def register() -> None:
    """Add the settings to scenes."""
    _register_classes()
    bpy.types.Scene.convwass_textures = PointerProperty(type=CONVWASS_PG_textures)


def unregister() -> None:
    """Remove them."""
    del bpy.types.Scene.convwass_textures
    _unregister_classes()
