# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of morphs, as the panel shows them and the operator takes them."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.props import BoolProperty, EnumProperty, IntProperty, StringProperty

from ..applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from ..bridge.morphs.stored import FIRST_FRAMES
from .morph_solver import SolverProperties

OUTPUTS = (
    ("OBJECTS", "Objects", "One mesh object per frame, each visible in its frame alone"),
    ("PLAYER", "Player", "One object with a value to animate that chooses the mesh; for a sheet, a pad to drag on"),
    (
        "VOLUME",
        "Volume",
        "VDB files, and a mesh made of them whose level and smoothing stay editable",
    ),
    ("CACHE", "Cache", "An Alembic or USD file, and one object that reads it"),
)
"""What a bake makes, as items of an enum."""

CACHE_FORMATS = (
    ("alembic", "Alembic", "One .abc file, which most programs read"),
    ("usd", "USD", "One .usdc file"),
)
"""Files that a morph can be cached in, as items of an enum."""

DEFAULT_FOLDER = "//convwass"
"""Beside the .blend file."""

STORED_OPTIONS = (
    "layout",
    "frames",
    "frame_step",
    "steps",
    "order",
    "reverse",
    "alignment",
    "scaling",
    "start",
    "frame_start",
    "output",
    "folder",
    "cache_format",
    "words",
    "flat_output",
    "grays",
)
"""Properties that are stored with a morph besides those of its solver."""


def folder_property() -> object:
    """Return the property of where the files of a morph go."""
    return StringProperty(
        name="Folder",
        description="Where the files go, in a folder named after the morph; // is the folder of the .blend file",
        default=DEFAULT_FOLDER,
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )


