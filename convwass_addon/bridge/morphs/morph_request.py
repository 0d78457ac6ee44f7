# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of a bake that are stored with every morph, besides those of its solver."""

from __future__ import annotations

from dataclasses import dataclass, field

from ...applications.morphs.layouts import Blend, grid_blends, path_blends, single_blend, triangle_blends
from ...errors import InputError
from ...schema import Choice, Settings, setting
from ...sentence import Sentence
from .stored import FIRST_FRAMES

DEFAULT_FOLDER = "//convwass"
"""Next to the .blend file."""


@dataclass(frozen=True)
class MorphRequest(Settings):
    """Settings of a bake besides those of its solver, with which it can be repeated.

    Attributes
    ----------
    words : str
        As in :class:`.FlatSettings`, in Blender's spelling; also stored for solid shapes.
    weights : list of float or None
        Weights of a single blend, one per shape.
    guides : list of dict
        Corresponding points; see :class:`.morph_guides.NamedGuide`.
    at : list of float or None
        Fractional frame numbers of a path, such as 7.35, if the morph is a sheet of such blends.
    """

    layout: str = setting(
        "PATH",
        "Layout",
        "The kind of morph to make; not used for shape keys",
        choices=(
            Choice("PATH", "Animation", "Morph the shapes one after another, with one mesh per frame"),
            Choice("GRID", "Grid of Four", "Blend four shapes on a square sheet, with one shape per corner"),
            Choice(
                "TRIANGLE", "Triangle of Three", "Blend three shapes on a triangular sheet, with one shape per corner"
            ),
            Choice("BLEND", "Single Blend", "Blend all shapes into one mesh, with their weights on the input list"),
        ),
        help="path: an animation through the shapes in order; grid: a sheet of four shapes; triangle: a sheet of "
        "three shapes; blend: a single blend of all shapes, implied by --weights",
    )
    order: str = setting(
        "NAME",
        "Order",
        "Order of the selected shapes; the input list has its own order",
        choices=(
            Choice("NAME", "By Name", "Sorted by name"),
            Choice("LEFT_TO_RIGHT", "Left to Right", "Sorted by position along the scene's X axis"),
        ),
        option=None,
    )
    grouping: str = setting(
        "OBJECTS",
        "Shapes",
        "What counts as one shape",
        choices=(
            Choice("OBJECTS", "Objects", "Every object is a shape; so is an Empty that shows a collection"),
            Choice("PARENTS", "Parents", "An object and all its children are a shape"),
            Choice("COLLECTIONS", "Collections", "All objects of a collection are a shape"),
        ),
        option=None,
    )
    reverse: bool = setting(False, "Reverse", "Reverse the order", option=None)
    follow: str = setting(
        "BAKE_FRAME",
        "Inputs",
        "How animated shapes are used",
        choices=(
            Choice("BAKE_FRAME", "At Bake Frame", "In their state at the current frame"),
            Choice(
                "FOLLOW", "Follow Animation", "Every blend uses the shapes of its own frame; the ends stay animated"
            ),
        ),
        flag="FOLLOW",
        help="every blend uses animated shapes as they are in its own frame, and the ends stay animated; for shapes of "
        ".blend files",
    )
    alignment: str = setting(
        "PLACED",
        "Alignment",
        "How the shapes are aligned with the first one before the morph",
        choices=(
            Choice("PLACED", "As Placed", "Shapes move from their own position to that of the next one"),
            Choice(
                "CENTERED",
                "Centered",
                "All shapes are moved to the center of mass of the first one",
            ),
            Choice(
                "PRINCIPAL_AXES",
                "Principal Axes",
                "Centered, and rotated so that the principal axes match, with the heavy ends on the same side",
            ),
        ),
        option="--align",
        panel="matching",
    )
    scaling: str = setting(
        "PLACED",
        "Scale",
        "Size of the shapes",
        choices=(
            Choice("PLACED", "As Placed", "As in the scene; blends grow or shrink in between"),
            Choice("EQUAL_VOLUME", "Equal Volume", "All shapes are scaled to the volume of the first one"),
        ),
        option="--scale",
        panel="matching",
    )
    frames: int = setting(
        24, "Frames", "Number of scene frames between two shapes", least=2, most=10_000, soft_most=250
    )
    frame_step: int = setting(
        1,
        "Step",
        "Make a mesh only for every n-th frame, which is shown until the next one",
        least=1,
        most=1000,
        soft_most=12,
        option=None,
    )
    start: str = setting(
        "SCENE",
        "Start",
        "Scene frame at which the morph starts",
        choices=(
            Choice("SCENE", "Scene Start", "The first frame of the scene"),
            Choice("CURRENT", "Current Frame", "The current frame"),
            Choice("CUSTOM", "Custom", "A given frame"),
        ),
        option=None,
    )
    frame_start: int = setting(
        1, "Start Frame", "Frame of the first shape", least=FIRST_FRAMES[0], most=FIRST_FRAMES[1], option=None
    )
    steps: int = setting(
        5,
        "Steps",
        "Number of blends along each side of the sheet, including the corners",
        least=2,
        most=50,
        soft_most=12,
    )
    flat_output: str = setting(
        "CURVE",
        "Flat Frames",
        "Object type of flat frames",
        choices=(
            Choice("CURVE", "Curves", "Curve objects with the bevel, extrusion and fill of the shapes"),
            Choice("MESH", "Meshes", "Meshes with fill, bevel and extrusion"),
            Choice("DRAWING", "Drawings", "One Grease Pencil object with a filled drawing per frame"),
            Choice(
                "PICTURE",
                "Pictures",
                "A sequence of image files, and a plane that shows it; images are morphed with their shades of gray",
            ),
        ),
        help="flat shapes: one curve or mesh object per frame, one Grease Pencil object with a drawing per frame, or "
        "a sequence of PNG files next to the .blend with a plane that shows it; other outputs, --render and "
        "--export require meshes",
    )
    faces: str = setting(
        "TRIANGLES",
        "Faces",
        "Faces of the blended meshes",
        choices=(
            Choice("TRIANGLES", "Triangles", "Triangles of similar size"),
            Choice("QUADS", "Quads", "Quads, with some triangles at fine details; for sculpting or subdivision"),
        ),
    )
    looks: str = setting(
        "FADE",
        "Looks",
        "How frames show the materials of the shapes; needs Carry Attributes",
        choices=(
            Choice("FADE", "Fade", "Whole materials with all textures; one fades into the other"),
            Choice("FRONT", "Front", "Whole materials; one takes over from the other from below"),
            Choice("PATCHES", "Patches", "Whole materials; one grows on the other from patches"),
            Choice("COLORS", "Colors", "Colors of vertices and values of the shaders only; smaller and faster"),
        ),
    )
    grays: str = setting(
        "IMAGES",
        "Grays",
        "Treatment of the blur that the transport adds to pictures",
        choices=(
            Choice("IMAGES", "As in the Images", "Match the distribution of grays in the images"),
            Choice("THRESHOLD", "Threshold", "Fill everything above a threshold, with sharp edges"),
            Choice("DENSITY", "As Transported", "Show the blurred densities unchanged"),
        ),
    )
    output: str = setting(
        "OBJECTS",
        "Output",
        "Result of the bake in the scene",
        choices=(
            Choice("OBJECTS", "Objects", "One mesh object per frame, visible only in its frame"),
            Choice(
                "PLAYER",
                "Player",
                "One object with an animatable value that selects the mesh; for a sheet, a pad to drag on",
            ),
            Choice("VOLUME", "Volume", "VDB files, and a mesh made from them with adjustable level and smoothing"),
            Choice("CACHE", "Cache", "An Alembic or USD file, and one object that reads it"),
            Choice(
                "SHAPE_KEYS",
                "Shape Keys",
                "The mesh of the first shape, with shape keys to the other shapes; for shapes of similar build",
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
    basis: str = setting(
        "FIRST",
        "Basis",
        "The mesh that gets the shape keys",
        choices=(
            Choice("FIRST", "First Mesh", "The mesh of the first shape, with everything it has"),
            Choice("EVEN", "Even", "A new mesh of the first shape: triangles as large as a cell of the resolution"),
            Choice("ADAPTIVE", "Adaptive", "The same, with smaller triangles where the shape is curved"),
            Choice("QUADS", "Quads", "The same as quads of even size"),
        ),
        help="shape keys: the first mesh itself, or a new mesh of the first shape with --resolution cells along its "
        "longest side",
    )
    key_error: float = setting(
        0.5,
        "Key Error",
        "Largest error of vertex paths between two shape keys, in percent of the size; smaller values need more keys",
        least=0.01,
        most=10.0,
        unit="percent",
    )
    symmetric: bool = setting(
        False,
        "Symmetric",
        "Keys are symmetric across the local X axis of the first mesh, which must be symmetric itself",
        help="shape keys: keys are symmetric across the local X axis of the first mesh",
    )
    two_meshes: bool = setting(
        False,
        "Two Meshes",
        "For two shapes of any kind: the mesh of each follows the morph, and one replaces the other where both look "
        "alike",
        help="shape keys: the meshes of two shapes of any kind follow the morph, and one replaces the other on the way",
    )
    folder: str = setting(
        DEFAULT_FOLDER,
        "Folder",
        "Parent folder of the files, which are in a folder named after the morph; // is the folder of the .blend file",
        subtype="DIR_PATH",
        option=None,
    )
    cache_format: str = setting(
        "alembic",
        "Format",
        "File format of the cache",
        choices=(
            Choice("alembic", "Alembic", "One .abc file, which most programs can read", identifier="alembic"),
            Choice("usd", "USD", "One .usdc file", identifier="usd"),
        ),
        option=None,
    )
    words: str = "MASS"
    weights: list[float] | None = None
    guides: list[dict[str, object]] = field(default_factory=list)
    at: list[float] | None = None

    def check_output(self) -> None:
        """Raise InputError if a morph in this layout cannot have the requested output."""
        if self.layout == "BLEND" and self.output == "PLAYER":
            raise InputError(
                "A single blend is one mesh, so there is nothing to play; choose another layout or output."
            )
        if self.layout != "PATH" and self.output == "CACHE":
            raise InputError("A cache requires an animation; choose another layout or output.")

    @property
    def output_problem(self) -> Sentence | None:
        """The message of `check_output`, or None."""
        try:
            self.check_output()
        except InputError as error:
            return error.sentence
        return None

    def blends(self, count: int) -> list[Blend]:
        """Return the blends of `count` shapes in this layout; raises InputError if the count does not suit it.

        A single blend uses the weights; equal weights if there are none.
        """
        if self.layout == "GRID":
            return grid_blends(count, self.steps)
        if self.layout == "TRIANGLE":
            return triangle_blends(count, self.steps)
        if self.layout == "BLEND":
            return single_blend([1.0] * count if self.weights is None else self.weights, count)
        return path_blends(count, self.frames, self.frame_step)
