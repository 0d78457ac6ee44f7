# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reading files: one object per shape, nothing else, and clear words for what cannot be read."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.files.imports import READERS, Source, checked_file, import_objects, parse_source
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.bridge.flat.flat_objects import read_rings
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import InputError
from tests.scene import linked

# Blender's own add-on for glTF uses what newer versions of numpy and Python advise against.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

WRITERS = {
    ".obj": lambda file: bpy.ops.wm.obj_export(filepath=file),
    ".ply": lambda file: bpy.ops.wm.ply_export(filepath=file),
    ".stl": lambda file: bpy.ops.wm.stl_export(filepath=file),
    ".gltf": lambda file: bpy.ops.export_scene.gltf(filepath=file, export_format="GLTF_SEPARATE"),
    ".glb": lambda file: bpy.ops.export_scene.gltf(filepath=file),
    ".fbx": lambda file: bpy.ops.export_scene.fbx(filepath=file),
    ".usd": lambda file: bpy.ops.wm.usd_export(filepath=file),
    ".usda": lambda file: bpy.ops.wm.usd_export(filepath=file),
    ".usdc": lambda file: bpy.ops.wm.usd_export(filepath=file),
    ".usdz": lambda file: bpy.ops.wm.usd_export(filepath=file),
    ".abc": lambda file: bpy.ops.wm.alembic_export(filepath=file),
}


@pytest.fixture
def two_parts(make_object):
    """Add two shapes, one of them moved and stretched, a camera and an Empty to the scene."""
    a, b = make_object("A"), make_object("B")
    b.location, b.scale = (5, 0, 1), (1, 1, 2)
    a.data.materials.append(bpy.data.materials.new("Paint"))
    a.data.uv_layers.new(name="UVMap")
    for other in (bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera")), bpy.data.objects.new("Empty", None)):
        bpy.context.scene.collection.objects.link(other)


def start_anew():
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)


def scene_state():
    scene = bpy.context.scene
    return scene.name, scene.frame_start, scene.frame_end, scene.frame_current, scene.render.fps


def test_all_formats_are_tried():
    assert WRITERS.keys() == READERS.keys()


@pytest.mark.parametrize("suffix", WRITERS)
def test_parts_are_joined_in_place(two_parts, make_object, tmp_path, suffix, inventory):
    file = tmp_path / f"My shape{suffix}"
    WRITERS[suffix](str(file))
    start_anew()
    make_object("A").select_set(True)
    before, state = inventory(), scene_state()
    (obj,) = import_objects(file, None)
    assert obj.name == obj.data.name == "My shape"
    assert obj.name in bpy.context.scene.collection.objects
    assert {kind for kind, _ in inventory() - before} <= {"OBJECT", "MESH", "MATERIAL"}
    assert [block.name for block in bpy.data.objects] == ["A", "My shape"]
    assert scene_state() == state
    assert [other.name for other in bpy.context.selected_objects] == ["A"]
    mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    assert len(mesh.faces) == 16
    np.testing.assert_allclose(mesh.bounds, [[-1, -1, -1], [6, 1, 3]], atol=1e-4)
    assert mesh.volume == pytest.approx(4 / 3 * 3, rel=1e-4)


@pytest.mark.parametrize("suffix", [".obj", ".glb", ".usdc"])
def test_materials_stay(two_parts, tmp_path, suffix):
    WRITERS[suffix](str(tmp_path / f"a{suffix}"))
    start_anew()
    (obj,) = import_objects(tmp_path / f"a{suffix}", None)
    assert "Paint" in [material.name for material in obj.data.materials if material]


def test_textures_stay(make_object, tmp_path):
    obj = make_object("A")
    material = bpy.data.materials.new("Textured")
    nodes = own_tree(material).nodes
    picture = nodes.new("ShaderNodeTexImage")
    picture.image = bpy.data.images.new("Picture", 4, 4)
    picture.image.pack()
    shader = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
    material.node_tree.links.new(picture.outputs["Color"], shader.inputs["Base Color"])
    obj.data.materials.append(material)
    obj.data.uv_layers.new(name="UVMap")
    save_blend(tmp_path / "a.blend")
    start_anew()
    import_objects(tmp_path / "a.blend", None)
    assert "Picture" in bpy.data.images


