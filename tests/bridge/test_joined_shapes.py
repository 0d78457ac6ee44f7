# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What artists call a shape is read as one mesh: collections, children, instances and all types of objects."""

from __future__ import annotations

from math import pi

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge import joined_shapes, shape_sources, visibility
from convwass_addon.bridge.flat.choosing import asks_for_flat
from convwass_addon.bridge.flat.flat_kinds import looks_flat
from convwass_addon.bridge.flat.flat_objects import is_flat
from convwass_addon.bridge.joined_shapes import joined_shape
from convwass_addon.bridge.morphs.changes import changed_inputs
from convwass_addon.bridge.morphs.inputs.shape_reading import read_shapes
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.morphs.stored_parts import stored_parts
from convwass_addon.bridge.objects import MESHED, triangle_mesh
from convwass_addon.bridge.shape_sources import shape_roots, shape_source
from convwass_addon.errors import InputError
from tests.scene import linked
from tests.searches import counted_searches
from tests.shapes import box

OCTAHEDRON = 4 / 3


@pytest.fixture
def add(make_object):
    """Give a function that adds an octahedron, of volume 4/3, with a material of the last word of its name."""

    def added(name, location=(0, 0, 0), scale=(1, 1, 1), parent=None, collection=None):
        obj = make_object(name)
        obj.location, obj.scale, obj.parent = location, scale, parent
        own = name.split()[-1]
        obj.data.materials.append(bpy.data.materials.get(own) or bpy.data.materials.new(own))
        obj.vertex_groups.new(name="Head").add([0], 0.5, "REPLACE")
        if collection is not None:
            bpy.context.scene.collection.objects.unlink(obj)
            collection.objects.link(obj)
        return obj

    return added


def new_collection(name, inside=None):
    made = bpy.data.collections.new(name)
    if inside is not None:
        inside.children.link(made)
    return made


def instance(name, collection, location=(0, 0, 0), scale=(1, 1, 1), home=None):
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", collection
    empty.location, empty.scale = location, scale
    (home or bpy.context.scene.collection).objects.link(empty)
    return empty


def read(obj, grouping="OBJECTS"):
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with joined_shape(shape_source(obj, grouping), depsgraph) as joined:
        return triangle_mesh(joined, depsgraph, MESHED)


def test_all_that_hangs_on_a_parent_is_one_shape(add, inventory):
    """Mirrored and unevenly scaled parents, and a child of a child; helpers are left out."""
    root = bpy.data.objects.new("Rig", None)
    bpy.context.scene.collection.objects.link(root)
    root.scale = (-2, 1, 1)
    body = add("Body", (5, 0, 0), parent=root)
    add("Hat", (0, 0, 3), (1, 1, -0.5), parent=body)
    add("Cage", (0, 0, 0), (9, 9, 9), parent=root).display_type = "WIRE"
    add("Other", (50, 0, 0))
    before = inventory()
    mesh = read(body, "PARENTS")
    assert inventory() == before
    assert mesh.volume == pytest.approx(2 * OCTAHEDRON * 1.5)
    np.testing.assert_allclose(mesh.bounds, [[-12, -1, -1], [-8, 1, 3.5]], atol=1e-5)


def test_of_several_objects_the_one_with_broken_coordinates_is_named(add, inventory):
    body, head = add("Body"), add("Head", (0, 0, 3))
    head.parent = body
    head.data.vertices[2].co.z = np.nan
    head.data.update()
    before = inventory()
    with pytest.raises(InputError, match="Head: 1 of 6 vertices"):
        read(body, "PARENTS")
    assert inventory() == before


def test_a_collection_is_one_shape_with_all_materials_and_groups(bare_scene, add):
    hero = new_collection("Hero", bare_scene.collection)
    parts = [add("Body", collection=hero), add("Hat", (0, 0, 3), collection=new_collection("Clothes", hero))]
    assert shape_roots(parts[:1], "COLLECTIONS") == [parts[0]]
    source = shape_source(parts[0], "COLLECTIONS")
    assert (source.name, set(source.parts)) == ("Hero", set(parts))
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with joined_shape(source, depsgraph) as joined:
        assert {material.name for material in joined.data.materials} == {"Body", "Hat"}
        assert joined.vertex_groups.keys() == ["Head"]
        weights = [vertex.groups[0].weight for vertex in joined.data.vertices if vertex.groups]
        assert weights == pytest.approx([0.5, 0.5])
        assert triangle_mesh(joined, depsgraph).volume == pytest.approx(2 * OCTAHEDRON)


