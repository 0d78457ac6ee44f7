# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The materials of frames, which users edit, when a morph is baked again."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.nodes.node_trees import own_tree
from tests.operators.test_rebake_morph import middle_width, shapes

pytestmark = pytest.mark.usefixtures("empty_scene")


def painted(name, place, textured):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(place, 0, 0))
    material = bpy.data.materials.new(name)
    tree = own_tree(material)
    shader = tree.nodes["Principled BSDF"]
    shader.inputs["Roughness"].default_value = 0.2 + 0.1 * place
    if textured:
        noise = tree.nodes.new("ShaderNodeTexNoise")
        tree.links.new(noise.outputs[0], shader.inputs["Base Color"])
        # Values that are animated change by themselves.
        for frame, scale in ((1, 2.0), (4, 8.0)):
            noise.inputs["Scale"].default_value = scale
            noise.inputs["Scale"].keyframe_insert("default_value", frame=frame)
    bpy.context.object.data.materials.append(material)
    return bpy.context.object


def bake(textured, **options):
    made = [painted("Red", 0.0, textured), painted("Blue", 3.0, textured)]
    for obj in made:
        obj.select_set(True)
    settings = {"motion": "TRANSPORT", "frames": 3, "resolution": 24, "carry": True, "looks": "FADE"}
    bpy.ops.convwass.bake_morph(**{**settings, **options})
    (morph,) = (own for own in bpy.data.collections if "convwass_morph" in own)
    return morph


def bake_again(morph):
    """Bake again after the shapes have grown, in another frame of the scene."""
    width = middle_width(morph)
    for obj in shapes(morph):
        obj.scale.z *= 1.5
    bpy.context.scene.frame_set(3)
    assert bpy.ops.convwass.rebake_morph(morphs=morph.name) == {"FINISHED"}
    assert middle_width(morph) > 1.2 * width


def names_of(kind):
    return sorted(block.name for block in getattr(bpy.data, kind))


@pytest.mark.parametrize(("textured", "output"), [(False, "OBJECTS"), (True, "OBJECTS"), (True, "PLAYER")])
def test_edited_nodes_of_frames_stay(textured, output):
    morph = bake(textured, output=output, between="NEAREST")
    (material,) = frame_objects(morph)[1].data.materials
    material.name = "Mine"
    tree = material.node_tree
    group = next((node.node_tree for node in tree.nodes if node.type == "GROUP"), None)
    assert (group is not None) == textured
    edited = group if textured else tree
    shader = next(node for node in edited.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Coat Weight"].default_value = 0.75
    before = [names_of("materials"), names_of("node_groups")]
    for _ in range(2):
        bake_again(morph)
        frames = frame_objects(morph)[1:3]
        assert [obj.data.materials[:] for obj in frames] == [[material], [material]]
        assert shader.inputs["Coat Weight"].default_value == 0.75
        assert names_of("materials") == before[0]
        assert [own for own in names_of("node_groups") if own.startswith("Look")] == [
            own for own in before[1] if own.startswith("Look")
        ]


def test_edited_nodes_of_frames_stay_after_an_image_of_a_shape_was_renamed(capfd):
    morph = bake(textured=False, frames=1, hide_inputs=False)
    image = bpy.data.images.new("Coat", 4, 4)
    for obj in shapes(morph):
        tree = obj.data.materials[0].node_tree
        texture = tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        tree.links.new(texture.outputs["Color"], tree.nodes["Principled BSDF"].inputs["Base Color"])
    bake_again(morph)
    (material,) = frame_objects(morph)[1].data.materials
    group = next(node.node_tree for node in material.node_tree.nodes if node.type == "GROUP")
    shader = next(node for node in group.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Coat Weight"].default_value = 0.75
    image.name = "Fur"
    bake_again(morph)
    assert frame_objects(morph)[1].data.materials[:] == [material]
    assert shader.inputs["Coat Weight"].default_value == 0.75
    assert "have changed" not in capfd.readouterr().out


def change_roughness(obj):
    obj.data.materials[0].node_tree.nodes["Principled BSDF"].inputs["Roughness"].default_value = 0.9


@pytest.mark.parametrize("is_edited", [False, True])
@pytest.mark.parametrize("textured", [False, True])
def test_after_a_shape_got_another_look_an_edited_material_is_kept_beside_the_frames(textured, is_edited, capfd):
    morph = bake(textured)
    (material,) = frame_objects(morph)[1].data.materials
    name = material.name
    if is_edited:
        output = material.node_tree.get_output_node("ALL")
        material.node_tree.links.remove(output.inputs["Surface"].links[0])
    change_roughness(shapes(morph)[0])
    bake_again(morph)
    (new,) = frame_objects(morph)[1].data.materials
    assert new.node_tree.get_output_node("ALL").inputs["Surface"].is_linked
    assert (f"the edited ones are kept: {name}" in capfd.readouterr().out) == is_edited
    assert (material in bpy.data.materials[:]) == is_edited
    if is_edited:
        assert material.use_fake_user and material != new
        bake_again(morph)
        assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
        assert bpy.data.materials[name] == material
    else:
        assert len(bpy.data.materials) == 3


def test_a_material_of_an_earlier_version_is_not_reported_as_changed(capfd):
    morph = bake(textured=False)
    (material,) = frame_objects(morph)[1].data.materials
    del material["convwass_made"]
    bake_again(morph)
    printed = capfd.readouterr().out
    assert "have changed" not in printed
    assert "Materials of an earlier version cannot be compared" in printed
    assert f"the old ones are kept: {material.name}" in printed
    assert material.use_fake_user and material not in frame_objects(morph)[1].data.materials[:]


def test_the_material_of_pictures_stays(tmp_path):
    shown = []
    for name, size in (("First", 20), ("Last", 30)):
        image = bpy.data.images.new(name, 64, 64)
        pixels = np.ones((64, 64, 4), np.float32)
        pixels[10 : 10 + size, 10 : 10 + size, :3] = 0.0
        image.pixels.foreach_set(pixels.ravel())
        obj = bpy.data.objects.new(name, None)
        obj.empty_display_type, obj.data = "IMAGE", image
        bpy.context.scene.collection.objects.link(obj)
        shown.append(name)
    settings = {"frames": 3, "flat_resolution": 64, "flat_output": "PICTURE", "folder": str(tmp_path / "one")}
    bpy.ops.convwass.bake_morph(inputs=",".join(shown), motion="TRANSPORT", **settings)
    (morph,) = (own for own in bpy.data.collections if "convwass_morph" in own)
    (material,) = frame_objects(morph)[0].data.materials
    shine = next(node for node in material.node_tree.nodes if node.type == "EMISSION")
    shine.inputs["Strength"].default_value = 3.0
    settings |= {"folder": str(tmp_path / "two"), "frames": 5}
    bpy.ops.convwass.bake_morph(inputs=",".join(shown), motion="TRANSPORT", replaces=morph.name, **settings)
    assert frame_objects(morph)[0].data.materials[:] == [material]
    assert shine.inputs["Strength"].default_value == 3.0
    (picture,) = (node for node in material.node_tree.nodes if node.type == "TEX_IMAGE")
    assert str(tmp_path / "two") in picture.image.filepath
    assert picture.image_user.frame_duration == 6
