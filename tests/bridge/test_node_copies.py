# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

from convwass_addon.bridge.nodes.node_copies import can_copy, copied_nodes
from convwass_addon.bridge.nodes.node_trees import own_tree


def tree_of(name):
    import bpy

    made = bpy.data.materials.new(name)
    return own_tree(made)


def described(tree):
    """Return everything about a tree that `copied_nodes` is expected to keep."""
    nodes = {}
    for node in tree.nodes:
        own = {"type": node.bl_idname, "parent": node.parent and node.parent.name, "location": tuple(node.location)}
        for prop in node.bl_rna.properties:
            if prop.type in ("ENUM", "BOOLEAN", "FLOAT", "INT", "STRING") and not prop.is_readonly:
                value = getattr(node, prop.identifier)
                if prop.identifier not in ("select", "location_absolute", "name"):
                    own[prop.identifier] = tuple(value) if getattr(prop, "is_array", False) else value
        own["values"] = [
            (one.identifier, tuple(one.default_value) if hasattr(one.default_value, "__len__") else one.default_value)
            for one in [*node.inputs, *node.outputs]
            if hasattr(one, "default_value")
        ]
        nodes[node.name] = own
    links = {
        (link.from_node.name, link.from_socket.identifier, link.to_node.name, link.to_socket.identifier, link.is_muted)
        for link in tree.links
    }
    return nodes, links


def test_a_copy_is_equal(bare_scene):
    """Nodes of every kind with values and settings of their own, in a frame, with a driver and a muted link."""
    import bpy

    tree = tree_of("Source")
    made = {
        kind: tree.nodes.new(f"ShaderNode{kind}")
        for kind in ("TexNoise", "TexVoronoi", "ValToRGB", "RGBCurve", "Mix", "MapRange", "VectorMath", "TexImage")
    }
    made["TexNoise"].noise_dimensions, made["TexNoise"].normalize = "4D", False
    made["TexVoronoi"].feature = "DISTANCE_TO_EDGE"
    made["Mix"].data_type, made["Mix"].blend_type = "RGBA", "OVERLAY"
    made["Mix"].inputs[7].default_value = (0.1, 0.2, 0.3, 1.0)
    made["MapRange"].data_type, made["VectorMath"].operation = "FLOAT_VECTOR", "SNAP"
    made["TexImage"].image, made["TexImage"].extension = bpy.data.images.new("Image", 2, 2), "CLIP"
    made["TexImage"].image_user.frame_offset = 7
    made["ValToRGB"].color_ramp.elements.new(0.3).color = (1.0, 0.5, 0.0, 1.0)
    made["ValToRGB"].color_ramp.interpolation = "CONSTANT"
    made["RGBCurve"].mapping.curves[2].points.new(0.4, 0.7)
    made["TexNoise"].inputs["Scale"].driver_add("default_value").driver.expression = "1 + 2"
    made["TexNoise"].parent = tree.nodes.new("NodeFrame")
    tree.links.new(made["TexNoise"].outputs[0], made["ValToRGB"].inputs[0])
    tree.links.new(made["ValToRGB"].outputs[0], made["Mix"].inputs[6]).is_muted = True
    target = bpy.data.node_groups.new("Target", "ShaderNodeTree")
    copies = copied_nodes(tree, target)
    assert described(target) == described(tree)
    ramp = copies[made["ValToRGB"].name].color_ramp
    assert [(round(own.position, 6), tuple(own.color)) for own in ramp.elements] == [
        (round(own.position, 6), tuple(own.color)) for own in made["ValToRGB"].color_ramp.elements
    ]
    assert ramp.interpolation == "CONSTANT"
    curves = copies[made["RGBCurve"].name].mapping.curves
    assert [tuple(point.location) for point in curves[2].points] == [
        tuple(point.location) for point in made["RGBCurve"].mapping.curves[2].points
    ]
    assert copies[made["TexImage"].name].image == made["TexImage"].image
    assert copies[made["TexImage"].name].image_user.frame_offset == 7
    (driver,) = target.animation_data.drivers
    assert driver.driver.expression == "1 + 2"


def test_an_animated_tree_keeps_its_action(bare_scene):
    import bpy

    tree = tree_of("Moving")
    tree.nodes["Principled BSDF"].inputs["Roughness"].keyframe_insert("default_value", frame=1)
    target = bpy.data.node_groups.new("Target", "ShaderNodeTree")
    copied_nodes(tree, target)
    assert target.animation_data.action == tree.animation_data.action
    assert target.animation_data.action_slot == tree.animation_data.action_slot
    assert can_copy(tree)