def test_faces_of_missing_slots_have_the_last_material(bare_scene, add):
    """As in renders."""
    hero = new_collection("Hero", bare_scene.collection)
    hat, body = add("A Hat", (9, 0, 0), collection=hero), add("Body", collection=hero)
    body.data.materials.append(bpy.data.materials.new("Trim"))
    for obj in (hat, body):
        obj.data.polygons.foreach_set("material_index", [7] * len(obj.data.polygons))
    bpy.context.view_layer.update()
    with joined_shape(shape_source(body, "COLLECTIONS"), bpy.context.evaluated_depsgraph_get()) as joined:
        materials = joined.data.materials
        shown = {(face.center.x > 4, materials[face.material_index].name) for face in joined.data.polygons}
    assert shown == {(True, "Hat"), (False, "Trim")}


def test_nested_collections_belong_to_the_outer_one(bare_scene, add):
    """Their objects may come first by name, and may be selected, too."""
    hero = new_collection("Hero", bare_scene.collection)
    hat, body = add("A Hat", (0, 0, 3), collection=new_collection("Clothes", hero)), add("Body", collection=hero)
    other = add("Villain", (9, 0, 0), collection=new_collection("Others", bare_scene.collection))
    assert shape_roots([hat, body, other], "COLLECTIONS") == [body, other]
    for root in shape_roots([body], "COLLECTIONS"):
        source = shape_source(root, "COLLECTIONS")
        assert (source.name, set(source.parts)) == ("Hero", {hat, body})
    assert shape_source(hat, "COLLECTIONS").parts == (hat,)


@pytest.mark.parametrize("grouping", ["PARENTS", "COLLECTIONS"])
def test_the_file_is_searched_once_for_all_shapes(bare_scene, add, monkeypatch, grouping):
    heroes = [new_collection(name, bare_scene.collection) for name in ("Hero", "Villain", "Horse")]
    bodies = [add(f"Body of {hero.name}", collection=hero) for hero in heroes]
    hats = [add(f"Hat of {body.name}", parent=body, collection=body.users_collection[0]) for body in bodies]
    bpy.context.view_layer.update()
    searches = counted_searches(monkeypatch, shape_sources)
    assert shape_roots([*bodies, *hats], grouping) == bodies
    assert list(searches.values()) == [1]


def test_parts_of_nested_shapes_are_those_of_the_outermost(bare_scene, add):
    """Three levels, of which the innermost shares an object with another shape."""
    outer = new_collection("Outer", bare_scene.collection)
    middle = new_collection("Middle", outer)
    inner = new_collection("Inner", middle)
    parts = [add(own.name, collection=own) for own in (inner, middle, outer)]
    other = add("Other", collection=new_collection("Others", bare_scene.collection))
    bpy.data.collections["Others"].objects.link(parts[0])
    assert shape_roots([*parts, other], "COLLECTIONS") == [parts[2], other]
    assert shape_roots([*parts[:2], other], "COLLECTIONS") == [parts[1], other]


def test_metaballs_are_numbered_and_not_only_named(bare_scene):
    balls = [bpy.data.objects.new(name, bpy.data.metaballs.new("Ball")) for name in ("B.10", "B.1000", "B.999", "B.2")]
    for ball in balls:
        ball.data.elements.new()
        bare_scene.collection.objects.link(ball)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with_surface = [ball for ball in balls if ball.evaluated_get(depsgraph).dimensions.x > 0]
    assert shape_roots(balls) == with_surface == balls[-1:]


def test_excluded_parts_are_left_out(bare_scene, add):
    hero = new_collection("Hero", bare_scene.collection)
    cutter, body = add("Cutter", collection=new_collection("Cutters", hero)), add("Body", collection=hero)
    cutter.parent = body
    layer = bpy.context.view_layer.layer_collection.children["Hero"]
    layer.children["Cutters"].exclude = True
    bpy.context.view_layer.update()
    assert shape_source(body, "COLLECTIONS").parts == shape_source(body, "PARENTS").parts == (body,)
    # A shape that is excluded as a whole can still be named.
    layer.exclude = True
    bpy.context.view_layer.update()
    assert set(shape_source(body, "COLLECTIONS").parts) == {body, cutter}


