# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The command ``demo``."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from pathlib import Path

from ..applications.morphs.layouts import path_blends
from ..applications.morphs.morph_settings import MorphSettings
from ..bridge.files.blend_files import open_empty
from ..bridge.files.imports import import_objects
from ..bridge.files.output_paths import save_blend
from ..errors import InputError
from .answer import Answer
from .argument_types import WORKERS
from .demo_moss import save_moss
from .morph_baking import FEW_SAMPLES, baked, rendered, report
from .morph_choices import Computing

DEMO_HELP = """Morph a horse into a cow. Writes morph.blend with a picture and an animation, and moss.blend, in which
moss grows over one of the shapes."""

_DEMO_SHAPES = ("horse", "cow")


def add_demo_options(parser: ArgumentParser) -> None:
    """Add the options to the parser."""
    parser.add_argument("--out", type=Path, default=Path("out"), help="output folder (%(default)s)")
    parser.add_argument("--frames", type=int, default=24, help="frames from each shape to the next (%(default)s)")
    parser.add_argument("--resolution", type=int, default=80, help="cells along the longest side (%(default)s)")
    parser.add_argument("--workers", **WORKERS)
    parser.add_argument("--json", action="store_true", help="print the records of the solver as JSON")


def run_demo(options: Namespace) -> Answer:
    """Morph the sample shapes of the project and render them.

    Raises
    ------
    InputError
        The shapes are missing.
    """
    folder = Path(__file__).resolve().parents[2] / "assets" / "shapes"
    if not folder.is_dir():
        raise InputError("The sample shapes are part of the project's source, not of the installed add-on.")
    blends = path_blends(len(_DEMO_SHAPES), options.frames)
    settings = MorphSettings(resolution=options.resolution)
    options.out.mkdir(parents=True, exist_ok=True)
    open_empty()
    inputs = [obj for name in _DEMO_SHAPES for obj in import_objects(folder / f"{name}.ply", None)]
    for obj in inputs:
        obj.data.shade_smooth()
    stored = {"layout": "PATH", "frames": options.frames}
    collection, records = baked(inputs, blends, settings, stored, Computing(options.workers))
    target = save_blend(options.out / "morph.blend")
    sheet, movie = rendered(collection, target, True, FEW_SAMPLES)
    # Saving the moss starts an empty scene.
    name = collection.name
    moss = save_moss(folder / f"{_DEMO_SHAPES[0]}.ply", options.out / "moss.blend")
    print(
        f"\nThe morph     {target}\n              open it in Blender and press Space to play it"
        f"\nIts pictures  {sheet}\nIts movie     {movie}"
        f"\nA density     {moss}\n              moss grows over a horse; press Space in Material Preview"
        "\nTo try next   python3 run.py package, install the zip from dist in Blender, select two meshes,"
        "\n              and press Live Morph in the sidebar's tab Convwass",
        file=sys.stderr,
    )
    return report(name, settings, records, [target, sheet, movie, moss])
