# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Objects whose shape keys lead to other shapes."""

from __future__ import annotations

from dataclasses import replace

import bpy
import numpy as np
import pytest
from mathutils import Euler, Matrix

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.element_values import element_values
from convwass_addon.bridge.nodes.node_math import new_node
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.one_mesh import shape_key_job
from convwass_addon.bridge.one_mesh.records import has_key_record, key_records
from convwass_addon.bridge.one_mesh.rest_mesh import rest_mesh
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, key_expressions, object_with_keys
from convwass_addon.progress import Progress
from convwass_addon.sentence import Sentence

pytestmark = pytest.mark.usefixtures("empty_scene")

QUICK = {"output": "SHAPE_KEYS", "frames": 10}


def evaluated(obj):
    bpy.context.view_layer.update()
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    return element_values(mesh.vertices, "co", 3)


def slide(obj, **values):
    for name, value in values.items():
        obj[name] = value
    obj.update_tag()
    return evaluated(obj)


def moved(points, *shift):
    return points + np.array(shift)


def path_to(name, times, positions):
    return KeyPath(name, times, np.asarray(positions, float), 0.95, 0.001, 0.0, 0.0, 0)


@pytest.fixture
def cube():
    bpy.ops.mesh.primitive_cube_add()
    obj = bpy.context.object
    obj.vertex_groups.new(name="Paint").add([0, 3], 0.5, "REPLACE")
    return obj


def test_values_of_keys_are_hats_that_sum_to_one_between_them():
    times = (0.25, 0.5, 1.0)
    for v in np.linspace(0.0, 1.0, 21):
        values = [eval(text, {"v": v, "max": max, "min": min}) for text in key_expressions(times)]
        assert sum(values) == pytest.approx(min(v / times[0], 1.0), abs=1e-6)
        assert np.dot(values, times) == pytest.approx(v, abs=1e-6)


def test_a_slider_leads_through_the_keys_and_two_add_up(cube):
    rest = evaluated(cube).astype(float)
    up, wide = moved(rest, 0, 0, 2), rest * [3, 1, 1]
    paths = [path_to("Up", (0.5, 1.0), [moved(rest, 1, 0, 1), up]), path_to('Wide "one"', (1.0,), [wide])]
    obj = object_with_keys(cube, cube.data.copy(), paths, bpy.context.scene)
    assert slide(obj, Up=0.0) == pytest.approx(rest, abs=1e-6)
    assert slide(obj, Up=0.25) == pytest.approx(moved(rest, 0.5, 0, 0.5), abs=1e-5)
    assert slide(obj, Up=0.75) == pytest.approx(moved(rest, 0.5, 0, 1.5), abs=1e-5)
    assert slide(obj, Up=1.0) == pytest.approx(up, abs=1e-5)
    assert slide(obj, **{"Up": 1.0, 'Wide "one"': 0.5}) == pytest.approx(up + 0.5 * (wide - rest), abs=1e-5)
    assert all(curve.driver.is_simple_expression for curve in obj.data.shape_keys.animation_data.drivers)
    assert [group.name for group in obj.vertex_groups] == ["Paint"]
    assert [entry["name"] for entry in key_records(obj)] == ["Up", 'Wide "one"']
    assert has_key_record(obj) and not has_key_record(cube)


def test_vertices_that_do_not_arrive_are_marked(cube):
    rest = evaluated(cube).astype(float)
    path = KeyPath("Up", (1.0,), moved(rest, 0, 0, 2)[None], 0.95, 0.001, 0.0, 0.0, 1, np.array([2, 5]))
    obj = object_with_keys(cube, cube.data.copy(), [path], bpy.context.scene)
    assert [entry.value for entry in obj.data.attributes["Up poor"].data] == [n in (2, 5) for n in range(8)]
    assert key_records(obj)[0]["poor"] == 2


