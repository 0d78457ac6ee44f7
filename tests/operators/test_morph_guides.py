# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
import json
import math

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from convwass_addon.bridge.morphs.inputs.morph_guides import guides_of_shapes, parsed_guides
from convwass_addon.bridge.morphs.stored import stored_morph
from convwass_addon.bridge.object_names import object_of
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import InputError
from tests.linked_objects import linked_object
from tests.operators.morphs import add
from tests.operators.running import inventory
from tests.scene import edited, reversed_order, select_only, without


@pytest.fixture
def cubes(empty_scene):
    found = []
    for name, place in (("One", 0.0), ("Two", 4.0)):
        bpy.ops.mesh.primitive_cube_add(location=(place, 0.0, 0.0))
        obj = bpy.context.object
        obj.name = name
        found.append(obj)
    for obj in found:
        obj.select_set(True)
    return found


def guides():
    return bpy.context.scene.convwass_guides


def test_a_guide_is_added_by_its_points(cubes):
    assert bpy.ops.convwass.add_morph_guide(label="corner", points='{"One": 3, "Two": 5}') == {"FINISHED"}
    (found,) = guides().named
    assert (found.name, dict(found.points)) == ("corner", {"One": 3, "Two": 5})


@pytest.mark.parametrize(
    ("points", "message"),
    [
        ('{"One": 3}', "at least two shapes"),
        ('{"One": 3, "Nobody": 1}', "no mesh object named Nobody"),
        ('{"One": 3, "Two": 99}', "Two has 8 vertices"),
        ('{"One": "x", "Two": 1}', "cannot be read"),
        ("[", "cannot be read"),
        ("", "Name the points"),
    ],
)
def test_bad_points_are_refused(cubes, points, message):
    with pytest.raises(RuntimeError, match=message):
        bpy.ops.convwass.add_morph_guide(points=points)
    assert not guides().items


def test_guides_from_groups_and_empties(cubes):
    for obj, vertex in zip(cubes, (1, 6), strict=True):
        obj.vertex_groups.new(name="Tip").add([vertex], 1.0, "REPLACE")
        empty = bpy.data.objects.new("Nose", None)
        empty.location = obj.matrix_world @ obj.data.vertices[2].co
        bpy.context.scene.collection.objects.link(empty)
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.morph_guides_from_names(kind="GROUPS") == {"FINISHED"}
    assert bpy.ops.convwass.morph_guides_from_names(kind="EMPTIES") == {"FINISHED"}
    assert {guide.name: dict(guide.points) for guide in guides().named} == {
        "Tip": {"One": 1, "Two": 6},
        "Nose": {"One": 2, "Two": 2},
    }
    assert bpy.ops.convwass.morph_guides_from_names(kind="GROUPS") == {"CANCELLED"}


@pytest.mark.parametrize("how", ["disabled", "excluded"])
def test_hidden_empties_mark_where_they_are(cubes, how):
    """Blender does not move hidden objects: those moved meanwhile, or never shown, would be elsewhere."""
    marks = bpy.data.collections.new("Marks")
    bpy.context.scene.collection.children.link(marks)
    bpy.context.view_layer.layer_collection.children["Marks"].exclude = how == "excluded"
    for obj in cubes:
        empty = bpy.data.objects.new("Nose", None)
        marks.objects.link(empty)
        bpy.context.view_layer.update()
        empty.hide_viewport = how == "disabled"
        empty.location = obj.matrix_world @ obj.data.vertices[2].co
    bpy.context.view_layer.update()
    assert bpy.ops.convwass.morph_guides_from_names(kind="EMPTIES") == {"FINISHED"}
    assert [dict(guide.points) for guide in guides().named] == [{"One": 2, "Two": 2}]


def test_bones_point_at_the_vertices_at_their_ends(cubes):
    for obj in cubes:
        bpy.ops.object.armature_add(location=obj.location)
        rig = bpy.context.object
        bpy.ops.object.mode_set(mode="EDIT")
        rig.data.edit_bones[0].name = "Arm"
        rig.data.edit_bones[0].tail = (0.9, 0.9, 0.9)
        bpy.ops.object.mode_set(mode="OBJECT")
        obj.modifiers.new("Rig", "ARMATURE").object = rig
    for obj in bpy.context.view_layer.objects:
        obj.select_set(obj in cubes)
    assert bpy.ops.convwass.morph_guides_from_names(kind="BONES") == {"FINISHED"}
    (found,) = guides().named
    for obj in cubes:
        assert np.allclose(obj.data.vertices[found.points[obj.name]].co, (1.0, 1.0, 1.0))


def test_missing_common_names_are_reported(cubes):
    with pytest.raises(RuntimeError, match="no small vertex groups, Empties or bones"):
        bpy.ops.convwass.morph_guides_from_names(kind="GROUPS")


