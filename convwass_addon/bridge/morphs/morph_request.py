# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake was asked for, as it is stored with every morph, whoever asked."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from ...schema import Choice, Settings, setting
from .stored import FIRST_FRAMES

DEFAULT_FOLDER = "//convwass"
"""Beside the .blend file."""


@dataclass(frozen=True)
class MorphRequest(Settings):
    """What a bake was asked for besides the settings of its solver, so that it can be asked for again.

    Attributes
    ----------
    words : str
        As :class:`.FlatSettings`, in the spelling of Blender; kept for shapes that are not flat too.
    weights : list of float or None
        Of a single blend, one per shape.
    guides : list of dict
        Points that belong together; see :class:`.morph_guides.NamedGuide`.
    at : list of float or None
        The frame numbers of a path, such as 7.35, that the blends are at where they are a sheet of such ones.
    """

    layout: str = setting(
        "PATH",
        "Layout",
        "What to make of the shapes",
        choices=(
            Choice("PATH", "Animation", "Walk through the shapes in order, one mesh per frame"),
            Choice("GRID", "Grid of Four", "Blend four shapes on a square sheet, one shape per corner"),
            Choice("TRIANGLE", "Triangle of Three", "Blend three shapes on a triangular sheet, one shape per corner"),
            Choice("BLEND", "Single Blend", "Blend all shapes into one mesh, by their weights on the list of inputs"),
        ),
        help="path: an animation through the shapes in order; grid: a sheet between four shapes; triangle: a sheet "
        "between three; blend: one blend of all, which --weights asks for too",
    )
    order: str = setting(
        "NAME",
        "Order",
        "Order of the selected shapes; those on the list of inputs have the order of the list",
        choices=(
            Choice("NAME", "By Name", "In the order of their names"),
            Choice("LEFT_TO_RIGHT", "Left to Right", "In the order of their places along the scene's X axis"),
        ),
        option=None,
    )
    grouping: str = setting(
        "OBJECTS",
        "Shapes",
        "What makes one shape",
        choices=(
            Choice("OBJECTS", "Objects", "Every object is a shape; so is an Empty that shows a collection"),
            Choice("PARENTS", "Parents", "All that hangs on one parent is a shape"),
            Choice("COLLECTIONS", "Collections", "All in one collection is a shape"),
        ),
        option=None,
    )
    reverse: bool = setting(False, "Reverse", "Turn the order around", option=None)
    alignment: str = setting(
        "PLACED",
        "Alignment",
        "How the shapes are laid onto the first one before they are morphed",
        choices=(
            Choice("PLACED", "As Placed", "Shapes travel from where one stands to where the next one stands"),
            Choice(
                "CENTERED",
                "Centered",
                "All shapes stand where the first one stands, center of mass on center of mass",
            ),
            Choice(
                "PRINCIPAL_AXES",
                "Principal Axes",
                "Centered, and turned so that long sides lie on long sides and heavy ends on heavy ends",
            ),
        ),
        option="--align",
        panel="matching",
    )
    scaling: str = setting(
        "PLACED",
        "Scale",
        "How large the shapes are",
        choices=(
            Choice("PLACED", "As Placed", "As large as in the scene; blends grow or shrink from one to the next"),
            Choice("EQUAL_VOLUME", "Equal Volume", "All shapes get the volume of the first one"),
        ),
        option="--scale",
        panel="matching",
    )
    frames: int = setting(24, "Frames", "Scene frames from each shape to the next", least=2, most=10_000, soft_most=250)
    frame_step: int = setting(
        1,
        "Step",
        "Make a mesh for every so many frames only, which shows until the next one",
        least=1,
        most=1000,
        soft_most=12,
        option=None,
    )
    start: str = setting(
        "SCENE",
        "Start",
        "Frame of the scene in which the morph begins",
        choices=(
            Choice("SCENE", "Scene Start", "At the start of the scene"),
            Choice("CURRENT", "Current Frame", "At the frame that is shown now"),
            Choice("CUSTOM", "Custom", "At a frame of your choice"),
        ),
        option=None,
    )
    frame_start: int = setting(
        1, "Start Frame", "Frame of the first shape", least=FIRST_FRAMES[0], most=FIRST_FRAMES[1], option=None
    )
    steps: int = setting(
        5, "Steps", "Blends along each side of the sheet, corners included", least=2, most=50, soft_most=12
    )
    flat_output: str = setting(
        "CURVE",
        "Flat Frames",
        "What frames of flat shapes are",
        choices=(
            Choice("CURVE", "Curves", "Curve objects with the bevel, the extrusion and the fill of the shapes"),
            Choice("MESH", "Meshes", "Meshes, filled, beveled and extruded as the curves would be"),
            Choice("DRAWING", "Drawings", "One Grease Pencil object with a filled drawing on a keyframe per frame"),
            Choice(
                "PICTURE",
                "Pictures",
                "A sequence of image files, and a plane that shows it; of images, grays travel too",
            ),
        ),
        help="flat shapes: an object per frame is a curve with bevel and extrusion, or a mesh; or all frames are the "
        "drawings of one Grease Pencil object, or a sequence of PNG files beside the .blend and a plane that shows it; "
        "anything else than objects, --render and --export take meshes",
    )
    faces: str = setting(
        "TRIANGLES",
        "Faces",
        "What the meshes of blends are made of",
        choices=(
            Choice("TRIANGLES", "Triangles", "Triangles of even size"),
            Choice("QUADS", "Quads", "Quads, and triangles where fine detail leaves some over; to sculpt or subdivide"),
        ),
    )
    grays: str = setting(
        "IMAGES",
        "Grays",
        "How pictures are made of what the transport leaves blurred",
        choices=(
            Choice(
                "IMAGES", "As in the Images", "Pixels get the grays of the images, from the darkest to the brightest"
            ),
            Choice("THRESHOLD", "Threshold", "What is dense enough is filled, with a sharp edge"),
            Choice("DENSITY", "As Transported", "Densities as they are, blurred"),
        ),
    )
    output: str = setting(
        "OBJECTS",
        "Output",
        "What a bake leaves in the scene",
        choices=(
            Choice("OBJECTS", "Objects", "One mesh object per frame, each visible in its frame alone"),
            Choice(
                "PLAYER",
                "Player",
                "One object with a value to animate that chooses the mesh; for a sheet, a pad to drag on",
            ),
            Choice("VOLUME", "Volume", "VDB files, and a mesh made of them whose level and smoothing stay editable"),
            Choice("CACHE", "Cache", "An Alembic or USD file, and one object that reads it"),
            Choice(
                "SHAPE_KEYS",
                "Shape Keys",
                "The mesh of the first shape, with shape keys that lead to the others; for shapes of one build",
            ),
        ),
        option=None,
    )
    between: str = setting(
        "INTERPOLATED",
        "In Between",
        "What a player or a pad shows between two baked blends",
        choices=(
            Choice(
                "INTERPOLATED",
                "Interpolated",
                "The exact moment: blends are mixed at any value, in slow motion and on subframes; of flat shapes the "
                "nearest blend",
            ),
            Choice("NEAREST", "Nearest Blend", "The nearer one, exactly as it was baked; plays faster"),
        ),
    )
    key_error: float = setting(
        0.5,
        "Key Error",
        "How far vertices may leave their path between two shape keys, in percent of the size; less takes more keys",
        least=0.01,
        most=10.0,
        unit="percent",
    )
    folder: str = setting(
        DEFAULT_FOLDER,
        "Folder",
        "Where the files go, in a folder named after the morph; // is the folder of the .blend file",
        subtype="DIR_PATH",
        option=None,
    )
    cache_format: str = setting(
        "alembic",
        "Format",
        "Which file is written",
        choices=(
            Choice("alembic", "Alembic", "One .abc file, which most programs read", identifier="alembic"),
            Choice("usd", "USD", "One .usdc file", identifier="usd"),
        ),
        option=None,
    )
    words: str = "MASS"
    weights: list[float] | None = None
    guides: list[dict[str, object]] = field(default_factory=list)
    at: list[float] | None = None

    def blends(self, count: int) -> list[Blend]:
        """Return the blends of `count` shapes that the layout asks for; raises InputError for a wrong count.

        A single blend takes the weights; all alike where there are none.
        """
        if self.layout == "GRID":
            return grid_blends(count, self.steps)
        if self.layout == "TRIANGLE":
            return triangle_blends(count, self.steps)
        if self.layout == "BLEND":
            return single_blend([1.0] * count if self.weights is None else self.weights, count)
        return path_blends(count, self.frames, self.frame_step)