def test_sliders_of_long_names_are_shortened(cube):
    """Blender admits 63 bytes in names of custom properties and shape keys, and more in those of objects."""
    rest = evaluated(cube).astype(float)
    for shift in (1, 2):
        path = path_to("ü" * 60, (0.5, 1.0), [moved(rest, 0, 0, 1), moved(rest, 0, 0, shift)])
        path = replace(path, poor=np.array([2]))
        cube = object_with_keys(cube, cube.data.copy(), [path], bpy.context.scene)
    first, second = (record["name"] for record in key_records(cube))
    assert (first, second) == ("ü" * 24, f"{'ü' * 22}.001")
    assert {f"{first} poor", f"{second} poor"} < set(cube.data.attributes.keys())
    assert slide(cube, **{first: 1.0, second: 0.0}) == pytest.approx(moved(rest, 0, 0, 1), abs=1e-5)
    assert slide(cube, **{first: 0.0, second: 1.0}) == pytest.approx(moved(rest, 0, 0, 2), abs=1e-5)


def driven_key(obj, path):
    """Add a shape key to an object that is twice as large, driven by one of its properties."""
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Puff")
    for point in key.data:
        point.co *= 2.0
    driver = key.driver_add("value").driver
    variable = driver.variables.new()
    variable.targets[0].id, variable.targets[0].data_path = obj, path
    driver.expression = variable.name


def keyed_world_copy(obj, name):
    """Add a slider that lifts a copy of an object without armature; return the copy and its vertices at rest."""
    rest = rest_mesh(obj, bpy.context.evaluated_depsgraph_get())
    positions = rest.key_coordinates(moved(rest.seen, 0, 0, 1)[None])
    return object_with_keys(obj, rest.mesh, [path_to(name, (1.0,), positions)], bpy.context.scene), rest.seen


@pytest.mark.parametrize("path", ['["Up"]', "location[2]", "scale[0]"])
def test_keys_that_the_object_drives_itself_stay_as_they_are(cube, path):
    cube["Up"], cube.location.z, cube.scale = 0.7, 0.7, (0.7, 1.0, 1.0)
    cube.id_properties_ui("Up").update(min=0.0, max=2.0, description="How puffed")
    driven_key(cube, path)
    evaluated(cube)
    obj, seen = keyed_world_copy(cube, "Up")
    (name,) = (record["name"] for record in key_records(obj))
    assert name == "Up.001" and obj["Up"] == pytest.approx(0.7)
    assert obj.id_properties_ui("Up").as_dict() == cube.id_properties_ui("Up").as_dict()
    assert obj.data.shape_keys.key_blocks["Puff"].value == pytest.approx(0.7)
    assert slide(obj, **{name: 0.0}) == pytest.approx(seen, abs=1e-5)
    assert slide(obj, **{name: 1.0}) == pytest.approx(moved(seen, 0, 0, 1), abs=1e-5)


def test_keys_follow_the_custom_property_of_the_copy(cube):
    cube["Puffed"] = 0.0
    driven_key(cube, '["Puffed"]')
    evaluated(cube)
    obj, seen = keyed_world_copy(cube, "Up")
    assert slide(obj, Puffed=1.0) == pytest.approx(2.0 * seen, abs=1e-5)


def test_custom_properties_of_all_kinds_come_along(cube):
    values = {
        "text": "a",
        "vector": [1.0, 2.0],
        "group": {"inner": {"other": cube}},
        "other": cube,
        "flag": True,
        "scale": 2,
    }
    for name, value in values.items():
        cube[name] = value
    obj, _ = keyed_world_copy(cube, "Up")
    again, _ = keyed_world_copy(obj, "Down")
    for own in (obj, again):
        assert [own[name] for name in ("text", "other", "flag", "scale")] == ["a", cube, True, 2]
        assert list(own["vector"]) == [1.0, 2.0] and own["group"].to_dict() == values["group"]
    assert [record["name"] for record in key_records(again)] == ["Up", "Down"]


def test_shapes_follow_each_other_in_time(cube):
    rest = evaluated(cube).astype(float)
    paths = [path_to("B", (1.0,), [moved(rest, 1, 0, 0)]), path_to("C", (1.0,), [moved(rest, 0, 1, 0)])]
    obj = object_with_keys(cube, cube.data.copy(), paths, bpy.context.scene)
    animate_sliders(obj, ["B", "C"], 5, 10)
    for frame, shift in ((1, (0, 0)), (5, (0, 0)), (15, (1, 0)), (25, (0, 1)), (40, (0, 1))):
        bpy.context.scene.frame_set(frame)
        assert evaluated(obj) == pytest.approx(moved(rest, *shift, 0), abs=1e-5)


