# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw morphs of solids, as Figs. 1, 7 and 14: ``python3 run.py python docs/solids.py [path] [triangle] [grid]``.

Writes docs/pictures/solids_path.jpg, a cow that becomes a bird that becomes a double torus, solids_triangle.jpg, blends
of the three, and solids_grid.jpg, blends of four shapes, one of them in two parts.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import bpy
from PIL import Image

import convwass_addon
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.morphs.pictures.contact_sheet import render_contact_sheet
from convwass_addon.progress import drained

PROJECT = Path(__file__).resolve().parents[1]
PICTURES = PROJECT / "docs" / "pictures"
# Colors of the shapes in order, scene linear.
_COLORS = ((0.50, 0.10, 0.04, 1.0), (0.03, 0.16, 0.42, 1.0), (0.70, 0.32, 0.03, 1.0), (0.06, 0.26, 0.12, 1.0))


@dataclass(frozen=True)
class Sheet:
    """A morph and its picture.

    Attributes
    ----------
    shapes : tuple of str
        Names of sample shapes, in the order of the layout.
    baking : dict
        Arguments of `bake_morph`.
    columns, width : int
        Shapes per row of the picture, for a path, and its width in pixels.
    """

    shapes: tuple[str, ...]
    baking: dict[str, object]
    columns: int
    width: int


SHEETS = {
    "path": Sheet(("cow", "bird", "double_torus"), {"layout": "PATH", "frames": 4}, 9, 2000),
    "triangle": Sheet(("cow", "bird", "double_torus"), {"layout": "TRIANGLE", "steps": 6}, 6, 1500),
    "grid": Sheet(("horse", "double_torus", "dolphins", "bird"), {"layout": "GRID", "steps": 5}, 5, 1500),
}


def main() -> None:
    """Draw the requested pictures, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help="path, triangle, grid; all by default")
    parser.add_argument("--resolution", type=int, default=100, help="cells along the longest side (%(default)s)")
    parser.add_argument("--folder", type=Path, default=PICTURES, help="where to write them")
    options = parser.parse_args()
    for name in options.names or SHEETS:
        _draw(SHEETS[name], options.resolution, options.folder / f"solids_{name}.jpg")


def _draw(sheet: Sheet, resolution: int, target: Path) -> None:
    """Bake a morph like the button in the sidebar, and render all frames."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    try:
        for number, name in enumerate(sheet.shapes):
            _shape(name, number)
        bpy.ops.convwass.bake_morph(order="NAME", motion="TRANSPORT", resolution=resolution, **sheet.baking)
        morph = next(collection for collection in bpy.data.collections if collection.name.startswith("Morph"))
        with TemporaryDirectory() as folder:
            png = Path(folder) / "sheet.png"
            drained(render_contact_sheet(morph, png, columns=sheet.columns, width=sheet.width))
            with Image.open(png) as picture:
                picture.convert("RGB").save(target, quality=87, optimize=True, progressive=True)
    finally:
        convwass_addon.unregister()


def _shape(name: str, number: int) -> None:
    """Import a sample shape, shade it smooth, and color it."""
    (obj,) = import_objects(PROJECT / "assets" / "shapes" / f"{name}.ply", None)
    obj.name, obj.color = f"{number} {name}", _COLORS[number]
    modifier = obj.modifiers.new("Finer", "SUBSURF")
    modifier.levels = 1
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    bpy.ops.object.modifier_apply(modifier=modifier.name)
    obj.data.shade_smooth()


if __name__ == "__main__":
    main()