def test_objects_of_a_blend(two_parts, tmp_path, make_object, inventory):
    bpy.data.objects["B"].modifiers.new("Subdivision", "SUBSURF").levels = 1
    parent = bpy.data.objects["Empty"]
    parent.location = (0, 10, 0)
    bpy.data.objects["B"].parent = parent
    save_blend(tmp_path / "a.blend")
    start_anew()
    make_object("B")
    b, a = import_objects(tmp_path / "a.blend", ["B", "A"])
    assert (b.name, a.name) == ("B.001", "A")
    assert {kind for kind, _ in inventory()} - {"SCENE", "WORKSPACE", "SCREEN", "WINDOWMANAGER"} <= {
        *("OBJECT", "MESH", "MATERIAL", "BRUSH", "LINESTYLE", "PALETTE", "WORLD")
    }
    mesh = triangle_mesh(b, bpy.context.evaluated_depsgraph_get())
    assert len(mesh.faces) > 16
    np.testing.assert_allclose(mesh.bounds.mean(axis=0), [5, 10, 1], atol=1e-5)


def test_a_collection_of_a_blend_is_one_shape(two_parts, tmp_path, inventory):
    collection = bpy.data.collections.new("Both")
    for name in "AB":
        collection.objects.link(bpy.data.objects[name])
    bpy.data.libraries.write(str(tmp_path / "both.blend"), {collection})
    start_anew()
    before = inventory()
    (obj,) = import_objects(tmp_path / "both.blend", ["Both"])
    assert {kind for kind, _ in inventory() - before} <= {"OBJECT", "MESH", "MATERIAL"}
    mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
    assert mesh.volume == pytest.approx(4 / 3 * 3, rel=1e-4)


def test_a_sheared_text_of_a_blend_keeps_its_shape(tmp_path):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    text, parent = linked("Word", bpy.data.curves.new("Word", "FONT")), linked("Stretch", None)
    text.data.body, text.parent, text.rotation_euler.z, parent.scale.x = "L", parent, 0.6, 3.0
    expected = flat_points(text)
    save_blend(tmp_path / "word.blend")
    start_anew()
    (obj,) = import_objects(tmp_path / "word.blend", ["Word"])
    assert (obj.type, obj.data.body) == ("FONT", "L")
    np.testing.assert_allclose(flat_points(obj), expected, atol=1e-5)


def flat_points(obj):
    return read_rings(obj, bpy.context.evaluated_depsgraph_get()).points


def test_same_object_twice(two_parts, tmp_path):
    save_blend(tmp_path / "a.blend")
    start_anew()
    assert [obj.name for obj in import_objects(tmp_path / "a.blend", ["A", "A"])] == ["A", "A.001"]


def test_only_mesh_of_a_blend(make_object, tmp_path):
    make_object("Only")
    save_blend(tmp_path / "a.blend")
    start_anew()
    assert [obj.name for obj in import_objects(tmp_path / "a.blend", None)] == ["Only"]


def refused(file, names, match):
    before = {(block.id_type, block.name) for block in bpy.data.user_map()}
    state = scene_state()
    with pytest.raises(InputError, match=match):
        import_objects(file, names)
    assert {(block.id_type, block.name) for block in bpy.data.user_map()} == before
    assert scene_state() == state


def test_several_meshes_in_a_blend(two_parts, tmp_path):
    save_blend(tmp_path / "a.blend")
    refused(tmp_path / "a.blend", None, r"2 meshes; name one as a\.blend:NAME, of A, B")


def test_no_such_object(two_parts, tmp_path):
    save_blend(tmp_path / "a.blend")
    refused(tmp_path / "a.blend", ["A", "C"], "no object or collection 'C'; it contains A, B, Camera, Empty")


