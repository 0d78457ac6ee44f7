# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings that the panel shows and the operators take, and the state of running work."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from .applications.flat.flat_settings import FlatSettings
from .applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from .applications.morphs.morph_settings import MorphSettings
from .bridge.flat.flat_objects import is_shape
from .bridge.morphs.stored import FIRST_FRAMES

OUTPUTS = (
    ("OBJECTS", "Objects", "One mesh object per frame, each visible in its frame alone"),
    ("PLAYER", "Player", "One object with a value to animate that chooses the mesh; for a sheet, a pad to drag on"),
    (
        "VOLUME",
        "Volume",
        "VDB files beside the .blend, and a mesh made of them whose level and smoothing stay editable",
    ),
    ("CACHE", "Cache", "An Alembic file beside the .blend, and one object that reads it"),
)
"""What a bake makes, as items of an enum."""

CACHE_FORMATS = (
    ("alembic", "Alembic", "One .abc file, which most programs read"),
    ("usd", "USD", "One .usdc file"),
)
"""Files that a morph can be cached in, as items of an enum."""

DEFAULT_FOLDER = "//convwass"
"""Beside the .blend file."""

VERDICTS = (
    ("UNCHECKED", "Not Checked", "Nobody has looked at this shape yet"),
    ("SOUND", "Sound", "The shape is closed and its faces look outward"),
    ("FLIPPED", "Flipped Faces", "Some faces look the wrong way; they are turned over for the morph"),
    ("HOLES", "Holes", "The surface is open; what it nearly encloses is taken for its inside"),
    ("NO_VOLUME", "No Volume", "The shape encloses nothing that could be moved, unless it is given thickness"),
    ("UNUSABLE", "Unusable", "The shape cannot be read"),
)
"""What a check found out about an input, as items of an enum; from the third one on there is a warning."""

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


class MorphProperties:
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
    resolution: IntProperty(
        name="Resolution",
        description="Cells along the longest side of the volume; twice as many take about ten times as long and keep "
        "parts that are half as thin",
        default=64,
        min=16,
        soft_max=160,
        max=512,
    )
    flat_resolution: IntProperty(
        name="Resolution",
        description="Cells along the longest side of flat shapes; twice as many take about four times as long and keep "
        "strokes that are half as wide",
        default=512,
        min=256,
        max=1024,
    )
    words: EnumProperty(
        name="Words",
        description="How texts and other shapes of several parts travel, where all shapes are flat",
        items=(
            ("MASS", "As One Mass", "All that a shape fills travels together"),
            ("LETTERS", "Letter by Letter", "Letters travel to letters in reading order"),
        ),
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
                "A sequence of image files beside the .blend, and a plane that shows it; of images, grays travel too",
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
    carry: BoolProperty(
        name="Carry Looks",
        description="Let blends carry the colors, materials and vertex groups of the shapes, and the velocity for "
        "motion blur",
        default=True,
    )
    output: EnumProperty(name="Output", description="What a bake leaves in the scene", items=OUTPUTS)
    folder: StringProperty(
        name="Folder",
        description="Where the files go, in a folder named after the morph; // is the folder of the .blend file",
        default=DEFAULT_FOLDER,
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
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
            carry=self.carry,
        )

    def flat_settings(self) -> FlatSettings:
        """Return the settings of the application where all shapes are flat; raises InputError as above."""
        shared = self.solver_settings().as_dict()
        own = {"resolution": self.flat_resolution, "words": self.words.lower(), "parts": "none"}
        return FlatSettings(**{**shared, **own})

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


def _is_shape(_item: CONVWASS_PG_input, obj: bpy.types.Object) -> bool:
    return is_shape(obj)


class CONVWASS_PG_input(bpy.types.PropertyGroup):
    """A shape on the list of inputs."""

    object: PointerProperty(
        name="Shape",
        description="Object that takes part in the morph: a mesh, a text, a curve, a drawing or an image",
        type=bpy.types.Object,
        poll=_is_shape,
    )
    weight: FloatProperty(
        name="Weight",
        description="Share of this shape in a single blend, compared with those of the others",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this shape takes part in the morph", default=True)
    verdict: EnumProperty(name="Check", description="What the last check found out", items=VERDICTS)
    finding: StringProperty(name="Finding", description="What the last check found out, in a sentence")

    @property
    def warns(self) -> bool:
        """Whether the last check found something wrong."""
        return self.verdict not in ("UNCHECKED", "SOUND")


class CONVWASS_PG_morph(MorphProperties, bpy.types.PropertyGroup):
    """Morph settings of a scene."""

    inputs: CollectionProperty(
        name="Inputs",
        description="Shapes to morph, in this order; while there are none, those that are selected are morphed",
        type=CONVWASS_PG_input,
    )
    active_input: IntProperty(name="Active Input", description="The input that buttons beside the list act on", min=0)

    def take_inputs(self, objects: Sequence[bpy.types.Object], weights: Sequence[float] | None = None) -> None:
        """Put shapes on the list, unless selecting them says as much: then empty it."""
        self.inputs.clear()
        self.active_input = 0
        if weights is None and self.sorted_shapes(list(objects)) == list(objects):
            return
        for index, obj in enumerate(objects):
            item = self.inputs.add()
            item.object = obj
            item.weight = 1.0 if weights is None else weights[index]

    @property
    def enabled_inputs(self) -> list[CONVWASS_PG_input]:
        """The inputs on the list that take part."""
        return [item for item in self.inputs if item.enabled]


class CONVWASS_PG_progress(bpy.types.PropertyGroup):
    """The work that is going on in this window manager, if any."""

    running: BoolProperty(name="Running", description="Whether something is being computed")
    fraction: FloatProperty(name="Progress", description="Share of the work that is done", min=0.0, max=1.0)
    message: StringProperty(name="Message", description="What is being done")
    stopping: BoolProperty(name="Stopping", description="Whether the work has been asked to stop")


_classes = (CONVWASS_PG_input, CONVWASS_PG_morph, CONVWASS_PG_progress)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings to scenes and the progress to the window manager."""
    _register_classes()
    bpy.types.Scene.convwass_morph = PointerProperty(type=CONVWASS_PG_morph)
    bpy.types.WindowManager.convwass_progress = PointerProperty(type=CONVWASS_PG_progress)
    # Values outlive the add-on, and what was running then runs no more.
    progress = bpy.context.window_manager.convwass_progress
    progress.running = progress.stopping = False


def unregister() -> None:
    """Take both away."""
    del bpy.types.WindowManager.convwass_progress
    del bpy.types.Scene.convwass_morph
    _unregister_classes()