def test_guides_are_taken_off_and_cleared(cubes):
    for vertex in range(3):
        bpy.ops.convwass.add_morph_guide(label=str(vertex), points=f'{{"One": {vertex}, "Two": {vertex}}}')
    bpy.ops.convwass.remove_morph_guide(index=1)
    assert [guide.label for guide in guides().items] == ["0", "2"]
    with pytest.raises(RuntimeError, match="no item 2"):
        bpy.ops.convwass.remove_morph_guide(index=2)
    bpy.ops.convwass.clear_morph_guides()
    assert not guides().items


def test_modifiers_that_make_vertices_keep_the_place_of_a_guide(cubes):
    cubes[0].modifiers.new("Fine", "SUBSURF").subdivision_type = "SIMPLE"
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes = [triangle_mesh(obj, depsgraph) for obj in cubes]
    named = parsed_guides('[{"name": "corner", "points": {"One": 7, "Two": 7, "Elsewhere": 1}}]')
    ((guide),) = guides_of_shapes(named, cubes, shapes, depsgraph)
    for number, obj in enumerate(cubes):
        expected = obj.matrix_world @ obj.data.vertices[7].co
        assert np.allclose(shapes[number].vertices[guide[number]], expected)


def test_a_deleted_vertex_is_named(cubes):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes = [triangle_mesh(obj, depsgraph) for obj in cubes]
    named = parsed_guides('[{"name": "corner", "points": {"One": 70, "Two": 7}}]')
    with pytest.raises(InputError, match="vertex 70 of One, which has 8 vertices"):
        guides_of_shapes(named, cubes, shapes, depsgraph)


def test_guides_survive_being_text():
    text = '[{"name": "Nase", "points": {"Mann ä": 1, "B": 2}}]'
    assert parsed_guides(json.dumps([guide.as_dict() for guide in parsed_guides(text)])) == parsed_guides(text)
    assert parsed_guides("") == []


def bake(**options):
    return bpy.ops.convwass.bake_morph(**{"frames": 2, "resolution": 16, **options})


def stored_guides():
    morph = next(own for own in bpy.data.collections if "convwass_morph" in own)
    return stored_morph(morph).settings["guides"]


@pytest.mark.parametrize("points", ['{"One": 1, "Two": 2}}, {"points": {"One": 0, "Two": 0}', "null", "3", '"One"'])
def test_invalid_points_are_refused(cubes, points):
    with pytest.raises(RuntimeError, match="cannot be read"):
        bpy.ops.convwass.add_morph_guide(points=points)


def test_a_vertex_is_in_one_guide(cubes):
    bpy.ops.convwass.add_morph_guide(points='{"One": 3, "Two": 5}')
    with pytest.raises(RuntimeError, match="Vertex 5 of Two is already in guide 1"):
        bpy.ops.convwass.add_morph_guide(points='{"One": 4, "Two": 5}')
    assert len(guides().items) == 1


def test_guides_about_other_shapes_are_left_out(cubes):
    bpy.ops.mesh.primitive_cube_add()
    bpy.context.object.name = "Three"
    for points in ('{"One": 1, "Two": 2, "Three": 3}', '{"Two": 5, "Three": 5}'):
        bpy.ops.convwass.add_morph_guide(label="g", points=points)
    assert bake(inputs="One, Two", motion="TRANSPORT") == {"FINISHED"}
    (stored,) = stored_guides()
    assert (stored["name"], stored["points"]) == ("g", {"One": 1, "Two": 2})
    assert stored["places"].keys() == {"One", "Two"}


def test_an_argument_about_other_shapes_is_refused(cubes):
    with pytest.raises(RuntimeError, match="refer to Nobody, which is not one of the shapes: One, Two"):
        bake(guides='[{"points": {"One": 1, "Nobody": 2}}]')


def test_a_shape_that_is_deleted_takes_its_points_along(cubes):
    """The list still refers to it, so Blender keeps it."""
    bpy.ops.convwass.add_morph_guide(points='{"One": 3, "Two": 5}')
    (item,) = guides().items
    assert item.problem is None
    bpy.context.scene.collection.objects.unlink(cubes[1])
    assert not guides().named
    assert "another shape" in str(item.problem)
    assert len(item.points) == 2, "it may come back by undo"