class MorphProperties(SolverProperties):
    """What a morph is asked for: mixed into the scene's settings and into the operator, so both are one."""

    layout: EnumProperty(
        name="Layout",
        description="What to make of the shapes",
        items=(
            ("PATH", "Animation", "Walk through the shapes in order, one mesh per frame"),
            ("GRID", "Grid of Four", "Blend four shapes on a square sheet, one shape per corner"),
            ("TRIANGLE", "Triangle of Three", "Blend three shapes on a triangular sheet, one shape per corner"),
            ("BLEND", "Single Blend", "Blend all shapes into one mesh, by their weights on the list of inputs"),
        ),
    )
    order: EnumProperty(
        name="Order",
        description="Order of the selected shapes; those on the list of inputs have the order of the list",
        items=(
            ("NAME", "By Name", "In the order of their names"),
            ("LEFT_TO_RIGHT", "Left to Right", "In the order of their places along the scene's X axis"),
        ),
    )
    reverse: BoolProperty(name="Reverse", description="Turn the order around")
    alignment: EnumProperty(
        name="Alignment",
        description="How the shapes are laid onto the first one before they are morphed",
        items=(
            ("PLACED", "As Placed", "Shapes travel from where one stands to where the next one stands"),
            ("CENTERED", "Centered", "All shapes stand where the first one stands, center of mass on center of mass"),
            (
                "PRINCIPAL_AXES",
                "Principal Axes",
                "Centered, and turned so that long sides lie on long sides and heavy ends on heavy ends",
            ),
        ),
    )
    scaling: EnumProperty(
        name="Scale",
        description="How large the shapes are",
        items=(
            ("PLACED", "As Placed", "As large as in the scene; blends grow or shrink from one to the next"),
            ("EQUAL_VOLUME", "Equal Volume", "All shapes get the volume of the first one"),
        ),
    )
    frames: IntProperty(
        name="Frames",
        description="Scene frames from each shape to the next",
        default=24,
        min=2,
        soft_max=250,
        max=10000,
    )
    frame_step: IntProperty(
        name="Step",
        description="Make a mesh for every so many frames only, which shows until the next one",
        default=1,
        min=1,
        soft_max=12,
        max=1000,
    )
    start: EnumProperty(
        name="Start",
        description="Frame of the scene in which the morph begins",
        items=(
            ("SCENE", "Scene Start", "At the start of the scene, whose end becomes that of the morph"),
            ("CURRENT", "Current Frame", "At the frame that is shown now"),
            ("CUSTOM", "Custom", "At a frame of your choice"),
        ),
    )
    frame_start: IntProperty(
        name="Start Frame",
        description="Frame of the first shape",
        default=1,
        min=FIRST_FRAMES[0],
        max=FIRST_FRAMES[1],
    )
    steps: IntProperty(
        name="Steps",
        description="Blends along each side of the sheet, corners included",
        default=5,
        min=2,
        soft_max=12,
        max=50,
    )
    flat_output: EnumProperty(
        name="Flat Frames",
        description="What frames of flat shapes are",
        items=(
            ("CURVE", "Curves", "Curve objects with the bevel, the extrusion and the fill of the shapes"),
            ("MESH", "Meshes", "Meshes, filled, beveled and extruded as the curves would be"),
            ("DRAWING", "Drawings", "One Grease Pencil object with a filled drawing on a keyframe per frame"),
            (
                "PICTURE",
                "Pictures",
                "A sequence of image files, and a plane that shows it; of images, grays travel too",
            ),
        ),
    )
    grays: EnumProperty(
        name="Grays",
        description="How pictures are made of what the transport leaves blurred",
        items=(
            ("IMAGES", "As in the Images", "Pixels get the grays of the images, from the darkest to the brightest"),
            ("THRESHOLD", "Threshold", "What is dense enough is filled, with a sharp edge"),
            ("DENSITY", "As Transported", "Densities as they are, blurred"),
        ),
    )
    output: EnumProperty(name="Output", description="What a bake leaves in the scene", items=OUTPUTS)
    folder: folder_property()
    cache_format: EnumProperty(name="Format", description="Which file is written", items=CACHE_FORMATS)
    hide_inputs: BoolProperty(
        name="Hide Inputs", description="Hide the original objects when the morph is done", default=True
    )

    def blends(self, count: int, weights: Sequence[float] | None = None) -> list[Blend]:
        """Return the blends of `count` shapes that the layout asks for; raises InputError for a wrong count.

        A single blend takes the `weights`, one per shape; all alike by default.
        """
        if self.layout == "GRID":
            return grid_blends(count, self.steps)
        if self.layout == "TRIANGLE":
            return triangle_blends(count, self.steps)
        if self.layout == "BLEND":
            return single_blend([1.0] * count if weights is None else weights, count)
        return path_blends(count, self.frames, self.frame_step)

    def stored_options(self) -> dict[str, object]:
        """Return what is stored with a morph besides the settings of its solver."""
        return {name: getattr(self, name) for name in STORED_OPTIONS}

    def first_frame(self, scene: bpy.types.Scene) -> int:
        """Return the scene frame in which the morph begins."""
        if self.start == "CUSTOM":
            return self.frame_start
        return scene.frame_current if self.start == "CURRENT" else scene.frame_start

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
        for name, value in stored_arguments(stored).items():
            setattr(self, name, value)


def stored_arguments(stored: dict[str, object]) -> dict[str, object]:
    """Return what a baked morph was asked for as values of :class:`MorphProperties`; KeyError where some is missing."""
    shared = ("resolution", "level", "thickness", "parts", "locality", "thin_parts", "mend", "carry")
    found = {name: stored[name] for name in (*STORED_OPTIONS, *shared) if name in stored}
    if stored.get("flat"):
        found["flat_resolution"] = found.pop("resolution")
    for name in ("blur", "sharpness"):
        found[f"use_custom_{name}"] = stored[name] is not None
        if stored[name] is not None:
            found[name] = stored[name]
    limit = stored["entropy_limit"]
    found["entropy_limit"] = "OFF" if limit is None else "MAX" if limit == "max" else "NUMBER"
    if found["entropy_limit"] == "NUMBER":
        found["entropy_bound"] = limit
    return found
