# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer all vertex groups from an object in one .blend to an object in another by a soft map.

python3 run.py python docs/scripts/transfer_weights.py fox.blend Fox dog.blend Dog --pairs 12:40 77:301 5:9 63:118

Pairs are corresponding vertices: 12 of the first object, 40 of the second. The second file is opened, the first
object is appended temporarily, and the result is saved under a new name.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import bpy

import convwass_addon


def appended(path: Path, name: str) -> bpy.types.Object:
    """Append an object of another file to the scene."""
    with bpy.data.libraries.load(str(path.absolute()), link=False) as (_available, wanted):
        wanted.objects = [name]
    (obj,) = wanted.objects
    bpy.context.scene.collection.objects.link(obj)
    return obj


def main() -> None:
    """Open, map, transfer, save."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("source_file", type=Path)
    parser.add_argument("source")
    parser.add_argument("target_file", type=Path)
    parser.add_argument("target")
    parser.add_argument("--pairs", nargs="+", required=True, metavar="S:T")
    parser.add_argument("--vertices", type=int, default=1000, help="of the simpler meshes that the map is solved on")
    parser.add_argument("--out", type=Path, default=Path("transferred.blend"))
    options = parser.parse_args()

    convwass_addon.register()
    bpy.ops.wm.open_mainfile(filepath=str(options.target_file.absolute()))
    source, target = appended(options.source_file, options.source), bpy.data.objects[options.target]

    own = bpy.context.scene.convwass_soft_map
    own.source, own.target = source, target
    bpy.ops.convwass.compute_soft_map(pairs=", ".join(options.pairs), vertices=options.vertices)
    bpy.ops.convwass.transfer_by_map(what={"GROUPS"}, direction="FORWARD")

    # The map is stored with the source, and removed with it.
    bpy.data.objects.remove(source)
    bpy.ops.wm.save_as_mainfile(filepath=str(options.out.absolute()))
    for group in target.vertex_groups:
        members = sum(any(entry.group == group.index for entry in vertex.groups) for vertex in target.data.vertices)
        print(f"{group.name}: {members} vertices")
    convwass_addon.unregister()


if __name__ == "__main__":
    main()
