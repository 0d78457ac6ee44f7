# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A mesh with shape keys in files for other programs."""

from __future__ import annotations

import errno
import json
import re
import shutil
import struct
import sys
import zipfile
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.applications.one_mesh.vertex_textures import TextureGrid, y_up
from convwass_addon.bridge.keyframes import curves_of, interpolate
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh.key_files import KEY_FORMATS, export_shape_keys
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from convwass_addon.errors import ConvwassError, InputError
from tests.pictures import pixels_in
from tests.scene import linked, world
from tests.vertex_textures import gathered, joined_steps, unpacked_normals

# Blender's own add-ons use what newer versions of NumPy and Python advise against.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

FRAMES = 4
UP, ASIDE = np.array([0.0, 0.0, 2.0]), np.array([1.0, 0.0, 1.0])


@pytest.fixture
def keyed(make_object, octahedron):
    """Return an octahedron that moves sideways and up in frames 3 to 7 by two shape keys, the first at value 0.5."""
    source = make_object("Shape")
    source.color = (0.8, 0.2, 0.1, 1.0)
    rest = octahedron.vertices
    path = KeyPath("Up", (0.5, 1.0), np.stack([rest + ASIDE, rest + UP]), 0.9, 0.0, 0.0, 0.0, 0)
    obj = object_with_keys(source, source.data.copy(), [path], bpy.context.scene)
    animate_sliders(obj, ["Up"], 3, FRAMES)
    interpolate(curves_of(obj))
    return obj


def expected_shift(t):
    return 2.0 * t * ASIDE if t <= 0.5 else 2.0 * (1.0 - t) * ASIDE + (2.0 * t - 1.0) * UP


