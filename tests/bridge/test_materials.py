# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which color stands for an object, and the material that shows it."""

from __future__ import annotations

import bpy
import pytest

from convwass_addon.bridge.morphs.looks.materials import (
    MATERIAL_NAME,
    input_color,
    material_opacity,
    morph_material,
    plain_copy,
    see_through_material,
    shows_object_color,
)
from convwass_addon.bridge.nodes.node_trees import own_tree

RED = (0.8, 0.1, 0.2, 1.0)


@pytest.fixture
def colored(make_object):
    """Give an object with a material that has nodes."""
    obj = make_object("A")
    material = bpy.data.materials.new("Paint")
    own_tree(material)
    obj.data.materials.append(material)
    obj.color = (0.0, 0.0, 1.0, 1.0)
    material.diffuse_color = (0.0, 1.0, 0.0, 1.0)
    return obj


def base_color(material):
    return next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED").inputs["Base Color"]


def show_shader(material, kind):
    """Link a new shader to the output of a material."""
    tree = material.node_tree
    shader = tree.nodes.new(f"ShaderNode{kind}")
    tree.links.new(shader.outputs[0], tree.get_output_node("ALL").inputs["Surface"])
    return shader


def test_base_color(colored):
    base_color(colored.active_material).default_value = RED
    assert input_color(colored) == pytest.approx(RED)


def test_textured_material_gives_its_viewport_color(colored):
    tree = colored.active_material.node_tree
    texture = tree.nodes.new("ShaderNodeTexNoise")
    tree.links.new(texture.outputs["Color"], base_color(colored.active_material))
    assert input_color(colored) == pytest.approx((0.0, 1.0, 0.0, 1.0))


def test_material_without_principled(colored):
    colored.active_material.node_tree.nodes.clear()
    assert input_color(colored) == pytest.approx((0.0, 1.0, 0.0, 1.0))


@pytest.mark.parametrize("shader", ["Emission", "BsdfDiffuse", "BsdfGlossy", "BsdfGlass", "BsdfTransparent"])
def test_color_of_the_shown_shader(colored, shader):
    show_shader(colored.active_material, shader).inputs["Color"].default_value = RED
    assert input_color(colored) == pytest.approx(RED)


def test_color_of_an_rgb_node(colored):
    tree = colored.active_material.node_tree
    node, reroute = tree.nodes.new("ShaderNodeRGB"), tree.nodes.new("NodeReroute")
    node.outputs[0].default_value = RED
    tree.links.new(node.outputs[0], reroute.inputs[0])
    link = tree.links.new(reroute.outputs[0], base_color(colored.active_material))
    assert input_color(colored) == pytest.approx(RED)
    link.is_muted = True
    assert input_color(colored) == pytest.approx(tuple(base_color(colored.active_material).default_value))


def test_a_mix_of_shaders_gives_the_base_color(colored):
    base_color(colored.active_material).default_value = RED
    show_shader(colored.active_material, "MixShader")
    assert input_color(colored) == pytest.approx(RED)


def test_object_without_material(make_object):
    obj = make_object("A")
    obj.color = RED
    assert input_color(obj) == pytest.approx(RED)
    obj.data.materials.append(None)
    assert input_color(obj) == pytest.approx(RED)


def test_frame_of_another_morph(make_object):
    obj = make_object("A")
    obj.color = RED
    obj.data.materials.append(morph_material())
    assert input_color(obj) == pytest.approx(RED)


@pytest.mark.parametrize(("output", "expected"), [("Color", (0.0, 0.0, 1.0, 1.0)), ("Random", (0.0, 1.0, 0.0, 1.0))])
def test_only_its_color_counts_as_that_of_the_object(colored, output, expected):
    tree = colored.active_material.node_tree
    info = tree.nodes.new("ShaderNodeObjectInfo")
    tree.links.new(info.outputs[output], base_color(colored.active_material))
    assert input_color(colored) == pytest.approx(expected)
    assert shows_object_color(colored.active_material) == (output == "Color")


def test_morph_material_is_made_once():
    material = morph_material()
    assert material.name == MATERIAL_NAME
    assert morph_material() == material
    assert shows_object_color(material)


def test_plain_copy():
    copy = plain_copy(morph_material(), RED)
    assert not shows_object_color(copy)
    assert tuple(base_color(copy).default_value) == pytest.approx(RED)
    assert shows_object_color(morph_material())


def test_opacity_of_a_material(colored):
    material, tree = colored.active_material, colored.active_material.node_tree
    alpha = base_color(material).node.inputs["Alpha"]
    alpha.default_value = 0.25
    assert material_opacity(material, colored) == 0.25
    tree.links.new(tree.nodes.new("ShaderNodeTexNoise").outputs[0], alpha)
    assert material_opacity(material, colored) == 1.0
    show_shader(material, "Emission")
    assert material_opacity(material, colored) == 1.0


def test_opacity_of_the_object(make_object):
    obj, material = make_object("A"), see_through_material("Clear")
    obj.color = (0.8, 0.1, 0.2, 0.25)
    assert material_opacity(material, obj) == 0.25
    alpha = base_color(plain_copy(material, tuple(obj.color))).node.inputs["Alpha"]
    assert not alpha.is_linked
    assert alpha.default_value == 0.25
