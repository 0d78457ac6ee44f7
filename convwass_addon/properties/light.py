# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of materials and skies between others, as each scene has its own."""

from __future__ import annotations

import bpy
from bpy.props import EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from ..applications.reflectance.reflectance_settings import ReflectanceSettings
from ..applications.skies.sky_settings import SkySettings
from ..bridge.morphs.stored import FIRST_FRAMES
from ..bridge.reflectance.frame_span import Frames
from .from_schema import values_of, with_properties

MATERIALS = ("material", "material_2", "material_3", "material_4")
"""Names of the properties of materials; their weights are called weight, weight_2 and so on."""

WORLDS = ("world", "world_2", "world_3", "world_4")
"""Names of the properties of worlds."""

# Blender has as many frames before 0 as after it.
_FRAMES = {"min": -FIRST_FRAMES[1], "max": FIRST_FRAMES[1]}


@with_properties(ReflectanceSettings)
class ReflectanceProperties:
    """What a material between others is asked for."""

    blend: EnumProperty(
        name="Blend",
        description="What is made of the materials",
        items=(
            ("PATH", "Over Time", "From the first material through the others to the last, over frames"),
            ("KEYED", "Keyed", "As the weights in the panel are keyed, over frames"),
            ("WEIGHTS", "By Weights", "One material between all of them"),
            (
                "PAD",
                "Pad",
                "All over a triangle of three materials or a square of four, in which an empty is dragged",
            ),
        ),
    )
    blends: IntProperty(
        name="Steps",
        description="Blends that are computed on the way, or along each side of a pad; between two of them the values "
        "are mixed. A pad takes 16 at most",
        default=5,
        min=2,
        soft_max=17,
        max=65,
    )
    frame_start: IntProperty(name="Start", description="Frame that shows the first material", default=1, **_FRAMES)
    frame_end: IntProperty(name="End", description="Frame that shows the last material", default=60, **_FRAMES)
    output: EnumProperty(
        name="Output",
        description="What shows the highlights",
        items=(
            (
                "BOTH",
                "Both",
                "Two materials, one of either kind; of materials with a grain only the fitted one",
            ),
            (
                "LOBES",
                "Lobes",
                "A node group that looks the highlights up in a table, for the light of one sun without "
                "shadows; made for Cycles",
            ),
            ("FITTED", "Fitted", "The nearest Principled BSDF, for any light; it has one simple highlight"),
        ),
    )
    table: StringProperty(
        name="Table",
        description="File that the highlights go to as well; empty for none. Names that end in .npz or .lobes.exr hold "
        "all directions of one blend, other .exr what the node group looks up",
        subtype="FILE_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def reflectance_settings(self) -> ReflectanceSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        # Pairs of rows are what the solver takes.
        rows = self.detail + self.detail % 2
        return ReflectanceSettings(**values_of(self, ReflectanceSettings) | {"rows": rows})

    def frame_span(self) -> Frames:
        """Return the frames of the scene that a path takes."""
        return Frames(self.frame_start, self.frame_end)


@with_properties(SkySettings)
class SkyProperties:
    """What skies between others are asked for."""

    frame_start: IntProperty(name="Start", description="Frame that shows the first sky", default=1, **_FRAMES)
    frame_end: IntProperty(name="End", description="Frame that shows the last sky", default=24, **_FRAMES)
    width: IntProperty(
        name="Width",
        description="Pixels of the images around the horizon; there are half as many from top to bottom",
        default=1024,
        min=64,
        soft_max=4096,
        max=16384,
        subtype="PIXEL",
    )
    folder: StringProperty(
        name="Folder",
        description="Where the images go, one for every frame; those that are there are replaced",
        default="//skies",
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )

    def sky_settings(self) -> SkySettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return SkySettings(**values_of(self, SkySettings))


def _material() -> object:
    return PointerProperty(
        name="Material",
        description="Material with a Principled or Glossy BSDF; of an image on its roughness the mean counts",
        type=bpy.types.Material,
    )


def _weight() -> object:
    return FloatProperty(name="Weight", description="How much this material counts", default=1.0, min=0.0, soft_max=1.0)


def _world() -> object:
    return PointerProperty(name="World", description="World whose sky comes in its turn", type=bpy.types.World)


def _is_sun(_settings: bpy.types.PropertyGroup, obj: bpy.types.Object) -> bool:
    return obj.type == "LIGHT" and obj.data.type == "SUN"


class CONVWASS_PG_reflectance(ReflectanceProperties, bpy.types.PropertyGroup):
    """Settings of materials between others in a scene."""

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
        description="Light that tabulated highlights follow; while there is none, the first sun of the scene",
        type=bpy.types.Object,
        poll=_is_sun,
    )

    @property
    def chosen_materials(self) -> list[tuple[bpy.types.Material, float]]:
        """The materials that are chosen, with their weights."""
        weights = [name.replace("material", "weight") for name in MATERIALS]
        pairs = [(getattr(self, name), getattr(self, weight)) for name, weight in zip(MATERIALS, weights, strict=True)]
        return [(material, weight) for material, weight in pairs if material is not None]


class CONVWASS_PG_sky(SkyProperties, bpy.types.PropertyGroup):
    """Settings of skies between others in a scene."""

    world: _world()
    world_2: _world()
    world_3: _world()
    world_4: _world()

    @property
    def chosen_worlds(self) -> list[bpy.types.World]:
        """The worlds that are chosen, in turn."""
        return [world for name in WORLDS if (world := getattr(self, name)) is not None]


def sun_of(context: bpy.types.Context) -> bpy.types.Object | None:
    """Return the sun that tabulated highlights follow; None where the scene has none."""
    chosen = context.scene.convwass_reflectance.sun
    if chosen is not None and chosen.users_scene:
        return chosen
    return next((obj for obj in context.scene.objects if obj.type == "LIGHT" and obj.data.type == "SUN"), None)


_classes = (CONVWASS_PG_reflectance, CONVWASS_PG_sky)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings to scenes."""
    _register_classes()
    bpy.types.Scene.convwass_reflectance = PointerProperty(type=CONVWASS_PG_reflectance)
    bpy.types.Scene.convwass_sky = PointerProperty(type=CONVWASS_PG_sky)


def unregister() -> None:
    """Take them away."""
    del bpy.types.Scene.convwass_sky
    del bpy.types.Scene.convwass_reflectance
    _unregister_classes()
