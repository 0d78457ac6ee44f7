# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for blending materials and skies, stored in the scene."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.skies.sky_settings import SkySettings
from ..bridge.morphs.stored import FIRST_FRAMES
from ..bridge.reflectance.frame_span import Frames
from .from_schema import values_of, with_properties
from .registration import registration

MATERIALS = {"material": "weight", "material_2": "weight_2", "material_3": "weight_3", "material_4": "weight_4"}
"""Names of the material properties, and of their weights."""

WORLDS = ("world", "world_2", "world_3", "world_4")
"""Names of the world properties."""

_FRAMES = {"min": FIRST_FRAMES[0], "max": FIRST_FRAMES[1]}


@with_properties(ReflectanceSettings)
class ReflectanceProperties:
    """Properties for blending materials."""

    blend: EnumProperty(
        name="Blend",
        description="Which blends are made",
        items=(
            ("PATH", "Over Time", "From the first material through the others to the last, over time"),
            ("KEYED", "Keyed", "Follow the keyed weights in the panel, over time"),
            ("WEIGHTS", "By Weights", "One blend of all materials"),
            (
                "PAD",
                "Pad",
                "All blends of three materials on a triangle, or of four on a square, chosen by dragging an Empty",
            ),
        ),
    )
    blends: IntProperty(
        name="Steps",
        description="Number of blends computed along the path, or along each side of a pad; values in between are "
        "interpolated. At most 16 for a pad",
        default=5,
        min=2,
        soft_max=17,
        max=65,
    )
    frame_start: IntProperty(name="Start", description="Frame that shows the first material", default=1, **_FRAMES)
    frame_end: IntProperty(name="End", description="Frame that shows the last material", default=60, **_FRAMES)
    output: EnumProperty(
        name="Output",
        description="How the highlights are shown",
        items=(
            (
                "BOTH",
                "Both",
                "Two materials, one of each kind; only the fitted one for anisotropic materials",
            ),
            (
                "LOBES",
                "Lobes",
                "A node group that looks up the highlights in a table, for the light of one sun without shadows; for "
                "Cycles",
            ),
            ("FITTED", "Fitted", "The closest Principled BSDF, for any light; it has a single simple highlight"),
        ),
    )
    table: StringProperty(
        name="Table",
        description="File to write the highlights to; empty for none. Files named .npz or .lobes.exr hold all "
        "directions of one blend, other .exr files the table of the node group",
        subtype="FILE_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def reflectance_settings(self) -> ReflectanceSettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        # The solver requires an even number of rows.
        rows = self.detail + self.detail % 2
        return ReflectanceSettings(**values_of(self, ReflectanceSettings) | {"rows": rows})

    def frame_span(self) -> Frames:
        """Return the scene frames of a path."""
        return Frames(self.frame_start, self.frame_end)


@with_properties(SkySettings)
class SkyProperties:
    """Properties for blending skies."""

    frame_start: IntProperty(name="Start", description="Frame that shows the first sky", default=1, **_FRAMES)
    frame_end: IntProperty(name="End", description="Frame that shows the last sky", default=24, **_FRAMES)
    width: IntProperty(
        name="Width",
        description="Width of the images in pixels, rounded to a multiple of the grid on which light travels; the "
        "height is half of it",
        default=1024,
        min=64,
        soft_max=4096,
        max=16384,
        subtype="PIXEL",
    )
    folder: StringProperty(
        name="Folder",
        description="Folder for the images, one per frame; existing images are replaced",
        default="//skies",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def sky_settings(self) -> SkySettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        return SkySettings(**values_of(self, SkySettings))


def _material() -> object:
    return PointerProperty(
        name="Material",
        description="Material with a Principled or Glossy BSDF; if its roughness is an image, the mean is used",
        type=bpy.types.Material,
    )


def _weight() -> object:
    return FloatProperty(name="Weight", description="Weight of this material", default=1.0, min=0.0, soft_max=1.0)


def _world() -> object:
    return PointerProperty(name="World", description="World that provides the sky", type=bpy.types.World)


def _is_sun(_settings: bpy.types.PropertyGroup | None, obj: bpy.types.Object) -> bool:
    return obj.type == "LIGHT" and obj.data.type == "SUN"


class CONVWASS_PG_reflectance(ReflectanceProperties, bpy.types.PropertyGroup):
    """Settings for blending materials in a scene."""

    material: _material()
    material_2: _material()
    material_3: _material()
    material_4: _material()
    weight: _weight()
    weight_2: _weight()
    weight_3: _weight()
    weight_4: _weight()
    sun: PointerProperty(
        name="Sun",
        description="Light that tabulated highlights follow; if empty, the first sun in the scene",
        type=bpy.types.Object,
        poll=_is_sun,
    )

    @property
    def chosen_materials(self) -> list[tuple[bpy.types.Material, float]]:
        """The chosen materials with their weights."""
        pairs = [(getattr(self, name), getattr(self, weight)) for name, weight in MATERIALS.items()]
        return [(material, weight) for material, weight in pairs if material is not None]


class CONVWASS_PG_sky(SkyProperties, bpy.types.PropertyGroup):
    """Settings for blending skies in a scene."""

    world: _world()
    world_2: _world()
    world_3: _world()
    world_4: _world()

    @property
    def chosen_worlds(self) -> list[bpy.types.World]:
        """The chosen worlds, in order."""
        return [world for name in WORLDS if (world := getattr(self, name)) is not None]


def sun_of(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the sun that tabulated highlights follow, or None."""
    chosen = context.scene.convwass_reflectance.sun
    # The light may have been deleted, or have become another kind of light, since it was chosen.
    if chosen is not None and chosen.users_scene and _is_sun(None, chosen):
        return chosen
    return next((obj for obj in context.scene.objects if _is_sun(None, obj)), None)


register, unregister = registration(
    (CONVWASS_PG_reflectance, CONVWASS_PG_sky),
    (
        (bpy.types.Scene, "convwass_reflectance", CONVWASS_PG_reflectance),
        (bpy.types.Scene, "convwass_sky", CONVWASS_PG_sky),
    ),
)
