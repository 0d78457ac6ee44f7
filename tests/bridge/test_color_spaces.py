# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Another OpenColorIO configuration than Blender's own, as studios use it, in a Blender that starts with it."""

from __future__ import annotations

import os
import subprocess
import sys

import bpy
import pytest

from convwass_addon.bridge.color_spaces import DATA, LINEAR, SRGB, color_space
from convwass_addon.errors import ConvwassError

# A part of the library.
ACES = "ocio://cg-config-v1.0.0_aces-v1.3_ocio-v2.1"

PREPARED = """
import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Color

import convwass_addon
from convwass_addon.bridge.color_spaces import SRGB, color_space
from convwass_addon.bridge.files.image_files import pixel_values
from convwass_addon.bridge.nodes.node_trees import own_tree

bpy.ops.wm.read_factory_settings(use_empty=True)
convwass_addon.register()
folder = Path(sys.argv[1])
assert color_space(SRGB) == "sRGB - Texture"
"""

TEXTURES = """
color = (0.5, 0.3, 0.2)
for place, base in ((0, (0.0, 0.0, 0.0)), (3, color)):
    bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0))
    material = bpy.data.materials.new("Own")
    own_tree(material).nodes["Principled BSDF"].inputs["Base Color"].default_value = (*base, 1.0)
    bpy.context.object.data.materials.append(material)
bpy.ops.convwass.bake_morph(inputs="Cube, Cube.001", output="SHAPE_KEYS", motion="GUIDED")
bpy.ops.convwass.bake_textures(texture_size=16, texture_samples=1)
image = next(image for image in bpy.data.images if "Cube.001" in image.name)
assert image.colorspace_settings.name == "sRGB - Texture"
found = Color(pixel_values(image)[8, 8, :3]).from_srgb_to_scene_linear()
np.testing.assert_allclose(found, color, atol=0.01)
"""

SKIES = """
from convwass_addon.bridge.skies.sky_pixels import read_sky_file, write_sky

sky = np.full((8, 16, 3), (2.0, 0.5, 0.1), np.float32)
write_sky(folder / "sky.exr", sky)
np.testing.assert_allclose(read_sky_file(folder / "sky.exr"), sky, rtol=1e-4)
"""

PICTURES = """
from tests.fuzz.job_cases import prepare

assert prepare("bake_morph pictures", folder)() == {"FINISHED"}
image = bpy.data.images.load(str(min((folder / "out").rglob("*.png"))))
np.testing.assert_allclose(pixel_values(image)[1, 1, :3], 1.0, atol=0.01)
np.testing.assert_allclose(pixel_values(image)[..., :3].min(), 0.1, atol=0.02)
"""

RECOLORED = """
from tests.pictures import image_of

for name, seed in (("Red", 0), ("Blue", 1)):
    image = bpy.data.images.new(name, 9, 8, alpha=True)
    image.colorspace_settings.name = "sRGB - Texture"
    image.pixels.foreach_set(np.random.default_rng(seed).random(288).astype(np.float32))
bpy.context.scene.convwass_recolor.palette = image
assert bpy.ops.convwass.recolor_image(image="Red") == {"FINISHED"}
assert bpy.ops.convwass.build_grade_nodes(image="Red") == {"FINISHED"}
"""

SCRIPTS = {"textures": TEXTURES, "skies": SKIES, "pictures": PICTURES, "recolor": RECOLORED}


@pytest.mark.skipif(bpy.app.version < (5, 0), reason="measured with Blender 5.2")
@pytest.mark.parametrize(
    "script", [TEXTURES, SKIES, PICTURES, RECOLORED], ids=["textures", "skies", "pictures", "recolor"]
)
def test_images_have_their_colors_in_the_configuration_of_aces(script, project, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", PREPARED + script, str(tmp_path)],
        cwd=project,
        env=os.environ | {"OCIO": ACES},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_color_spaces_have_names_in_blenders_own_configuration():
    assert [color_space(names) for names in (SRGB, DATA, LINEAR)] == ["sRGB", "Non-Color", "Linear Rec.709"]
    with pytest.raises(ConvwassError, match="nothing like Moonlight"):
        color_space(["Moonlight"])