def read_glb(file):
    data = file.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def accessor(head, body, index):
    found = head["accessors"][index]
    view = head["bufferViews"][found["bufferView"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[found["type"]]
    kind = {5126: np.float32, 5125: np.uint32, 5123: np.uint16}[found["componentType"]]
    return np.frombuffer(body, kind, found["count"] * width, view.get("byteOffset", 0)).reshape(-1, width)


def test_gltf_has_the_keys_as_morph_targets_and_an_animation_of_their_weights(keyed, tmp_path, inventory):
    before = inventory()
    (file,) = export_shape_keys(keyed, tmp_path / "keys.glb")
    assert inventory() == before
    head, body = read_glb(file)
    (mesh,) = head["meshes"]
    assert mesh["extras"]["targetNames"] == ["Up 1", "Up 2"]
    targets = mesh["primitives"][0]["targets"]
    for target, shift in zip(targets, (ASIDE, UP), strict=True):
        moved = accessor(head, body, target["POSITION"])
        np.testing.assert_allclose(moved, np.broadcast_to(y_up(shift), moved.shape), atol=1e-6)
    (material,) = head["materials"]
    color = material["pbrMetallicRoughness"]["baseColorFactor"]
    np.testing.assert_allclose(color, [0.8, 0.2, 0.1, 1.0], atol=1e-6)
    (animation,) = head["animations"]
    (channel,) = animation["channels"]
    assert channel["target"]["path"] == "weights"
    sampler = animation["samplers"][channel["sampler"]]
    times = accessor(head, body, sampler["input"]).ravel() * bpy.context.scene.render.fps
    weights = accessor(head, body, sampler["output"]).reshape(-1, 2)
    np.testing.assert_allclose(times, np.arange(FRAMES + 1), atol=1e-4)
    np.testing.assert_allclose(weights, [[0, 0], [0.5, 0], [1, 0], [0.5, 0.5], [0, 1]], atol=1e-6)


@pytest.mark.parametrize("file", ["keys.glb", "keys_mesh.glb"])
def test_files_have_the_material_that_the_object_has_in_place_of_that_of_its_mesh(keyed, tmp_path, file):
    (slot,) = keyed.material_slots
    slot.link, slot.material = "OBJECT", bpy.data.materials.new("Own")
    export_shape_keys(keyed, (tmp_path / "keys").with_suffix(".glb" if file == "keys.glb" else ".json"))
    head, _ = read_glb(tmp_path / file)
    assert [material["name"] for material in head["materials"]] == ["Own"]


@pytest.mark.parametrize("suffix", [".glb", ".fbx"])
def test_the_object_moves_in_files(keyed, tmp_path, suffix, inventory):
    carrier = bpy.data.objects.new("Carrier", None)
    bpy.context.scene.collection.objects.link(carrier)
    keyed.parent, keyed.location.x = carrier, 2.0
    for frame, turn in ((3, 0.0), (3 + FRAMES, np.pi / 2)):
        carrier.rotation_euler.z = turn
        carrier.keyframe_insert("rotation_euler", frame=frame)
    before = inventory()
    (file,) = export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    assert inventory() == before
    frames = [3, 4, 3 + FRAMES]
    expected = []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        expected.append(keyed.matrix_world.to_translation())
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    read = bpy.ops.import_scene.gltf if suffix == ".glb" else bpy.ops.import_scene.fbx
    read(filepath=str(file))
    (obj,) = [one for one in bpy.data.objects if one.type == "MESH"]
    first = 0 if suffix == ".glb" else 1
    for frame, place in zip(frames, expected, strict=True):
        bpy.context.scene.frame_set(frame - 3 + first)
        np.testing.assert_allclose(obj.matrix_world.to_translation(), place, atol=1e-3)
    assert obj.data.shape_keys.key_blocks[2].value == pytest.approx(1.0, abs=1e-3)


@pytest.mark.parametrize("suffix", [".glb", ".fbx"])
@pytest.mark.parametrize("turn", [0.0, np.pi / 2])
def test_a_sheared_object_keeps_its_shape_in_files(keyed, tmp_path, suffix, turn):
    """A turned child of an unevenly scaled parent has a matrix that no location, rotation and scale give."""
    parent = linked("Stretch", None)
    parent.scale.x, keyed.parent, keyed.rotation_euler.y = 3.0, parent, 0.6
    for frame, angle in ((3, 0.0), (3 + FRAMES, turn)):
        parent.rotation_euler.z = angle
        parent.keyframe_insert("rotation_euler", frame=frame)
    frames, expected = [3, 4, 3 + FRAMES], []
    for frame in frames:
        bpy.context.scene.frame_set(frame)
        expected.append(world(keyed))
    (file,) = export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    read = bpy.ops.import_scene.gltf if suffix == ".glb" else bpy.ops.import_scene.fbx
    read(filepath=str(file))
    (obj,) = [one for one in bpy.data.objects if one.type == "MESH"]
    for frame, points in zip(frames, expected, strict=True):
        bpy.context.scene.frame_set(frame - 3 + (0 if suffix == ".glb" else 1))
        found = world(obj)
        for pick in (np.min, np.max):
            np.testing.assert_allclose(pick(found, axis=0), pick(points, axis=0), atol=1e-2)


def test_fbx_keeps_the_keys(keyed, tmp_path):
    (file,) = export_shape_keys(keyed, tmp_path / "keys.fbx")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.fbx(filepath=str(file))
    (obj,) = [one for one in bpy.data.objects if one.type == "MESH"]
    assert [key.name for key in obj.data.shape_keys.key_blocks][1:] == ["Up 1", "Up 2"]
    assert obj.data.shape_keys.animation_data.action is not None


def test_files_have_the_names_of_the_scene(keyed, tmp_path):
    """Copies are exported, whose names end in numbers as long as the originals have theirs."""
    keyed.name, keyed.data.name = "Hero", "Skin"
    before = {(type(own), own.name) for own in (keyed, keyed.data, *keyed.data.materials)}
    (file,) = export_shape_keys(keyed, tmp_path / "keys.glb")
    head, _ = read_glb(file)
    found = {kind: [own["name"] for own in head[kind]] for kind in ("nodes", "meshes", "materials", "animations")}
    materials = [own.name for own in keyed.data.materials]
    assert found == {"nodes": ["Hero"], "meshes": ["Skin"], "materials": materials, "animations": ["Hero Keys"]}
    assert {(type(own), own.name) for own in (keyed, keyed.data, *keyed.data.materials)} == before


def test_fbx_has_the_size_that_the_scene_gives_it(keyed, tmp_path):
    """In scenes in centimeters, exporters of Blender write a hundredth of the numbers."""
    bpy.context.scene.unit_settings.scale_length = 0.01
    size = np.array(keyed.dimensions)
    (file,) = export_shape_keys(keyed, tmp_path / "keys.fbx")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.import_scene.fbx(filepath=str(file))
    (obj,) = [one for one in bpy.data.objects if one.type == "MESH"]
    np.testing.assert_allclose(sorted(obj.dimensions), sorted(0.01 * size), rtol=1e-3)


@pytest.mark.parametrize(("moved", "first"), [(0, 3), (-5, 0)])
@pytest.mark.parametrize("suffix", [".usdc", ".usdz", ".abc"])
def test_caches_have_the_points_of_every_frame_and_velocities(keyed, tmp_path, suffix, octahedron, moved, first):
    """Those of an animation that begins before frame 0 begin there."""
    for point in (point for curve in curves_of(keyed) for point in curve.keyframe_points):
        point.co_ui.x += moved
    (file,) = export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    read = bpy.ops.wm.usd_import if suffix != ".abc" else bpy.ops.wm.alembic_import
    read(filepath=str(file))
    (obj,) = [one for one in bpy.data.objects if one.type == "MESH"]
    depsgraph, fps = bpy.context.evaluated_depsgraph_get(), bpy.context.scene.render.fps
    for number in range(FRAMES + 1):
        bpy.context.scene.frame_set(first + number)
        points = triangle_mesh(obj, depsgraph).vertices
        np.testing.assert_allclose(points, octahedron.vertices + expected_shift(number / FRAMES), atol=1e-5)
        if number in (0, FRAMES):
            evaluated = obj.evaluated_get(depsgraph)
            velocity = np.array(evaluated.matrix_world.to_3x3() @ evaluated.data.attributes["velocity"].data[0].vector)
            way = ASIDE if number == 0 else UP - ASIDE
            np.testing.assert_allclose(velocity, way / 2 * fps, atol=0.1)


def test_an_archive_contains_a_file_of_its_name(keyed, tmp_path, inventory):
    before = inventory()
    (file,) = export_shape_keys(keyed, tmp_path / "keys.usdz")
    assert zipfile.ZipFile(file).namelist() == ["keys.usdc"]
    assert inventory() == before and list(tmp_path.iterdir()) == [file]


def pixels(file):
    return pixels_in(file, as_data=True)[::-1, :, :3]


def decoded(record, folder):
    """Read textures as a shader does: positions by two bytes, positions as floats, and normals."""
    grid = TextureGrid(record["vertices"], record["frames"], record["texture"]["width"])
    bounds = np.array([record["bounds"]["low"], record["bounds"]["high"]])
    split = np.rint(255 * pixels(folder / record["files"]["positions_png"])).reshape(2, grid.height, grid.width, 3)
    packed = gathered(grid, 255 * pixels(folder / record["files"]["normals_png"]))
    exact = gathered(grid, pixels(folder / record["files"]["positions_exr"]))
    return joined_steps(np.stack([gathered(grid, half) for half in split]), bounds), exact, unpacked_normals(packed)


def glb_vertices(record, folder):
    head, body = read_glb(folder / record["files"]["mesh_glb"])
    attributes = head["meshes"][0]["primitives"][0]["attributes"]
    index = record["texture_coordinates"]["index"]
    u, v = accessor(head, body, attributes[f"TEXCOORD_{index}"]).T
    rows, columns = (v * record["texture"]["height"]).astype(int), (u * record["texture"]["width"]).astype(int)
    return rows * record["texture"]["width"] + columns, accessor(head, body, attributes["POSITION"])


def test_textures_of_a_mesh_with_keys_hold_its_frames(keyed, tmp_path, octahedron, inventory):
    before = inventory()
    files = export_shape_keys(keyed, tmp_path / "keys.json")
    assert inventory() == before and all(file.is_file() for file in files)
    record = json.loads(files[0].read_text())
    assert (record["topology"], record["frames"], record["vertices"]) == ("constant", FRAMES + 1, 6)
    points = np.stack([octahedron.vertices + expected_shift(n / FRAMES) for n in range(FRAMES + 1)])
    read, exact, normals = decoded(record, tmp_path)
    quantum = np.ptp(np.array(list(record["bounds"].values())), axis=0) / 65535
    assert (np.abs(read - y_up(points)) <= 0.5 * quantum + 1e-6).all()
    np.testing.assert_allclose(exact, y_up(points), atol=1e-6)
    np.testing.assert_allclose(normals, np.broadcast_to(y_up(octahedron.vertices), normals.shape), atol=1.01 / 255)
    vertices, places = glb_vertices(record, tmp_path)
    np.testing.assert_allclose(places, y_up(points[0])[vertices], atol=1e-6)


def test_textures_have_a_uv_map_of_their_own(keyed, tmp_path, octahedron):
    keyed.data.uv_layers.new(name="VAT", do_init=False)
    files = export_shape_keys(keyed, tmp_path / "keys.json")
    record = json.loads(files[0].read_text())
    assert record["texture_coordinates"] == {"name": "VAT.001", "index": 1}
    vertices, places = glb_vertices(record, tmp_path)
    np.testing.assert_allclose(places, y_up(octahedron.vertices)[vertices], atol=1e-6)
    while len(keyed.data.uv_layers) < 8:
        keyed.data.uv_layers.new(do_init=False)
    with pytest.raises(InputError, match="Shape Morph has eight UV maps; delete one"):
        export_shape_keys(keyed, tmp_path / "keys.json")


@pytest.mark.parametrize("place", ["object", "collection"])
def test_a_mesh_that_is_disabled_in_viewports_moves_in_files(keyed, tmp_path, place):
    """Blender evaluates neither its drivers nor its modifiers."""
    keyed.modifiers.new("Finer", "SUBSURF").levels = 1

    def written():
        export_shape_keys(keyed, tmp_path / "keys.glb")
        (record, *_) = export_shape_keys(keyed, tmp_path / "keys.json")
        return read_glb(tmp_path / "keys.glb")[1], decoded(json.loads(record.read_text()), tmp_path)[1]

    shown = written()
    home = bpy.data.collections.new("Home")
    bpy.context.scene.collection.children.link(home)
    home.objects.link(keyed)
    bpy.context.scene.collection.objects.unlink(keyed)
    (keyed if place == "object" else home).hide_viewport = True
    hidden = written()
    assert hidden[0] == shown[0]
    np.testing.assert_array_equal(hidden[1], shown[1])
    assert (keyed.hide_viewport, keyed.users_collection) == (place == "object", (home,))


def test_strips_of_the_sliders_are_exported(keyed, tmp_path):
    data = keyed.animation_data
    action, slot = data.action, data.action_slot
    strip = data.nla_tracks.new().strips.new("Slow", 10, action)
    strip.action_slot, strip.scale, data.action = slot, 2.0, None
    (file,) = export_shape_keys(keyed, tmp_path / "keys.glb")
    head, body = read_glb(file)
    sampler = head["animations"][0]["samplers"][0]
    weights = accessor(head, body, sampler["output"]).reshape(-1, 2)
    assert len(weights) == 2 * FRAMES + 1
    np.testing.assert_allclose(weights[:: 2 * FRAMES], [[0, 0], [0, 1]], atol=1e-6)


@pytest.mark.parametrize("suffix", KEY_FORMATS)
def test_there_must_be_room_for_the_file(keyed, tmp_path, monkeypatch, suffix):
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=1 << 20))
    with pytest.raises(ConvwassError, match="of free space"):
        export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("suffix", [".glb", ".json"])
def test_an_error_of_an_exporter_is_told_without_its_traceback(keyed, tmp_path, monkeypatch, suffix):
    def full(*_args, **_options):
        raise OSError(errno.ENOSPC, "No space left on device")

    export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr(sys.modules["io_scene_gltf2.blender.exp.export"], "save", full)
    with pytest.raises(ConvwassError) as caught:
        export_shape_keys(keyed, tmp_path / f"keys{suffix}")
    said = str(caught.value)
    assert re.search(r"keys(_mesh)?\.glb could not be written: OSError: .*No space left on device$", said), said
    assert "Traceback" not in said and sorted(tmp_path.iterdir()) == before


def test_an_object_without_animation_or_another_ending_is_refused(keyed, make_object, tmp_path):
    with pytest.raises(InputError, match="end in"):
        export_shape_keys(keyed, tmp_path / "keys.stl")
    with pytest.raises(InputError, match="has no shape keys"):
        export_shape_keys(make_object("Plain"), tmp_path / "keys.glb")
    keyed.animation_data_clear()
    for suffix in KEY_FORMATS:
        with pytest.raises(InputError, match="is not animated"):
            export_shape_keys(keyed, tmp_path / f"keys{suffix}")