def test_a_vertex_that_is_deleted_is_shown_and_refused_before_the_bake(cubes):
    bpy.ops.convwass.add_morph_guide(points='{"One": 1, "Two": 5}')
    bpy.ops.convwass.add_morph_guide(points='{"One": 7, "Two": 7}')
    small = bpy.data.meshes.new("Tetrahedron")
    small.from_pydata([(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)], [], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)])
    cubes[0].data = small
    assert [str(item.problem) for item in guides().items] == [
        "The point on One was deleted",
        "One no longer has a vertex 7",
    ]
    before = inventory()
    with pytest.raises(RuntimeError, match="Guide 1 was on a part of One that was deleted"):
        bake(motion="GUIDED")
    bpy.ops.convwass.remove_morph_guide(index=0)
    with pytest.raises(RuntimeError, match="Guide 1 refers to vertex 7 of One, which has 4 vertices"):
        bake(motion="GUIDED")
    assert inventory() == before
    # What takes no guides does not mind.
    assert bake(motion="TRANSPORT") == {"FINISHED"}


@pytest.fixture
def namesakes(cubes, tmp_path):
    """The first cube and a linked copy of it, both named One, selected; each has a small group at another vertex."""
    local, other = cubes
    other.select_set(False)
    local.vertex_groups.new(name="Tip").add([6], 1.0, "REPLACE")
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {local})
    local.vertex_groups["Tip"].remove([6])
    local.vertex_groups["Tip"].add([1], 1.0, "REPLACE")
    local.location.x = 9.0
    linked = linked_object(path, "One")
    linked.select_set(True)
    bpy.context.view_layer.update()
    return local, linked


def test_shapes_of_one_name_are_told_apart(namesakes):
    local, linked = namesakes
    assert bpy.ops.convwass.morph_guides_from_names(kind="GROUPS") == {"FINISHED"}
    (item,) = guides().items
    assert item.vertices == {local: 1, linked: 6}
    assert item.problem is None
    with pytest.raises(RuntimeError, match=r"Vertex 6 of One is already in guide 1"):
        bpy.ops.convwass.add_morph_guide(points='{"One": 2, "One [library.blend]": 6}')
    assert bpy.ops.convwass.add_morph_guide(points='{"One": 6, "One [library.blend]": 1}') == {"FINISHED"}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    shapes = [triangle_mesh(obj, depsgraph) for obj in (linked, local)]
    assert guides_of_shapes(guides().named, (linked, local), shapes, depsgraph) == [{0: 6, 1: 1}, {0: 1, 1: 6}]


def test_guides_of_shapes_of_one_name_are_stored_and_come_back(namesakes):
    bpy.ops.convwass.morph_guides_from_names(kind="GROUPS")
    before = [item.vertices for item in guides().items]
    assert bake(motion="TRANSPORT") == {"FINISHED"}
    bpy.ops.convwass.clear_morph_guides()
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    assert [item.vertices for item in guides().items] == before


def test_guides_come_back_on_a_linked_shape_although_a_local_one_has_its_name_now(namesakes):
    local, linked = namesakes
    # Without the local object, the linked one has the plain name for its own.
    local.name = "Later"
    local.select_set(False)
    bpy.data.objects["Two"].select_set(True)
    assert bpy.ops.convwass.add_morph_guide(points='{"One": 6, "Two": 5}') == {"FINISHED"}
    before = [item.vertices for item in guides().items]
    assert before == [{linked: 6, bpy.data.objects["Two"]: 5}]
    assert bake(motion="TRANSPORT") == {"FINISHED"}
    assert stored_guides()[0]["points"] == {"One": 6, "Two": 5}
    local.name = "One"
    assert bpy.data.objects["One"] == local
    morph_frame = bpy.context.object
    for clear in (True, False):
        if clear:
            bpy.ops.convwass.clear_morph_guides()
        bpy.context.view_layer.objects.active = morph_frame
        assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
        assert [item.vertices for item in guides().items] == before


def test_guides_stay_with_a_shape_that_is_renamed_or_gets_a_namesake(cubes, tmp_path):
    bpy.ops.convwass.add_morph_guide(points='{"One": 3, "Two": 5}')
    path = str(tmp_path / "library.blend")
    bpy.data.libraries.write(path, {cubes[0]})
    with bpy.data.libraries.load(path, link=True) as (_, wanted):
        wanted.objects = ["One"]
    cubes[0].name = "First"
    (item,) = guides().items
    assert dict(item.named.points) == {"First": 3, "Two": 5}
    assert object_of("One", [*wanted.objects, *cubes]) == wanted.objects[0]
    cubes[0].name = "One"
    assert object_of("One", [*wanted.objects, *cubes]) == cubes[0]
    # Stored before the other object had its name.
    assert object_of("One", [*wanted.objects, cubes[1]]) == wanted.objects[0]


def test_flat_shapes_take_no_guides(cubes):
    for obj in cubes:
        obj.scale.z = 0.0
    bpy.context.view_layer.update()
    bpy.ops.convwass.add_morph_guide(points='{"One": 3, "Two": 5}')
    with pytest.raises(RuntimeError, match="Flat shapes do not support guides"):
        bpy.ops.convwass.morph_guides_from_names(kind="GROUPS")
    assert bake(motion="TRANSPORT", flat_resolution=64) == {"FINISHED"}
    assert stored_guides() == []


