# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for recoloring, stored in the scene."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, PointerProperty, StringProperty

from ..applications.palettes.palette_settings import RecolorSettings, TableSettings
from .from_schema import values_of, with_properties
from .registration import registration

PALETTES = {"palette": "weight", "palette_2": "weight_2", "palette_3": "weight_3", "palette_4": "weight_4"}
"""Names of the palette properties, and of their weights."""


@with_properties(RecolorSettings)
class RecolorProperties:
    """Properties of a recoloring."""

    def recolor_settings(self) -> RecolorSettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        # The slope limit is either 0 (none) or at least 1.
        steepest = max(self.steepest, 1.0) if self.steepest > 0.0 else 0.0
        return RecolorSettings(**values_of(self, RecolorSettings) | {"steepest": steepest})


def attribute_name_property() -> object:
    """Return the property for the color attribute of the result."""
    return StringProperty(
        name="Result",
        description="Color attribute for the result; with the name of the active attribute, that one is changed",
        default="Recolored",
    )


def output_property() -> object:
    """Return the property for the destination of the recolored pixels of an image."""
    return EnumProperty(
        name="Output",
        description="Destination of the result",
        items=(
            ("NEW", "New Image", "A new image, packed into the file; the next result replaces it"),
            ("REPLACE", "Replace", "The image itself; its file is not changed until the image is saved"),
        ),
    )


def clip_folder_property() -> object:
    """Return the property for the output folder of a clip."""
    return StringProperty(
        name="Folder",
        description="Folder for the recolored frames, which keep their names; created if missing",
        default="//recolored/",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )


def _palette() -> object:
    return PointerProperty(name="Palette", description="Image whose colors are used", type=bpy.types.Image)


def _weight() -> object:
    return FloatProperty(
        name="Weight",
        description="Weight of this palette",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )


def _mask(name: str, description: str) -> object:
    return PointerProperty(name=name, description=description, type=bpy.types.Image)


def _has_colors(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH" and bool(obj.data.color_attributes)


@with_properties(TableSettings)
class CONVWASS_PG_recolor(RecolorProperties, bpy.types.PropertyGroup):
    """Settings for recoloring in a scene."""

    palette: _palette()
    palette_2: _palette()
    palette_3: _palette()
    palette_4: _palette()
    weight: _weight()
    weight_2: _weight()
    weight_3: _weight()
    weight_4: _weight()
    mask: _mask("Mask", "Image of the same size, white where colors change; if empty, all colors change")
    palette_mask: _mask("Palette Mask", "Image of the size of the first palette, white where its colors are used")
    output: output_property()
    clip_folder: clip_folder_property()
    palette_object: PointerProperty(
        name="Palette",
        description="Mesh whose active color attribute provides the palette",
        type=bpy.types.Object,
        poll=_has_colors,
    )
    result: attribute_name_property()

    @property
    def chosen_palettes(self) -> list[tuple[bpy.types.Image, float]]:
        """The chosen palette images with their weights."""
        pairs = [(getattr(self, name), getattr(self, weight)) for name, weight in PALETTES.items()]
        return [(image, weight) for image, weight in pairs if image is not None]


register, unregister = registration(
    (CONVWASS_PG_recolor,), ((bpy.types.Scene, "convwass_recolor", CONVWASS_PG_recolor),)
)