@pytest.mark.parametrize("grouping", ["PARENTS", "COLLECTIONS"])
def test_images_for_reference_are_left_out(bare_scene, add, grouping):
    body = add("Body", collection=new_collection("Hero", bare_scene.collection))
    image = bpy.data.objects.new("Front View", None)
    image.empty_display_type, image.data = "IMAGE", bpy.data.images.new("Front View", 8, 8)
    bpy.data.collections["Hero"].objects.link(image)
    image.parent = body
    assert read(body, grouping).volume == pytest.approx(OCTAHEDRON)
    bpy.data.objects.remove(body)
    assert shape_source(image, grouping).parts == (image,)


@pytest.mark.parametrize("hidden", [False, True])
def test_an_empty_that_shows_a_collection_is_a_shape(add, hidden):
    """Collections in collections, mirrored twice and once more, and moved by the collection's offset."""
    inner, outer = new_collection("Inner"), new_collection("Outer")
    add("Part", (3, 0, 0), (1, 1, -2), collection=inner)
    inner.instance_offset = (3, 0, 0)
    instance("Within", inner, (0, 0, 5), (-1, 1, 1), outer)
    empty = instance("Shown", outer, (0, 7, 0), (1, 1, -1))
    empty.hide_set(hidden)
    assert shape_roots([empty]) == [empty]
    mesh = read(empty)
    assert mesh.volume == pytest.approx(2 * OCTAHEDRON)
    np.testing.assert_allclose(mesh.bounds, [[-1, 6, -7], [1, 8, -3]], atol=1e-5)


def test_a_linked_collection_is_a_shape(add, tmp_path):
    hero = new_collection("Hero")
    add("Body", collection=hero)
    bpy.data.libraries.write(str(tmp_path / "hero.blend"), {hero})
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with bpy.data.libraries.load(str(tmp_path / "hero.blend"), link=True) as (_, wanted):
        wanted.collections = ["Hero"]
    assert read(instance("Linked", wanted.collections[0], (4, 0, 0))).volume == pytest.approx(OCTAHEDRON)


def nodes_on(obj):
    tree = bpy.data.node_groups.new("Nodes", "GeometryNodeTree")
    tree.is_modifier = True
    for side in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=side, socket_type="NodeSocketGeometry")
    obj.modifiers.new("Nodes", "NODES").node_group = tree
    return tree


def geometry_nodes_instances(add):
    obj = add("Points")
    tree = nodes_on(obj)
    cube = tree.nodes.new("GeometryNodeMeshCube")
    copies = tree.nodes.new("GeometryNodeInstanceOnPoints")
    copies.inputs["Scale"].default_value = (0.1, 0.1, -0.1)
    tree.links.new(tree.nodes.new("NodeGroupInput").outputs[0], copies.inputs["Points"])
    tree.links.new(cube.outputs["Mesh"], copies.inputs["Instance"])
    tree.links.new(copies.outputs["Instances"], tree.nodes.new("NodeGroupOutput").inputs[0])
    return obj


def output_of(obj, *steps):
    """Let Geometry Nodes take an object through some nodes, given by their types and inputs."""
    tree = nodes_on(obj)
    geometry = tree.nodes.new("NodeGroupInput").outputs[0]
    for kind, inputs in steps:
        node = tree.nodes.new(kind)
        for name, value in inputs.items():
            if isinstance(value, str):
                tree.links.new(tree.nodes.new(value).outputs[0], node.inputs[name])
            else:
                node.inputs[name].default_value = value
        tree.links.new(geometry, node.inputs[0])
        geometry = node.outputs[0]
    tree.links.new(geometry, tree.nodes.new("NodeGroupOutput").inputs[0])
    return obj


def points_of_a_mesh(add):
    return output_of(add("Mesh"), ("GeometryNodeMeshToPoints", {"Radius": 0.1}))


def strands_of_a_mesh(add):
    radius = ("GeometryNodeSetCurveRadius", {"Radius": 0.1})
    line = linked("Line", bpy.data.meshes.new("Line"))
    line.data.from_pydata([(0, 0, 0), (0, 0, 1)], [(0, 1)], [])
    return output_of(line, ("GeometryNodeMeshToCurve", {}), radius)


def volume_of_a_mesh(add):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    return output_of(bpy.context.object, ("GeometryNodeMeshToVolume", {}))


