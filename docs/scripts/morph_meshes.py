# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph two meshes without a window, and write every frame as a mesh file.

python3 run.py python docs/scripts/morph_meshes.py assets/shapes/horse.ply assets/shapes/bird.ply --out frames

The operators are the same as those of the buttons. In a script they return when all work is done.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

import convwass_addon
from convwass_addon.bridge.morphs.disk.exports import export_frames


def imported(path: Path) -> bpy.types.Object:
    """Import a PLY, OBJ or STL file; return its object."""
    kind = path.suffix.lower().lstrip(".")
    getattr(bpy.ops.wm, f"{kind}_import")(filepath=str(path.absolute()), forward_axis="Y", up_axis="Z")
    return bpy.context.object


def main() -> None:
    """Import, bake, export."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("shapes", nargs=2, type=Path)
    parser.add_argument("--frames", type=int, default=8, help="from the first shape to the second")
    parser.add_argument("--resolution", type=int, default=64, help="cells along the longest side")
    parser.add_argument("--out", type=Path, default=Path("frames"), help="a folder")
    options = parser.parse_args()

    bpy.ops.wm.read_factory_settings(use_empty=True)
    # Not needed in a Blender with the extension enabled.
    convwass_addon.register()
    names = [imported(path).name for path in options.shapes]
    bpy.ops.convwass.bake_morph(
        inputs="\n".join(names), frames=options.frames, resolution=options.resolution, scaling="EQUAL_VOLUME"
    )

    morph = next(collection for collection in bpy.data.collections if "convwass_morph" in collection)
    options.out.mkdir(exist_ok=True)
    for file in export_frames(morph, options.out / "frame.ply", "ply"):
        print(f"{file.name}: {file.stat().st_size} bytes")
    convwass_addon.unregister()


if __name__ == "__main__":
    main()
