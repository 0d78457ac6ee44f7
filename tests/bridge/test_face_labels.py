# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.computation import Computation
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.morphs.job import MorphJob
from convwass_addon.bridge.objects import labeled_mesh, triangle_mesh
from convwass_addon.errors import InputError


def by_name(read):
    """The name of every triangle's part, empty without a part."""
    return [read.labels.names[index] if index >= 0 else "" for index in read.labels.faces]


def groups_of(obj, **weights):
    for name, of_vertices in weights.items():
        group = obj.vertex_groups.new(name=name)
        for vertex, weight in of_vertices.items():
            group.add([vertex], weight, "REPLACE")


def halved(make_object, name, first="top", second="bottom"):
    """An octahedron whose faces with vertex 4 are one group and those with vertex 5 the other."""
    obj = make_object(name)
    groups_of(obj, **{first: {4: 1.0}, second: {5: 1.0}, "equator": dict.fromkeys(range(4), 0.3)})
    for vertex in range(4):
        for group in (first, second):
            obj.vertex_groups[group].add([vertex], 0.35, "REPLACE")
    return obj


def upper(mesh):
    return mesh.corners[:, :, 2].mean(axis=1) > 0


def test_the_heaviest_group_of_a_triangle_counts(make_object, depsgraph):
    obj = halved(make_object, "A")
    read = labeled_mesh(obj, depsgraph, "vertex-groups")
    assert by_name(read) == ["top" if up else "bottom" for up in upper(read.mesh)]


def test_groups_need_sufficient_weights(make_object, depsgraph):
    obj = make_object("A")
    groups_of(obj, faint=dict.fromkeys(range(5), 0.25))
    assert set(by_name(labeled_mesh(obj, depsgraph, "vertex-groups"))) == {""}
    obj.vertex_groups["faint"].add([4, 0, 2], 0.6, "REPLACE")
    read = labeled_mesh(obj, depsgraph, "vertex-groups")
    chosen = np.array([name == "faint" for name in by_name(read)])
    np.testing.assert_array_equal(chosen, (np.sort(read.mesh.faces, axis=1) == [0, 2, 4]).all(axis=1))


@pytest.mark.parametrize("kind", ["vertex-groups", "materials"])
def test_an_object_without_any_has_no_parts(make_object, depsgraph, kind):
    read = labeled_mesh(make_object("A"), depsgraph, kind)
    assert read.labels.names == ()
    assert set(read.labels.faces) == {-1}


def test_modifiers_carry_groups_along(make_object, depsgraph):
    obj = halved(make_object, "A")
    obj.scale = (-1, 1, 1)
    obj.modifiers.new("Subdivision", "SUBSURF").levels = 2
    read = labeled_mesh(obj, depsgraph, "vertex-groups")
    plain = triangle_mesh(obj, depsgraph)
    np.testing.assert_array_equal(read.mesh.vertices, plain.vertices)
    np.testing.assert_array_equal(read.mesh.faces, plain.faces)
    names, height = np.array(by_name(read)), read.mesh.corners[:, :, 2].mean(axis=1)
    assert len(names) > 100
    assert set(names[height > 0.3]) == {"top"}
    assert set(names[height < -0.3]) == {"bottom"}


def with_materials(obj, *names):
    for name in names:
        obj.data.materials.append(name and bpy.data.materials.new(name))
    return [slot.material.name if slot.material else "" for slot in obj.material_slots]


def test_materials_of_faces(make_object, depsgraph):
    obj = make_object("A")
    with_materials(obj, "Red", None, "Green")
    obj.data.polygons.foreach_set("material_index", [0, 0, 1, 1, 2, 2, 2, 7])
    read = labeled_mesh(obj, depsgraph, "materials")
    assert by_name(read) == ["Red", "Red", "", "", "Green", "Green", "Green", "Green"]


def test_numbers_that_blender_added_do_not_part_materials(make_object, depsgraph):
    first, second = make_object("A"), make_object("B")
    assert with_materials(first, "Head") == ["Head"]
    assert with_materials(second, "Head") == ["Head.001"]
    for obj in (first, second):
        assert set(by_name(labeled_mesh(obj, depsgraph, "materials"))) == {"Head"}


def test_materials_of_one_object_that_differ_by_a_number_only_stay_two(make_object, depsgraph):
    obj = make_object("A")
    assert with_materials(obj, "Head", "Head") == ["Head", "Head.001"]
    obj.data.polygons[3].material_index = 1
    assert by_name(labeled_mesh(obj, depsgraph, "materials"))[2:5] == ["Head", "Head.001", "Head"]


def test_materials_of_the_object_count_before_those_of_the_mesh(make_object, depsgraph):
    obj = make_object("A")
    with_materials(obj, "Of the mesh")
    obj.material_slots[0].link = "OBJECT"
    obj.material_slots[0].material = bpy.data.materials.new("Of the object")
    assert set(by_name(labeled_mesh(obj, depsgraph, "materials"))) == {"Of the object"}


def test_groups_survive_being_read_from_a_file(make_object, tmp_path, depsgraph):
    expected = by_name(labeled_mesh(halved(make_object, "A"), depsgraph, "vertex-groups"))
    path = tmp_path / "groups.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    (obj,) = import_objects(path, ["A"])
    assert by_name(labeled_mesh(obj, bpy.context.evaluated_depsgraph_get(), "vertex-groups")) == expected


def job_of(objects, parts):
    settings = MorphSettings(motion="transport", resolution=40, parts=parts)
    return MorphJob(objects, path_blends(2, 2), settings, {}, 1)


def test_a_job_lets_parts_travel(make_object):
    """Upside down: each half of the octahedron moves to the other side, so that both are in the middle halfway."""
    objects = [halved(make_object, "A"), halved(make_object, "B", "bottom", "top")]
    extents = {}
    for parts in ("none", "vertex-groups"):
        job = job_of(objects, parts)
        for step in job.steps(computation=Computation(workers=1)):
            job.write(step)
            if step.payload and step.payload.mesh:
                extents[parts] = np.ptp(step.payload.mesh.bounds, axis=0)[2]
        assert job.notices == []
        job.discard()
    assert extents["none"] > 1.7
    assert extents["vertex-groups"] < 0.75 * extents["none"]


def test_a_job_reports_parts_that_it_left_out(make_object):
    objects = [halved(make_object, "A"), halved(make_object, "B", "top", "belly")]
    job = job_of(objects, "vertex-groups")
    for step in job.steps(computation=Computation(workers=1)):
        job.write(step)
    assert [str(notice) for notice in job.notices] == [
        "belly is not on every shape and travels with the rest.",
        "bottom is not on every shape and travels with the rest.",
    ]
    job.discard()


def test_a_job_without_common_parts_leaves_nothing_behind(make_object, inventory):
    objects = [halved(make_object, "A"), make_object("B")]
    before = inventory()
    with pytest.raises(InputError, match=r"A has bottom, top; B has none"):
        job_of(objects, "vertex-groups")
    assert inventory() == before


def test_the_first_of_equally_heavy_groups_counts(make_object, depsgraph, inventory):
    obj = make_object("A")
    everywhere = dict.fromkeys(range(6), 0.5)
    groups_of(obj, second={}, first=everywhere, third=everywhere)
    before = inventory()
    assert set(by_name(labeled_mesh(obj, depsgraph, "vertex-groups"))) == {"first"}
    assert inventory() == before