def test_many_objects_are_not_all_listed(make_object, tmp_path):
    for number in range(30):
        make_object(f"Part {number:02d}")
    save_blend(tmp_path / "a.blend")
    refused(tmp_path / "a.blend", ["C"], "Part 19 and 10 more")


def test_named_object_that_is_no_mesh(two_parts, tmp_path):
    save_blend(tmp_path / "a.blend")
    start_anew()
    refused(
        tmp_path / "a.blend",
        ["Camera"],
        "Camera is not a mesh but of type camera, which cannot become one; choose a mesh",
    )


def test_no_mesh_inside(tmp_path):
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "POINT")))
    save_blend(tmp_path / "a.blend")
    WRITERS[".usdc"](str(tmp_path / "a.usdc"))
    start_anew()
    refused(tmp_path / "a.blend", None, r"a\.blend contains no mesh, only light \(1\); choose a file with one")
    refused(tmp_path / "a.usdc", None, r"a\.usdc contains no mesh, only .*light \(1\)")


def test_mesh_without_faces(tmp_path):
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nl 1 2\n")
    refused(tmp_path / "a.obj", None, "edges but no faces")


@pytest.mark.parametrize("suffix", [*READERS, ".blend"])
def test_damaged_file(tmp_path, suffix):
    file = tmp_path / f"broken{suffix}"
    file.write_bytes(b"\x00garbage\xff" * 50)
    refused(file, None, f"broken{suffix} (could not be read|contains no mesh)")


@pytest.mark.parametrize("suffix", [".obj", ".ply", ".glb", ".usdc", ".blend"])
def test_empty_file(tmp_path, suffix):
    (tmp_path / f"a{suffix}").touch()
    refused(tmp_path / f"a{suffix}", None, "empty file")


def test_missing_file(tmp_path):
    refused(tmp_path / "a.obj", None, "does not exist")


def test_folder(tmp_path):
    refused(tmp_path, None, "is a folder")


@pytest.mark.skipif(sys.platform == "win32", reason="named pipes are POSIX")
def test_pipe(tmp_path):
    os.mkfifo(tmp_path / "a.obj")
    # A writer, since opening the pipe would wait for one.
    writer = os.open(tmp_path / "a.obj", os.O_RDWR)
    try:
        os.write(writer, b"v 0 0 0")
        with pytest.raises(InputError, match="is a pipe or a device"):
            checked_file(tmp_path / "a.obj", None, READERS)
    finally:
        os.close(writer)


def test_unknown_format(tmp_path):
    (tmp_path / "a.docx").write_text("x")
    refused(tmp_path / "a.docx", None, r"a\.docx is of an unknown format; supported formats: \.obj .*\.blend")


def test_name_in_another_format(tmp_path):
    (tmp_path / "a.obj").write_text("x")
    refused(tmp_path / "a.obj", ["A"], "only .blend files support object names")


def test_file_that_may_not_be_read(tmp_path, monkeypatch):
    (tmp_path / "a.obj").write_text("x")

    def denied(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", denied)
    refused(tmp_path / "a.obj", None, "cannot be opened: Permission denied")


@pytest.mark.parametrize(
    ("text", "path", "name"),
    [
        ("a.obj", "a.obj", None),
        ("a.blend", "a.blend", None),
        ("a.blend:Cube", "a.blend", "Cube"),
        ("dir/a.BLEND:Cube: the second", "dir/a.BLEND", "Cube: the second"),
        (r"C:\shapes\a.obj", r"C:\shapes\a.obj", None),
        (r"C:\shapes\a.blend", r"C:\shapes\a.blend", None),
        (r"C:\shapes\a.blend:Cube", r"C:\shapes\a.blend", "Cube"),
        ("a.blend:b.blend:c", "a.blend", "b.blend:c"),
        ("a.blender:x.obj", "a.blender:x.obj", None),
    ],
)
def test_sources(text, path, name):
    assert parse_source(text) == Source(Path(path), name)


def test_source_without_name():
    with pytest.raises(InputError, match="name an object"):
        parse_source("a.blend:")
