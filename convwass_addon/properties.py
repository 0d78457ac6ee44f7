# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings that the panel shows and the operators take, and the state of a running bake."""

from __future__ import annotations

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .applications.layouts import Blend, grid_blends, path_blends, triangle_blends
from .applications.morph_settings import MorphSettings


class MorphProperties:
    """What a morph is asked for: mixed into the scene's settings and into the operator, so both are one."""

    layout: EnumProperty(
        name="Layout",
        description="What to make of the shapes",
        items=(
            ("PATH", "Animation", "Walk through the shapes in order, one mesh per frame"),
            ("GRID", "Grid of Four", "Blend four shapes on a square sheet, one shape per corner"),
            ("TRIANGLE", "Triangle of Three", "Blend three shapes on a triangular sheet, one shape per corner"),
        ),
    )
    order: EnumProperty(
        name="Order",
        description="Order of the selected shapes",
        items=(
            ("NAME", "By Name", "In the order of their names"),
            ("LEFT_TO_RIGHT", "Left to Right", "In the order of their places along the scene's X axis"),
        ),
    )
    reverse: BoolProperty(name="Reverse", description="Turn the order around")
    frames: IntProperty(
        name="Frames",
        description="Scene frames from each shape to the next; one mesh is made for every frame",
        default=24,
        min=2,
        soft_max=250,
        max=10000,
    )
    steps: IntProperty(
        name="Steps",
        description="Blends along each side of the sheet, corners included",
        default=5,
        min=2,
        soft_max=12,
        max=50,
    )
    resolution: IntProperty(
        name="Resolution",
        description="Cells along the longest side of the volume; twice as many take about ten times as long and keep "
        "parts that are half as thin",
        default=64,
        min=16,
        soft_max=160,
        max=512,
    )
    use_custom_blur: BoolProperty(
        name="Set Blur", description="Set the blur by hand instead of one cell (or an eightieth of the resolution)"
    )
    blur: FloatProperty(
        name="Blur",
        description="Standard deviation of the transport's blur in cells; more is smoother and loses thin parts",
        default=1.5,
        min=0.5,
        max=20.0,
        soft_max=5.0,
    )
    use_custom_sharpness: BoolProperty(
        name="Set Sharpness",
        description="Set one sharpness for all frames instead of 0.75, rising to 1 close to the original shapes",
    )
    sharpness: FloatProperty(
        name="Sharpness",
        description="0 is smooth and may melt details, 1 is crisp and may tear",
        default=0.75,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    entropy_limit: EnumProperty(
        name="Entropy Limit",
        description="Keep blends from spreading out more than this",
        items=(
            ("OFF", "Off", "No limit"),
            ("MAX", "As the Inputs", "No blend spreads out more than the input that spreads out most"),
            ("NUMBER", "Custom", "Set the bound in nats"),
        ),
    )
    entropy_bound: FloatProperty(
        name="Entropy Bound", description="Largest entropy of a blend, in nats; 0 fills the whole volume", default=-2.0
    )
    level: EnumProperty(
        name="Surface",
        description="Where the surface is taken",
        items=(
            ("volume", "True Volume", "At the density that encloses the interpolated volume"),
            ("half-max", "Half Maximum", "At half of the largest density; thin parts are lost and the volume breathes"),
        ),
    )
    thickness: FloatProperty(
        name="Thickness",
        description="Thickness given to shapes that enclose no volume, such as planes; 0 refuses them",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
    )
    parts: EnumProperty(
        name="Parts",
        description="Which parts of the shapes travel together: those of the same name on all shapes",
        items=(
            ("none", "None", "The shapes travel as wholes"),
            ("vertex-groups", "Vertex Groups", "Every face belongs to the vertex group with the most weight on it"),
            ("materials", "Materials", "Every face belongs to its material"),
        ),
    )
    locality: FloatProperty(
        name="Locality",
        description="At 0 all mass travels; towards 1 it goes less and less far, and parts shrink in one place and "
        "grow in another",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    thin_parts: BoolProperty(
        name="Keep Thin Parts",
        description="Thin parts keep their volume where one density for all would make them thinner or lose them",
        default=True,
    )
    mend: BoolProperty(
        name="Mend",
        description="Drop crumbs, bridge narrow gaps and close false holes, as far as the shapes themselves have none",
        default=True,
    )
    hide_inputs: BoolProperty(
        name="Hide Inputs", description="Hide the original objects when the morph is done", default=True
    )

    def blends(self, count: int) -> list[Blend]:
        """Return the blends of `count` shapes that the layout asks for; raises InputError for a wrong count."""
        if self.layout == "GRID":
            return grid_blends(count, self.steps)
        if self.layout == "TRIANGLE":
            return triangle_blends(count, self.steps)
        return path_blends(count, self.frames)

    def solver_settings(self) -> MorphSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return MorphSettings(
            resolution=self.resolution,
            blur=self.blur if self.use_custom_blur else None,
            sharpness=self.sharpness if self.use_custom_sharpness else None,
            entropy_limit={"OFF": None, "MAX": "max", "NUMBER": self.entropy_bound}[self.entropy_limit],
            level=self.level,
            thickness=self.thickness,
            locality=self.locality,
            thin_parts=self.thin_parts,
            mend=self.mend,
            parts=self.parts,
        )

    def sorted_shapes(self, objects: list[bpy.types.Object]) -> list[bpy.types.Object]:
        """Return the objects in the order asked for."""
        along_x = self.order == "LEFT_TO_RIGHT"
        return sorted(
            objects,
            key=lambda obj: (obj.matrix_world.translation.x if along_x else 0.0, obj.name),
            reverse=self.reverse,
        )

    def take_stored(self, stored: dict[str, object]) -> None:
        """Take over what a baked morph was asked for."""
        shared = ("resolution", "level", "thickness", "parts", "locality", "thin_parts", "mend")
        for name in ("layout", "frames", "steps", "order", "reverse", *shared):
            if name in stored:
                setattr(self, name, stored[name])
        for name in ("blur", "sharpness"):
            setattr(self, f"use_custom_{name}", stored[name] is not None)
            if stored[name] is not None:
                setattr(self, name, stored[name])
        limit = stored["entropy_limit"]
        self.entropy_limit = "OFF" if limit is None else "MAX" if limit == "max" else "NUMBER"
        if self.entropy_limit == "NUMBER":
            self.entropy_bound = limit


class CONVWASS_PG_morph(MorphProperties, bpy.types.PropertyGroup):
    """Morph settings of a scene."""


class CONVWASS_PG_progress(bpy.types.PropertyGroup):
    """The bake that is running in this window manager, if any."""

    running: BoolProperty()
    fraction: FloatProperty(min=0.0, max=1.0)
    message: StringProperty()


_classes = (CONVWASS_PG_morph, CONVWASS_PG_progress)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings to scenes and the progress to the window manager."""
    _register_classes()
    bpy.types.Scene.convwass_morph = PointerProperty(type=CONVWASS_PG_morph)
    bpy.types.WindowManager.convwass_progress = PointerProperty(type=CONVWASS_PG_progress)


def unregister() -> None:
    """Take both away."""
    del bpy.types.WindowManager.convwass_progress
    del bpy.types.Scene.convwass_morph
    _unregister_classes()
