# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of recoloring, as each scene has its own."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..applications.palettes.palette_settings import RecolorSettings

PALETTES = ("palette", "palette_2", "palette_3", "palette_4")
"""Names of the properties of palettes; their weights are called weight, weight_2 and so on."""


class RecolorProperties:
    """What recoloring is asked for."""

    strength: FloatProperty(
        name="Strength",
        description="How far colors go: 0 leaves them as they are, 1 gives the palette",
        default=RecolorSettings.strength,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    lightness: EnumProperty(
        name="Lightness",
        description="What happens to how light colors are",
        items=(
            ("TRANSPORT", "From Palette", "Carry it along, which changes the contrast too"),
            ("KEEP", "Keep", "Leave it as it is, and carry the hues only"),
        ),
    )
    smoothing: FloatProperty(
        name="Smoothing",
        description="How far the map of colors is averaged: with less, the palette is met more closely; with more, "
        "noise and faint steps are raised less",
        default=RecolorSettings.smoothing,
        min=0.0,
        soft_max=4.0,
        max=20.0,
    )
    steepest: FloatProperty(
        name="Slope Limit",
        description="Largest factor by which contrast in lightness may grow; 0 for no limit",
        default=RecolorSettings.steepest,
        min=0.0,
        soft_max=10.0,
        max=1000.0,
    )
    gamut: EnumProperty(
        name="Out of Gamut",
        description="What becomes of colors that a screen cannot show",
        items=(
            ("CLIP", "Clip", "Cut off red, green and blue"),
            ("CHROMA", "Less Chroma", "Make them paler until they can be shown, as light as they are"),
        ),
    )
    edge_radius: IntProperty(
        name="Edge Radius",
        description="Radius of a filter that evens out the change of colors between edges, which takes grain from "
        "steep maps; 0 for none",
        default=RecolorSettings.edge_radius,
        min=0,
        soft_max=20,
        max=200,
        subtype="PIXEL",
    )

    def recolor_settings(self) -> RecolorSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return RecolorSettings(
            strength=self.strength,
            lightness=self.lightness.lower(),
            smoothing=self.smoothing,
            # Between none and one there is no slope that a limit could have.
            steepest=max(self.steepest, 1.0) if self.steepest > 0.0 else 0.0,
            gamut=self.gamut.lower(),
            edge_radius=self.edge_radius,
        )


def cube_size_property() -> object:
    """Return the property of how many colors a table has along an edge."""
    return IntProperty(
        name="Table Size",
        description="Colors along an edge of the table: 33 is usual, 65 is three times as exact",
        default=65,
        min=2,
        soft_min=17,
        max=129,
    )


def attribute_name_property() -> object:
    """Return the property of the attribute that recolored colors go to."""
    return StringProperty(
        name="Result",
        description="Color attribute that the result goes to; the name of the active one changes that in place",
        default="Recolored",
    )


def clip_folder_property() -> object:
    """Return the property of where the frames of a clip go."""
    return StringProperty(
        name="Folder",
        description="Where the recolored frames go, under the names of the frames; made if missing",
        default="//recolored/",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )


def _palette() -> object:
    return PointerProperty(name="Palette", description="Image whose colors are taken", type=bpy.types.Image)


def _weight() -> object:
    return FloatProperty(
        name="Weight",
        description="How much this palette counts among several",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )


def _mask(name: str, description: str) -> object:
    return PointerProperty(name=name, description=description, type=bpy.types.Image)


def _has_colors(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "MESH" and bool(obj.data.color_attributes)


class CONVWASS_PG_recolor(RecolorProperties, bpy.types.PropertyGroup):
    """Settings of recoloring in a scene."""

    palette: _palette()
    palette_2: _palette()
    palette_3: _palette()
    palette_4: _palette()
    weight: _weight()
    weight_2: _weight()
    weight_3: _weight()
    weight_4: _weight()
    mask: _mask("Mask", "Image of the same size, white where the colors change; all of it without one")
    palette_mask: _mask("Palette Mask", "Image of the size of the first palette, white where its colors count")
    output: EnumProperty(
        name="Output",
        description="Where the result goes",
        items=(
            ("NEW", "New Image", "An image of its own, packed into the file; the next result replaces it"),
            ("REPLACE", "Replace", "The image itself; its file stays as it is until the image is saved"),
        ),
    )
    cube_size: cube_size_property()
    clip_folder: clip_folder_property()
    palette_object: PointerProperty(
        name="Palette",
        description="Mesh whose active color attribute gives the palette",
        type=bpy.types.Object,
        poll=_has_colors,
    )
    result: attribute_name_property()

    @property
    def chosen_palettes(self) -> list[tuple[bpy.types.Image, float]]:
        """The images that are chosen as palettes, with their weights."""
        weights = [name.replace("palette", "weight") for name in PALETTES]
        pairs = [(getattr(self, name), getattr(self, weight)) for name, weight in zip(PALETTES, weights, strict=True)]
        return [(image, weight) for image, weight in pairs if image is not None]


_classes = (CONVWASS_PG_recolor,)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings to scenes."""
    _register_classes()
    bpy.types.Scene.convwass_recolor = PointerProperty(type=CONVWASS_PG_recolor)


def unregister() -> None:
    """Take them away."""
    del bpy.types.Scene.convwass_recolor
    _unregister_classes()