def hook(name, angle):
    """An object without symmetry, turned about the Y axis."""
    outline = np.array([[0, 0], [2, 0], [2, 0.5], [0.5, 0.5], [0.5, 3], [0, 3]]) - [0.5, 1.0]
    count = len(outline)
    points = np.concatenate([np.column_stack([outline[:, 0], np.full(count, y), outline[:, 1]]) for y in (-0.3, 0.3)])
    c, s = np.cos(angle), np.sin(angle)
    points = points @ np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(points.tolist(), [], [*sides, tuple(range(count))[::-1], tuple(range(count, 2 * count))])
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj


def test_the_bake_gives_the_first_mesh_keys_that_lead_to_the_second_shape(monkeypatch):
    """With the way known: how it is found, tests/applications/motions/test_guided_motion.py shows."""
    first, second = hook("First", 0.0), hook("Second", np.radians(60.0))
    first.modifiers.new("Edges", "BEVEL").show_viewport = False
    bpy.context.view_layer.update()

    def known(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        assert (names, demands.error) == (["First", "Second"], pytest.approx(0.005))
        return [path_to(names[1], (1.0,), [shapes[1].vertices])]

    monkeypatch.setattr(shape_key_job, "key_paths", known)
    scene = bpy.context.scene
    assert bpy.ops.convwass.bake_morph(inputs="First,Second", **QUICK) == {"FINISHED"}
    obj = bpy.data.objects["First Morph"]
    assert slide(obj, Second=0.0) == pytest.approx(evaluated(first), abs=1e-5)
    assert slide(obj, Second=1.0) == pytest.approx(evaluated(second), abs=1e-5)
    scene.frame_set(11)
    assert obj["Second"] == 1.0
    assert (scene.frame_start, scene.frame_end) == (1, 250)
    assert first.hide_get() and second.hide_get()


def test_the_mesh_remembers_the_shape_and_where_it_reaches_it(monkeypatch):
    first, second = hook("First", 0.0), hook("Second", 0.5)
    first.location, second.location = (4.0, 0.0, 0.0), (0.0, 9.0, 0.0)

    def known(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [path_to(names[1], (1.0,), [shapes[1].vertices])]

    monkeypatch.setattr(shape_key_job, "key_paths", known)
    assert bpy.ops.convwass.bake_morph(inputs="First,Second", alignment="CENTERED", **QUICK) == {"FINISHED"}
    obj = bpy.data.objects["First Morph"]
    stored = obj["convwass_shapes"]["Second"]
    assert stored["shape"] == second
    placement = np.array(stored["placement"]).reshape(4, 4)
    placed = (evaluated(second) + np.array([0.0, 9.0, 0.0])) @ placement[:3, :3].T + placement[:3, 3]
    assert slide(obj, Second=1.0) == pytest.approx(placed, abs=1e-5)


def test_a_new_basis_replaces_the_first_mesh(monkeypatch):
    hook("First", 0.0).location = (4.0, 0.0, 0.0)
    hook("Second", 0.5)

    def raised(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [path_to(names[1], (1.0,), [moved(shapes[0].vertices, 0, 0, 1)])]

    monkeypatch.setattr(shape_key_job, "key_paths", raised)
    options = {**QUICK, "basis": "QUADS", "resolution": 40}
    assert bpy.ops.convwass.bake_morph(inputs="First,Second", **options) == {"FINISHED"}
    obj = bpy.data.objects["First Morph"]
    assert np.median([len(polygon.vertices) for polygon in obj.data.polygons]) == 4
    rest = evaluated(obj)
    assert rest[:, 0].min() == pytest.approx(3.5, abs=0.05)
    assert slide(obj, Second=1.0) == pytest.approx(moved(rest, 0, 0, 1), abs=1e-5)


def test_instances_of_a_shape_are_reported_as_left_out(monkeypatch, capfd):
    hook("First", 0.0)
    second = hook("Second", 0.5)
    tree = bpy.data.node_groups.new("Dots", "GeometryNodeTree")
    for way in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
    kinds = ("NodeGroupInput", "NodeGroupOutput", "GeometryNodeInstanceOnPoints", "GeometryNodeJoinGeometry")
    given, shown, dots, both = map(tree.nodes.new, kinds)
    tree.links.new(given.outputs[0], dots.inputs["Points"])
    for node in (given, dots):
        tree.links.new(node.outputs[0], both.inputs[0])
    tree.links.new(tree.nodes.new("GeometryNodeMeshCube").outputs[0], dots.inputs["Instance"])
    tree.links.new(both.outputs[0], shown.inputs[0])
    second.modifiers.new("Dots", "NODES").node_group = tree

    def known(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [path_to(names[1], (1.0,), [shapes[1].vertices])]

    monkeypatch.setattr(shape_key_job, "key_paths", known)
    bpy.ops.convwass.bake_morph(inputs="First,Second", **QUICK)
    assert "Instances that Second shows are left out" in capfd.readouterr().out


def test_shapes_of_which_one_object_is_used_are_named(monkeypatch, capfd):
    first, _second = hook("First", 0.0), hook("Second", 0.5)
    wheel = hook("Wheel", 0.0)
    wheel.parent = first

    def known(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [path_to(names[1], (1.0,), [shapes[1].vertices])]

    monkeypatch.setattr(shape_key_job, "key_paths", known)
    bpy.ops.convwass.bake_morph(inputs="First,Second", grouping="PARENTS", **QUICK)
    told = capfd.readouterr().out
    assert "Of First, shape keys only use First; join its objects" in told
    assert "Of Second" not in told


@pytest.mark.parametrize(
    ("output", "changed", "is_named"),
    [
        ("Object", "location", True),
        ("Object", "nothing", False),
        ("UV", "rotation_euler", False),
        ("Generated", "location", False),
        ("Generated", "rotation_euler", True),
        ("", "scale", True),
    ],
)
def test_materials_that_look_different_on_the_copy_are_named(monkeypatch, capfd, output, changed, is_named):
    """A texture without coordinates uses generated ones; the scale is that of a mirror."""
    first = hook("First", 0.0)
    hook("Second", 0.5)
    material = bpy.data.materials.new("Wood")
    texture = new_node(own_tree(material), "ShaderNodeTexNoise")
    if output:
        coordinates = new_node(own_tree(material), "ShaderNodeTexCoord")
        own_tree(material).links.new(coordinates.outputs[output], texture.inputs["Vector"])
    first.data.materials.append(material)
    first.matrix_world = Matrix()
    if changed != "nothing":
        getattr(first, changed)[0] = -0.5
    bpy.context.view_layer.update()

    def known(shapes, names, demands, settings, guides, control):
        yield Progress(0.5, Sentence("Half"))
        return [path_to(names[1], (1.0,), [shapes[0].vertices])]

    monkeypatch.setattr(shape_key_job, "key_paths", known)
    bpy.ops.convwass.bake_morph(inputs="First,Second", **QUICK)
    assert ("Materials of First (Wood) read positions in its own space" in capfd.readouterr().out) == is_named


def test_mirror_images_are_found_in_the_space_of_the_object(cube):
    cube.matrix_world = Matrix.LocRotScale((3.0, 1.0, 0.0), Euler((0.2, 0.5, 0.9)), (1.0, 2.0, 0.5))
    bpy.context.view_layer.update()
    rest = rest_mesh(cube, bpy.context.evaluated_depsgraph_get())
    partners = rest.symmetry(cube).partners
    corners = np.array([vertex.co for vertex in cube.data.vertices])
    np.testing.assert_array_equal(corners[partners], corners * [-1.0, 1.0, 1.0])


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"coherence": 0.2}, "does not reach the other shape"),
        ({"inputs": "Word,Label"}, "is not a mesh"),
        ({"symmetric": True}, "First is not symmetric"),
    ],
)
def test_shapes_that_cannot_share_a_mesh_are_refused(arguments, message):
    hook("First", 0.0)
    hook("Second", 0.5)
    for name in ("Word", "Label"):
        bpy.ops.object.text_add()
        bpy.context.object.name = name
    before = len(bpy.data.meshes)
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.bake_morph(**{"inputs": "First,Second", **QUICK, **arguments})
    assert len(bpy.data.meshes) == before
