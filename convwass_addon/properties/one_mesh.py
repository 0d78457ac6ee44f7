# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of the images baked for one mesh, stored in the scene."""

from __future__ import annotations

import bpy

from ..applications.one_mesh.texture_settings import TextureSettings
from .from_schema import values_of, with_properties
from .registration import registration


@with_properties(TextureSettings)
class TextureProperties:
    """Properties of baked images, mixed into the scene's settings and the operator."""

    def texture_settings(self) -> TextureSettings:
        """Return the settings."""
        return TextureSettings(**values_of(self, TextureSettings))


class CONVWASS_PG_textures(TextureProperties, bpy.types.PropertyGroup):
    """Settings of baked images in a scene."""


register, unregister = registration(
    (CONVWASS_PG_textures,), ((bpy.types.Scene, "convwass_textures", CONVWASS_PG_textures),)
)
