# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The options of the verb ``morph``."""

from __future__ import annotations

from argparse import ArgumentParser
from pathlib import Path

from ..bridge.morphs.outputs import ON_DISK, PACKED
from .argument_types import WORKERS, entropy_limit, frame_range, numbers
from .morph_choices import suffixes

MORPH_HELP = """Morph shapes of any topology into each other by optimal transport and save the result as a .blend.

A shape is a file that Blender reads (OBJ, PLY, STL, glTF, FBX, USD, Alembic), or an object in a .blend, written
file.blend:Object. It may be open, in several parts, self-intersecting or inside out.

Shapes may also be flat, if all of them are: text:WORD, an SVG file, an image whose silhouette is taken (PNG, JPEG,
TIFF, BMP, WebP), or a text, a curve, a drawing, an image empty or a flat mesh in a .blend. Frames are curves then.

examples:
  morph cow.obj duck.ply torus.stl --frames 24 --resolution 100 --out morph.blend --render
  morph scene.blend:Cube scene.blend:Suzanne --frames 48
  morph text:A text:B logo.svg --frames 24 --scale equal-volume --out letters.blend
  morph text:SPRING text:AUTUMN --words letters
  morph a.obj b.obj c.obj d.obj --layout grid --steps 5 --out sheet.blend --render
  morph a.obj b.obj c.obj --weights 0.2,0.3,0.5 --export blend.ply
  morph a.obj b.obj --frames 240 --cache /shared/frames --frames-range 0-119
  morph a.obj b.obj --frames 240 --cache /shared/frames --scheduler tcp://192.168.1.10:8786
  morph a.obj b.obj --frames 24 --cache frames --at 7.35,8.5 --out between.blend

"""


def add_morph_options(parser: ArgumentParser) -> None:
    """Add all of them."""
    parser.add_argument(
        "shapes", nargs="+", metavar="SHAPE", help="a file, file.blend:Object, or text:WORD; two or more, in order"
    )
    parser.add_argument("--out", type=Path, default=Path("morph.blend"), help="the .blend to write (%(default)s)")
    _add_layout_options(parser)
    _add_solver_options(parser)
    _add_computing_options(parser)
    _add_output_options(parser)


def _add_layout_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is made")
    layouts = ("path", "grid", "triangle")
    group.add_argument(
        "--layout",
        choices=layouts,
        default="path",
        help="path: an animation through the shapes in order (default); grid: a sheet between four shapes; triangle: a "
        "sheet between three",
    )
    group.add_argument("--frames", type=int, default=24, help="path: frames from each shape to the next (%(default)s)")
    group.add_argument("--steps", type=int, default=5, help="grid, triangle: blends along each side (%(default)s)")
    group.add_argument(
        "--align",
        choices=("placed", "centered", "principal-axes"),
        default="placed",
        help="lay the shapes onto the first one: center on center, or also long side on long side (%(default)s)",
    )
    group.add_argument(
        "--scale",
        choices=("placed", "equal-volume"),
        default="placed",
        help="leave the sizes of the shapes, or give all the volume of the first one (%(default)s)",
    )
    group.add_argument("--weights", type=numbers, help="one blend instead, such as 0.2,0.3,0.5: one number per shape")
    group.add_argument(
        "--at",
        type=numbers,
        metavar="NUMBERS",
        help="path: a sheet of the blends at these frame numbers instead, such as 7.35,8.5; they start from the frames "
        "about them in --cache, where those that are missing are put first",
    )


def _add_solver_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("how it is made")
    group.add_argument(
        "--resolution", type=int, help="cells along the longest side: of the volume (100), or of flat shapes (512)"
    )
    group.add_argument(
        "--sharpness",
        type=float,
        help="0: the barycenter of the paper, smooth; 1: debiased, crisp, may tear (0.75, rising to 1 at the shapes)",
    )
    group.add_argument("--blur", type=float, help="blur in cells (1, or an eightieth of the resolution)")
    group.add_argument(
        "--entropy-limit",
        type=entropy_limit,
        metavar="max|NUMBER|off",
        help="keep blends from spreading more than the shapes (max) or than a number of nats (off)",
    )
    group.add_argument(
        "--level",
        choices=("volume", "half-max"),
        default="volume",
        help="take the surface where it encloses the interpolated volume (default), or at half of the maximum",
    )
    group.add_argument(
        "--thickness", type=float, default=0.0, help="thickness for shapes without volume, such as planes (none)"
    )
    group.add_argument(
        "--locality",
        type=float,
        default=0.0,
        help="0: all mass travels; up to 1: parts shrink here and grow there instead of going far (%(default)s)",
    )
    group.add_argument(
        "--no-thin-parts",
        action="store_true",
        help="take one level for thick and thin parts; thin ones get thinner or vanish",
    )
    group.add_argument(
        "--no-mend", action="store_true", help="leave crumbs, gaps and handles that the shapes do not have as they come"
    )
    group.add_argument(
        "--no-carry",
        action="store_true",
        help="leave out the colors of the shapes, their vertex groups and the velocity, which blends carry along",
    )
    group.add_argument(
        "--parts",
        choices=("none", "vertex-groups", "materials"),
        default="none",
        help="parts of the same name on all shapes travel together: head to head (%(default)s)",
    )
    group.add_argument(
        "--words",
        choices=("mass", "letters"),
        default="mass",
        help="flat shapes: all of a shape travels together, or letter by letter in reading order (%(default)s)",
    )
    group.add_argument(
        "--tolerance",
        type=float,
        help="marginal error at which a blend is done (automatic: 0.01, down to 0.002 with a sharpness of 1)",
    )


def _add_computing_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("where it is computed")
    group.add_argument("--workers", **WORKERS)
    group.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="compute frames on the workers of a Dask cluster instead, such as tcp://HOST:8786",
    )
    group.add_argument(
        "--cache",
        type=Path,
        metavar="FOLDER",
        help="keep finished frames there, and compute only those that are missing; several machines may share it",
    )
    group.add_argument(
        "--frames-range",
        type=frame_range,
        metavar="A-B",
        help="path: only put these frames into the cache and write no .blend; the first shape is frame 0",
    )


def _add_output_options(parser: ArgumentParser) -> None:
    group = parser.add_argument_group("what is written")
    group.add_argument(
        "--output",
        choices=[*PACKED, *ON_DISK],
        default="objects",
        help="what shows the morph in the .blend: an object per frame, one player object, a pad to drag on (a sheet), "
        "or files beside it that are read as VDB volumes, Alembic or USD (%(default)s)",
    )
    group.add_argument(
        "--flat-output",
        choices=("curve", "mesh", "drawing", "picture"),
        default="curve",
        help="flat shapes: an object per frame is a curve with bevel and extrusion, or a mesh; or all frames are the "
        "drawings of one Grease Pencil object, or a sequence of PNG files beside the .blend and a plane that shows it; "
        "anything else than objects, --render and --export take meshes (%(default)s)",
    )
    group.add_argument(
        "--grays",
        choices=("images", "threshold", "density"),
        default="images",
        help="pictures: pixels get the grays of the images, or are full or empty, or stay as blurred as they come "
        "(%(default)s)",
    )
    group.add_argument(
        "--render",
        action="store_true",
        help="also render a picture of the sequence and, for a path, an animation, beside the .blend",
    )
    group.add_argument(
        "--export",
        type=Path,
        metavar="FILE",
        help="also write the meshes for other programs; the ending says how: " + ", ".join(suffixes()),
    )
    group.add_argument("--json", action="store_true", help="print the records of the solver as JSON")
