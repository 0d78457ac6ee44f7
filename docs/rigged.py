# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a rigged character with a texture that morphs on its own mesh, docs/pictures/rigged.jpg.

``python3 run.py python docs/rigged.py``. ``--glb FILE`` also exports it for other programs.
"""

from __future__ import annotations

import argparse
import math
import sys
from pathlib import Path

import bpy
from characters import STANDING, body_object, character, striped, turn
from photographs import row_picture
from PIL import Image

import convwass_addon
from convwass_addon.bridge.studio.framing import View

# Unlike the add-on, the benchmarks are not installed.
sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from benchmarks.bipeds import MAN, OGRE, biped

PICTURE = Path(__file__).resolve().parent / "pictures" / "rigged.jpg"
SLIDER = (0.0, 0.25, 0.5, 0.75, 1.0)

# Distance of the figures, the picture of a row in pixels, light paths per pixel, per cent of JPEG.
_STEP, _ROW, _SAMPLES, _QUALITY = 1.9, (1500, 390), 24, 88
_VIEW = View(math.radians(-72.0), math.radians(8.0))
# Rotations of bones for the second row, from the root on: axis in the scene, and degrees.
_WAVING = (
    ("spine", "Y", 7.0),
    ("upper_arm.R", "Y", -85.0),
    ("forearm.R", "Y", -50.0),
    ("upper_arm.L", "X", -30.0),
    ("forearm.L", "X", -35.0),
    ("thigh.L", "X", -30.0),
    ("shin.L", "X", 35.0),
    ("thigh.R", "X", 15.0),
)


def main() -> None:
    """Make the character, bake its shape keys, and draw it at rest and posed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--glb", type=Path, help="also write the mesh with keys and armature to this file")
    options = parser.parse_args()
    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    man, ogre = biped(MAN, STANDING, 5), biped(OGRE, STANDING, 6)
    body_object("Ogre", ogre.sculpture.mesh())
    rig = character("Man", man, striped).rig
    bpy.ops.convwass.bake_morph(inputs="Man,Ogre", output="SHAPE_KEYS", frames=24)
    obj = bpy.data.objects["Man Morph"]
    obj.animation_data.action = None
    rows = [_row(obj)]
    for name, axis, angle in _WAVING:
        turn(rig.pose.bones[name], axis, angle)
    rows.append(_row(obj))
    if options.glb:
        _export(obj, options.glb)
    whole = Image.new("RGB", (rows[0].width, sum(row.height for row in rows)))
    for number, row in enumerate(rows):
        whole.paste(row, (0, number * row.height))
    whole.save(PICTURE, quality=_QUALITY)
    print(f"{PICTURE.name}: {PICTURE.stat().st_size / 1e3:.0f} kB")


def _row(obj: bpy.types.Object) -> Image.Image:
    """Render the character at some values of its slider, side by side."""
    graph, shown = bpy.context.evaluated_depsgraph_get(), []
    for value in SLIDER:
        obj["Ogre"] = value
        obj.update_tag()
        graph.update()
        mesh = bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph)
        shown.append(bpy.data.objects.new("Figure", mesh))
    return row_picture(shown, _VIEW, _STEP, _ROW, _SAMPLES)


def _export(obj: bpy.types.Object, target: Path) -> None:
    """Animate the slider and write a file for other programs."""
    from convwass_addon.bridge.one_mesh.key_files import export_shape_keys

    for frame, value in ((1, 0.0), (25, 1.0)):
        obj["Ogre"] = value
        obj.keyframe_insert('["Ogre"]', frame=frame)
    export_shape_keys(obj, target)


if __name__ == "__main__":
    main()
