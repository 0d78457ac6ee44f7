# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides of the command line are points of the meshes in the files, as in Blender."""

from __future__ import annotations

import json

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.files.imports import live_shape
from convwass_addon.bridge.flat.flat_imports import imported_shape
from convwass_addon.bridge.morphs.inputs.guides_of_files import guides_asked_for
from convwass_addon.bridge.morphs.inputs.morph_guides import NamedGuide, guides_from_bones, guides_of_shapes
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import InputError

NAMES = ("Man", "Woman")


def add_person(name, place):
    """Add a smoothed cube with a rig of one bone, a mark and an Empty."""
    bpy.ops.mesh.primitive_cube_add(location=(place, 0, 0), rotation=(0, 0, 0.3))
    obj = bpy.context.object
    obj.name = name
    obj.vertex_groups.new(name="nose").add([5], 1.0, "REPLACE")
    bpy.ops.object.armature_add(location=(place, 0, 0))
    rig = bpy.context.object
    rig.name = f"{name} Rig"
    obj.modifiers.new("Rig", "ARMATURE").object = rig
    obj.modifiers.new("Smooth", "SUBSURF").levels = 2
    tip = bpy.data.objects.new("Tip", None)
    tip.location = (1, 1, 1)
    tip.parent = obj
    bpy.context.scene.collection.objects.link(tip)


@pytest.fixture
def people(tmp_path, empty_scene):
    """Two people in a .blend."""
    for place, name in enumerate(NAMES):
        add_person(name, 4.0 * place)
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "people.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return tmp_path / "people.blend"


def points_in_blender(file, guides):
    """Return the points of guides on the shapes, as a bake in the opened file uses them."""
    bpy.ops.wm.open_mainfile(filepath=str(file))
    objects, depsgraph = [bpy.data.objects[name] for name in NAMES], bpy.context.evaluated_depsgraph_get()
    guides = guides or guides_from_bones(objects, depsgraph)
    shapes = [triangle_mesh(obj, depsgraph) for obj in objects]
    found = guides_of_shapes(guides, objects, shapes, depsgraph)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return [[shapes[number].vertices[vertex] for number, vertex in sorted(guide.items())] for guide in found]


def points_from(file, word, read):
    """Return the points of guides on imported shapes, and check that nothing else is left in the scene."""
    texts = [f"{file}:{name}" for name in NAMES]
    inputs = [obj for text in texts for obj in read(text)]
    before = set(bpy.data.objects)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    guides = guides_asked_for(word, texts, inputs, depsgraph)
    assert set(bpy.data.objects) == before
    shapes = [triangle_mesh(obj, depsgraph) for obj in inputs]
    found = guides_of_shapes(guides, inputs, shapes, depsgraph)
    return [[shapes[number].vertices[vertex] for number, vertex in sorted(guide.items())] for guide in found]


@pytest.mark.parametrize("read", [imported_shape, live_shape])
def test_numbers_are_those_of_the_mesh_before_modifiers(people, tmp_path, read):
    corners = [NamedGuide("corner", {"Man": 3, "Woman": 6}), NamedGuide("", {"Man": 0, "Woman": 7})]
    file = tmp_path / "guides.json"
    file.write_text(json.dumps([guide.as_dict() for guide in corners]))
    expected = points_in_blender(people, corners)
    assert np.linalg.norm(expected[0][0] - expected[1][0]) > 1.0
    np.testing.assert_allclose(points_from(people, str(file), read), expected, atol=1e-6)


@pytest.mark.parametrize("read", [imported_shape, live_shape])
@pytest.mark.parametrize("word", ["groups", "empties", "bones"])
def test_groups_empties_and_bones_of_the_file_are_used(people, word, read):
    known = {
        "groups": [NamedGuide("nose", dict.fromkeys(NAMES, 5))],
        "empties": [NamedGuide("", dict.fromkeys(NAMES, 7))],
    }
    expected = points_in_blender(people, known.get(word))
    np.testing.assert_allclose(points_from(people, word, read), expected, atol=1e-6)


def test_a_tilde_is_the_home_folder(people, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.setenv("USERPROFILE", str(tmp_path))
    (tmp_path / "guides.json").write_text('[{"points": {"Man": 3, "Woman": 3}}]')
    assert len(points_from(people, "~/guides.json", imported_shape)) == 1


def test_a_vertex_that_only_the_modifiers_make_is_refused(people, tmp_path):
    file = tmp_path / "guides.json"
    file.write_text('[{"points": {"Man": 3, "Woman": 40}}]')
    with pytest.raises(InputError, match="Guide 1 refers to vertex 40 of Woman, which has 8 vertices"):
        points_from(people, str(file), imported_shape)


def test_imported_files_and_meshes_without_faces_are_used_as_they_are(tmp_path, empty_scene):
    """Only a Screw modifier gives the stick a surface."""
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.wm.ply_export(filepath=str(tmp_path / "cube.ply"))
    mesh = bpy.data.meshes.new("Stick")
    mesh.from_pydata([(1, 0, 0), (1, 0, 1)], [(0, 1)], [])
    obj = bpy.data.objects.new("Stick", mesh)
    bpy.context.scene.collection.objects.link(obj)
    obj.modifiers.new("Screw", "SCREW")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "stick.blend"))
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    texts = [str(tmp_path / "cube.ply"), f"{tmp_path / 'stick.blend'}:Stick"]
    inputs = [obj for text in texts for obj in imported_shape(text)]
    file = tmp_path / "guides.json"
    file.write_text('[{"name": "end", "points": {"cube": 5, "Stick": 4}}]')
    found = guides_asked_for(str(file), texts, inputs, bpy.context.evaluated_depsgraph_get())
    assert [(guide.name, guide.points) for guide in found] == [("end", {"cube": 5, "Stick": 4})]
    assert {name: place.count for name, place in found[0].places.items()} == {"cube": 14, "Stick": 32}