def positions(obj, vertex):
    return tuple(round(own, 4) for own in obj.data.vertices[vertex].co)


@pytest.fixture
def balls(empty_scene):
    """Two spheres with a guide at their poles and another one, both baked."""
    found = [
        add("ico_sphere", name, subdivisions=3, location=(place, 0.0, 0.0))
        for name, place in (("One", 0.0), ("Two", 4.0))
    ]
    for obj in found:
        obj.select_set(True)
    bpy.ops.convwass.add_morph_guide(label="pole", points='{"One": 11, "Two": 11}')
    assert bake(motion="TRANSPORT", hide_inputs=False) == {"FINISHED"}
    return found


@pytest.mark.parametrize("how", ["deleted", "extended", "scaled and deleted", "moved and deleted"])
def test_a_guide_stays_where_it_was_clicked_when_vertices_are_added_or_deleted(balls, how):
    one, (item,) = balls[0], guides().items
    pole = positions(one, 11)
    if how == "scaled and deleted":
        one.scale = (100.0, 100.0, 100.0)
        bpy.context.view_layer.update()
        item.place(one, 11)
        one.data.transform(one.matrix_world)
        one.scale = (1.0, 1.0, 1.0)
        pole = positions(one, 11)
    if how == "moved and deleted":
        one.location.z = 7.0
    bpy.context.view_layer.update()
    if how == "extended":
        edited(one, lambda bm: [bm.verts.new((0.0, 0.0, -5.0)) for _ in range(9)])
    edited(one, without(*range(5)))
    now = item.vertices[one]
    assert now != 11 and positions(one, now) == pole
    assert item.vertices[balls[1]] == 11
    assert item.problem is None
    stored = stored_guides()
    assert stored[0]["points"] == {"One": 11, "Two": 11}
    if how == "scaled and deleted":
        return
    assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
    assert stored_guides()[0]["points"] == {"One": now, "Two": 11}
    bpy.ops.convwass.clear_morph_guides()
    bpy.ops.convwass.select_morph_inputs()
    assert [own.vertices for own in guides().items] == [{one: now, balls[1]: 11}]


def test_a_guide_stays_on_a_vertex_that_is_moved_before_others_are_deleted(balls):
    one, (item,) = balls[0], guides().items
    one.data.vertices[11].co.z += 0.9
    assert item.vertices[one] == 11
    # A bake stores where it is now.
    select_only(*balls)
    assert bake(motion="TRANSPORT", hide_inputs=False) == {"FINISHED"}
    edited(one, without(*range(5)))
    assert positions(one, item.vertices[one])[2] == pytest.approx(1.9, abs=0.06)


def test_a_guide_stays_where_it_was_clicked_when_vertices_are_sorted(balls):
    one, (item,) = balls[0], guides().items
    pole = positions(one, 11)
    edited(one, reversed_order)
    assert item.vertices[one] == len(one.data.vertices) - 12
    assert positions(one, item.vertices[one]) == pole


def without_an_edge(bm):
    bm.edges.ensure_lookup_table()
    bm.edges.remove(bm.edges[0])


def test_a_guide_keeps_its_vertex_when_a_symmetric_shape_is_turned_or_loses_an_edge(balls):
    one, (item,) = balls[0], guides().items
    one.data.transform(Matrix.Rotation(math.pi, 4, "X"))
    assert item.vertices[one] == 11
    edited(one, without_an_edge)
    one.data.transform(Matrix.Translation((0.0, 0.0, 9.0)))
    assert item.vertices[one] == 11


def test_a_guide_whose_vertex_is_deleted_is_at_the_nearest_one(balls):
    one, (item,) = balls[0], guides().items
    edited(one, without(11))
    assert 0.9 < one.data.vertices[item.vertices[one]].co.z < 1.0


def test_a_guide_on_a_part_that_is_deleted_is_refused(balls):
    one, (item,) = balls[0], guides().items
    edited(one, lambda bm: without(*(own.index for own in bm.verts if own.co.z > 0.0))(bm))
    assert item.vertices[one] is None
    assert str(item.problem) == "The point on One was deleted"
    select_only(*balls)
    with pytest.raises(RuntimeError, match="Guide pole was on a part of One that was deleted; pick the point again"):
        bake(motion="GUIDED")


def test_damaged_places_are_refused():
    for place in (3, {"count": 3, "local": [0, 0], "world": [0, 0, 0]}, {"count": "x", "local": [], "world": []}):
        with pytest.raises(InputError, match="cannot be read"):
            parsed_guides(json.dumps([{"points": {"One": 1}, "places": {"One": place}}]))