def copies_along_a_curve(_add):
    bpy.ops.curve.primitive_bezier_circle_add()
    copies = ("GeometryNodeInstanceOnPoints", {"Instance": "GeometryNodeMeshCube", "Scale": (0.1, 0.1, 0.1)})
    return output_of(bpy.context.object, ("GeometryNodeResampleCurve", {"Count": 8}), copies)


def mesh_of_hair(add):
    corners = {"Profile Curve": "GeometryNodeCurvePrimitiveQuadrilateral", "Fill Caps": True}
    return output_of(hair(add), ("GeometryNodeSetCurveRadius", {"Radius": 1.0}), ("GeometryNodeCurveToMesh", corners))


def metaball(_add):
    bpy.ops.object.metaball_add()
    bpy.context.object.data.resolution = 0.1
    return bpy.context.object


def nurbs(_add):
    bpy.ops.surface.primitive_nurbs_surface_sphere_add()
    return bpy.context.object


def hair(_add):
    data = bpy.data.hair_curves.new("Hair")
    data.add_curves([2, 2])
    for number, point in enumerate(data.points):
        point.position = (5 * (number // 2), 0, number % 2)
    data.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", [0.1] * 4)
    return linked("Hair", data)


def points(_add):
    data = bpy.data.pointclouds.new("Points")
    if not hasattr(data, "resize"):
        pytest.skip("in Blender 4.5, only nodes create points")
    data.resize(3)
    data.attributes.new("radius", "FLOAT", "POINT").data.foreach_set("value", [0.5] * 3)
    data.attributes["position"].data.foreach_set("vector", [0, 0, 0, 5, 0, 0, 9, 0, 0])
    return linked("Points", data)


def volume_of_fog(add):
    """A ball of fog, whose surface is at its threshold."""
    obj = linked("Fog", bpy.data.volumes.new("Fog"))
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=4)
    ball = bpy.context.object
    ball.hide_render = True
    filled = obj.modifiers.new("Fill", "MESH_TO_VOLUME")
    filled.object, filled.voxel_size, filled.resolution_mode = ball, 0.05, "VOXEL_SIZE"
    return obj


def emitter(add, **settings):
    """A plane of 2 x 2 that emits octahedra of volume 4/3 / 1000."""
    bpy.ops.mesh.primitive_plane_add()
    plane = bpy.context.object
    plane.name = "Emitter"
    plane.modifiers.new("Particles", "PARTICLE_SYSTEM")
    own = plane.particle_systems[0].settings
    own.type, own.count, own.render_type, own.particle_size = "HAIR", 5, "OBJECT", 0.1
    own.use_advanced_hair, own.hair_length = True, 1.0
    own.instance_object = add("Grain", (30, 0, 0))
    for name, value in settings.items():
        setattr(own, name, value)
    plane.show_instancer_for_render = False
    return plane


def copies_at_vertices(add):
    obj = add("Points")
    add("Copied", (0, 0, 0.25), (0.1, 0.1, -0.1), parent=obj)
    obj.instance_type = "VERTS"
    obj.show_instancer_for_render = False
    return obj


@pytest.mark.parametrize(
    ("make", "volume", "tolerance"),
    [
        (geometry_nodes_instances, 6 * 0.001, 1e-5),
        (points_of_a_mesh, 6 * 4 / 3 * pi / 1000, 4e-3),
        (strands_of_a_mesh, 0.01 * 4 * np.sin(pi / 4), 1e-4),
        (volume_of_a_mesh, 4 / 3 * pi, 0.5),
        (copies_along_a_curve, 8 * 0.001, 1e-5),
        (mesh_of_hair, 2 * 2 * 2, 1e-4),
        (metaball, 6.2, 0.5),  # a ball of radius 1.15, which is where the field of one metaball of radius 2 ends
        (nurbs, 4 / 3 * pi, 0.2),
        (hair, 2 * 0.01 * 4 * np.sin(pi / 4), 1e-4),  # prisms of eight corners
        (points, 3 * 4 / 3 * pi / 8, 0.2),
        (volume_of_fog, 4 / 3 * pi, 0.3),
        (emitter, 5 * OCTAHEDRON / 1000, 1e-5),
        (copies_at_vertices, 6 * OCTAHEDRON / 1000, 1e-5),
    ],
)
def test_objects_of_all_types_are_shapes(add, make, volume, tolerance):
    obj = make(add)
    assert shape_roots([obj]) == [obj]
    mesh = read(obj)
    assert mesh.volume == pytest.approx(volume, abs=tolerance)


@pytest.mark.parametrize("make", [geometry_nodes_instances, hair, volume_of_fog, emitter, copies_at_vertices])
def test_objects_of_all_types_are_moved_with_an_empty_that_shows_them(add, make):
    obj = make(add)
    alone, collection = read(obj), new_collection("Shown")
    collection.objects.link(obj)
    found = read(instance("Empty", collection, (0, 7, 0), (2, 2, 2)))
    np.testing.assert_allclose(found.bounds, 2.0 * alone.bounds + (0, 7, 0), atol=1e-4)
    assert found.volume == pytest.approx(8.0 * alone.volume, rel=1e-4)


def test_a_text_is_what_its_nodes_make_of_it(add):
    bpy.ops.object.text_add()
    text = bpy.context.object
    text.data.body, text.data.extrude = "I", 0.5
    alone, depsgraph = read(text).volume, bpy.context.evaluated_depsgraph_get()
    assert is_flat(text, depsgraph)
    tree = nodes_on(text)
    line, copies = (tree.nodes.new(f"GeometryNode{kind}") for kind in ("MeshLine", "InstanceOnPoints"))
    line.inputs["Count"].default_value, line.inputs["Offset"].default_value = 3, (0.0, 0.0, 5.0)
    tree.links.new(line.outputs[0], copies.inputs["Points"])
    tree.links.new(tree.nodes.new("NodeGroupInput").outputs[0], copies.inputs["Instance"])
    tree.links.new(copies.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
    assert not is_flat(text, depsgraph)
    assert read(text).volume == pytest.approx(3 * alone, rel=1e-4)


def test_a_curve_is_flat_until_nodes_give_it_depth(add):
    obj, depsgraph = copies_along_a_curve(add), bpy.context.evaluated_depsgraph_get()
    assert not is_flat(obj, depsgraph)
    obj.modifiers.clear()
    output_of(obj, ("GeometryNodeFillCurve", {}))
    assert is_flat(obj, depsgraph)
    output_of(obj, ("GeometryNodeExtrudeMesh", {}))
    assert not is_flat(obj, depsgraph)


@pytest.mark.parametrize("by", ["depth", "object"])
def test_a_tube_along_an_open_curve_is_solid(add, by):
    bpy.ops.curve.primitive_bezier_circle_add(radius=0.1)
    profile = bpy.context.object
    bpy.ops.curve.primitive_nurbs_path_add()
    obj, depsgraph = bpy.context.object, bpy.context.evaluated_depsgraph_get()
    assert is_flat(obj, depsgraph) and looks_flat(obj)
    obj.data.use_fill_caps = True
    if by == "depth":
        obj.data.bevel_depth, obj.data.bevel_resolution = 0.1, 12
    else:
        obj.data.bevel_mode, obj.data.bevel_object = "OBJECT", profile
    bpy.context.view_layer.update()
    assert not is_flat(obj, depsgraph) and not looks_flat(obj)
    assert not asks_for_flat([obj, obj], depsgraph, 0.0)
    assert read(obj).volume == pytest.approx(0.01 * pi * 4.0, rel=0.05)
    # Closed ones are flat shapes with a bevel.
    obj.data.splines[0].use_cyclic_u = True
    assert is_flat(obj, depsgraph) and looks_flat(obj)


def test_a_curve_with_thickness_is_solid(add):
    bpy.ops.curve.primitive_bezier_circle_add()
    obj, depsgraph = bpy.context.object, bpy.context.evaluated_depsgraph_get()
    obj.data.dimensions, obj.data.fill_mode = "2D", "BOTH"
    assert is_flat(obj, depsgraph) and looks_flat(obj)
    obj.modifiers.new("Thickness", "SOLIDIFY").thickness = 0.5
    assert not is_flat(obj, depsgraph) and not looks_flat(obj)
    assert read(obj).volume == pytest.approx(0.5 * pi, rel=0.02)


def test_copies_are_where_particles_show_them(add):
    obj = emitter(add)
    shown = [
        np.array(one.matrix_world.translation)
        for one in bpy.context.evaluated_depsgraph_get().object_instances
        if one.is_instance
    ]
    mesh = read(obj)
    centers = mesh.vertices.reshape(5, 6, 3).mean(axis=1)
    np.testing.assert_allclose(sorted(centers.tolist()), sorted(np.array(shown).tolist()), atol=1e-5)


def test_types_are_mixed_in_one_shape(bare_scene, add):
    mixed = new_collection("Mixed", bare_scene.collection)
    add("Body", collection=mixed)
    bpy.ops.object.text_add(location=(9, 0, 0))
    text = bpy.context.object
    text.data.extrude, text.data.body = 0.5, "I"
    metaball(add).location.x = -9
    instance("Copy", new_collection("Elsewhere"), (0, 9, 0))
    add("Far", collection=bpy.data.collections["Elsewhere"])
    for obj in (text, bpy.data.objects["Mball"], bpy.data.objects["Copy"]):
        bare_scene.collection.objects.unlink(obj)
        mixed.objects.link(obj)
    mesh = read(text, "COLLECTIONS")
    assert mesh.bounds[0, 0] < -9.5
    assert mesh.bounds[1, 0] > 9
    assert mesh.bounds[1, 1] == pytest.approx(10)
    assert mesh.volume > 2 * OCTAHEDRON + 5


def test_splines_without_radius_are_refused(add):
    obj = hair(add)
    obj.data.attributes.remove(obj.data.attributes["radius"])
    with pytest.raises(InputError, match="Hair has strands or points without a radius"):
        read(obj)


@pytest.mark.parametrize("kind", ["hair_curves", "pointclouds"])
def test_objects_without_any_strands_or_points_are_called_empty(bare_scene, kind):
    with pytest.raises(InputError, match="Nothing has no faces"):
        read(linked("Nothing", getattr(bpy.data, kind).new("Nothing")))


def test_a_collection_without_surfaces_is_refused(bare_scene, inventory):
    empty = instance("Shown", new_collection("Nothing"))
    before = inventory()
    with pytest.raises(InputError, match="Shown has no faces"):
        read(empty)
    assert inventory() == before


@pytest.mark.parametrize("grouping", ["COLLECTIONS", "OBJECTS"])
def test_flat_groups_are_told_to_be_joined(bare_scene, inventory, grouping):
    words = []
    for number, name in enumerate(("Word", "Number")):
        group = new_collection(name, bare_scene.collection if grouping == "COLLECTIONS" else None)
        for place in range(2):
            bpy.ops.object.text_add(location=(5 * number + place, 0, 0))
            text = bpy.context.object
            bare_scene.collection.objects.unlink(text)
            group.objects.link(text)
        words.append(text if grouping == "COLLECTIONS" else instance(f"{name} Shown", group))
    before, options = inventory(), {"grouping": grouping}
    with pytest.raises(InputError, match=r"Word.* is flat, but not a single object of its own. .* join these"):
        MorphJob(words, path_blends(2, 3), MorphSettings(resolution=32), options, 1)
    assert inventory() == before
    MorphJob(words, path_blends(2, 3), MorphSettings(resolution=32, thickness=0.1), options, 1).discard()


def read_all(inputs, grouping, parts="none"):
    bpy.context.view_layer.update()
    settings, options = MorphSettings(32, motion="transport", parts=parts), {"grouping": grouping}
    return read_shapes(inputs, bpy.context.evaluated_depsgraph_get(), settings, options)


@pytest.mark.parametrize("parts", ["none", "materials"])
def test_all_hidden_shapes_are_shown_once_to_be_read(bare_scene, add, monkeypatch, parts):
    """Blender rebuilds its graph whenever objects are shown."""
    shapes = [add(f"{name} Body", (4 * number, 0, 0)) for number, name in enumerate("ABC")]
    for obj in shapes:
        obj.hide_viewport = True
    shown, show = [], visibility.shown_objects
    monkeypatch.setattr(
        visibility, "shown_objects", lambda objects, scene: shown.append(objects) or show(objects, scene)
    )
    found = read_all(shapes, "OBJECTS", parts)
    assert [mesh.bounds.mean(axis=0)[0] for mesh in found.inputs.shapes] == pytest.approx([0.0, 4.0, 8.0])
    assert shown == [shapes]
    assert all(obj.hide_viewport for obj in shapes)


def hidden_at_vertices(add):
    copies = copies_at_vertices(add)
    return copies, add("Hidden", (0, 0, 3), parent=copies)


def hidden_at_particles(add):
    group = new_collection("Group", bpy.context.scene.collection)
    add("Shown", collection=group)
    copies = emitter(add, render_type="COLLECTION", instance_collection=group, use_whole_collection=True)
    return copies, add("Copied", (0, 0, 4), collection=group)


def hidden_in_an_instance(add):
    group = new_collection("Group", bpy.context.scene.collection)
    add("Shown", collection=group)
    return instance("Copies", group, (0, 9, 0)), add("Copied", (0, 0, 4), collection=group)


@pytest.mark.parametrize("make", [hidden_at_vertices, hidden_at_particles, hidden_in_an_instance])
def test_shapes_are_the_same_beside_a_hidden_one(add, make):
    """Some copies leave hidden objects out."""
    shape, hidden = make(add)
    plain = add("Plain", (20, 0, 0))
    plain.hide_viewport = hidden.hide_viewport = True
    apart = [read(obj).volume for obj in (plain, hidden, shape)]
    assert [mesh.volume for mesh in read_all([plain, hidden, shape], "OBJECTS").inputs.shapes] == pytest.approx(apart)


def test_all_parts_are_read_before_anything_is_built(bare_scene, add, monkeypatch, inventory):
    """Blender would rebuild its graph after each part."""
    group = new_collection("Group", bare_scene.collection)
    parts = [add(f"{name} Body", (4 * number, 0, 0), collection=group) for number, name in enumerate("ABC")]
    before, built, copy = inventory(), [], joined_shapes.frozen_copy

    def counted(*settings):
        built.append((len(bpy.data.objects), len(bpy.data.node_groups)))
        return copy(*settings)

    monkeypatch.setattr(joined_shapes, "frozen_copy", counted)
    assert read(parts[0], "COLLECTIONS").volume == pytest.approx(3 * OCTAHEDRON)
    assert built == [(len(bpy.data.objects), len(bpy.data.node_groups))] * 3
    assert inventory() == before


def test_collections_are_morphed_and_restored(bare_scene, add, inventory):
    """In centimeters; the ends have the parts of the collections, which are hidden and shown as a whole."""
    bare_scene.unit_settings.scale_length = 0.01
    for number, name in enumerate(("Hero", "Villain")):
        collection = new_collection(name, bare_scene.collection)
        add(f"{name} Body", (4 * number, 0, 0), collection=collection)
        add(f"{name} Hat", (4 * number, 0, 2), (-1, 1, 0.5), collection=collection)
    parts = [obj for obj in bare_scene.objects if obj.type == "MESH"]
    inputs = shape_roots(parts, "COLLECTIONS")
    assert [obj.name for obj in inputs] == ["Hero Body", "Villain Body"]
    before = inventory()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    settings = MorphSettings(32, motion="transport", parts="materials")
    options = {"grouping": "COLLECTIONS"}

    def job():
        made = MorphJob(inputs, path_blends(2, 2), settings, options, 1)
        for step in made.steps(computation=Computation(workers=1)):
            made.write(step)
        return made

    job().discard()
    assert inventory() == before
    morph = job().finish(hide_inputs=True)
    assert morph.name == "Morph Hero to Villain"
    first, half, _ = (triangle_mesh(obj, depsgraph) for obj in frame_objects(morph))
    assert first.volume == pytest.approx(1.5 * OCTAHEDRON)
    assert half.volume == pytest.approx(1.5 * OCTAHEDRON, rel=0.03)
    assert {own.name for own in frame_objects(morph)[0].data.materials} == {"Body", "Hat"}
    assert set(stored_parts(morph)) == set(parts)
    assert all(part.hide_render for part in parts)
    assert changed_inputs(morph) == []
    parts[1].location.z += 1
    bpy.context.view_layer.update()
    assert changed_inputs(morph) == ["Hero Body"]


def test_a_box_that_is_mirrored_has_the_triangles_of_its_copy(make_object):
    """Colors and normals are looked up by the numbers of triangles."""
    shape = box((1, 2, 3))
    obj = make_object("Box", shape.vertices, (), shape.faces)
    obj.scale.x = -1
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    with joined_shape(shape_source(obj), depsgraph) as joined:
        assert joined != obj
        np.testing.assert_array_equal(np.array(joined.matrix_world), np.eye(4))
        assert triangle_mesh(joined, depsgraph).volume == pytest.approx(6)
