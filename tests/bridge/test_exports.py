# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files for other programs, read back by Blender."""

from __future__ import annotations

import json
import re
import shutil
import struct
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.applications.morphs.layouts import path_blends, triangle_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.applications.one_mesh.vertex_textures import TextureGrid, y_up
from convwass_addon.bridge.files.image_files import opened_image, pixel_values
from convwass_addon.bridge.files.imports import import_objects
from convwass_addon.bridge.keyframes import curves_of, interpolate
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.disk import exports
from convwass_addon.bridge.morphs.disk.exports import FORMATS, export_frames
from convwass_addon.bridge.morphs.stored import frame_objects, shown_frames
from convwass_addon.bridge.nodes.node_trees import own_tree
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.bridge.one_mesh import vertex_animation_files
from convwass_addon.bridge.one_mesh.moving_meshes import triangles_of_frames
from convwass_addon.bridge.scene_colors import srgb_of_scene
from convwass_addon.errors import ConvwassError, InputError
from tests.vertex_textures import gathered, joined_steps

# Blender's own add-on for glTF uses what newer versions of numpy and Python advise against.
pytestmark = pytest.mark.filterwarnings("ignore::DeprecationWarning")

STILLS = ["obj", "ply", "stl"]
ANIMATIONS = [name for name, chosen in FORMATS.items() if chosen.animated]


@pytest.fixture
def collection(make_object, octahedron):
    """Bake frames 3 to 6 of octahedra that rise and grow by one triangle fan each."""
    a, b = make_object("A"), make_object("B")
    b.location, a.color, b.color = (0, 0, 3), (1, 0, 0, 1), (0, 0, 1, 1)
    b.modifiers.new("Subdivision", "SUBSURF").levels = 1
    blends = path_blends(2, 3)
    bake = MorphBake.begin([a, b], blends, {"resolution": 24}, 3)
    for blend in blends:
        mesh = None if blend.source is not None else octahedron.moved((0, 0, blend.frame))
        bake.add(MorphFrame(blend, mesh, {}))
    return bake.finish(hide_inputs=True)


def heights(obj):
    return triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).bounds[:, 2]


@pytest.mark.parametrize("name", STILLS)
def test_one_file_per_frame(collection, tmp_path, name, inventory):
    before = inventory()
    files = export_frames(collection, tmp_path / "rise", name)
    assert inventory() == before
    suffix = FORMATS[name].suffixes[0]
    assert files == [tmp_path / f"rise_{number:04d}{suffix}" for number in range(1, 5)]
    for number, file in enumerate(files[:3]):
        (obj,) = import_objects(file, None)
        np.testing.assert_allclose(heights(obj), [number - 1, number + 1], atol=1e-5)


def test_stills_have_the_mixed_color(collection, tmp_path):
    second = export_frames(collection, tmp_path / "rise", "obj")[1]
    (obj,) = import_objects(second, None)
    shader = next(node for node in obj.data.materials[0].node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    np.testing.assert_allclose(shader.inputs["Base Color"].default_value[:3], [2 / 3, 0, 1 / 3], atol=1e-3)


def read_glb(file):
    """Return the JSON of a .glb, and a function that reads the numbers of an accessor."""
    data = file.read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tables, binary = json.loads(data[20 : 20 + length]), data[28 + length :]

    def numbers(index):
        accessor = tables["accessors"][index]
        start = tables["bufferViews"][accessor["bufferView"]].get("byteOffset", 0)
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        return np.frombuffer(binary, "<f4", count, start).reshape(accessor["count"], -1)

    return tables, numbers


def test_frames_of_a_path_take_turns_in_one_gltf_file(collection, tmp_path, inventory, bare_scene):
    before = inventory()
    (file,) = export_frames(collection, tmp_path / "rise", "gltf")
    assert inventory() == before
    assert file == tmp_path / "rise.glb"
    tables, numbers = read_glb(file)
    (animation,) = tables["animations"]
    assert len(tables["nodes"]) == len(animation["channels"]) == 4
    shown = np.zeros((4, 4), bool)
    for channel in animation["channels"]:
        sampler, target = animation["samplers"][channel["sampler"]], channel["target"]
        assert (sampler["interpolation"], target["path"]) == ("STEP", "scale")
        times, scales = numbers(sampler["input"])[:, 0] * bare_scene.render.fps, numbers(sampler["output"])
        latest = np.searchsorted(times, np.arange(4) + 0.5) - 1
        shown[target["node"]] = scales[latest].all(axis=1)
    assert round(float(times[-1])) == 4
    np.testing.assert_array_equal(shown, np.eye(4, dtype=bool))
    material = tables["materials"][tables["meshes"][1]["primitives"][0]["material"]]
    np.testing.assert_allclose(material["pbrMetallicRoughness"]["baseColorFactor"], [2 / 3, 0, 1 / 3, 1], atol=1e-3)


def test_an_old_obj_is_kept_if_a_new_one_cannot_be_written(collection, tmp_path, monkeypatch):
    for suffix in ("obj", "mtl"):
        (tmp_path / f"rise_0001.{suffix}").write_text("older")

    def cut_off(*_):
        raise ConvwassError("The disk is full.")

    monkeypatch.setattr(exports, "write_draft", cut_off)
    with pytest.raises(ConvwassError, match="full"):
        export_frames(collection, tmp_path / "rise", "obj")
    assert {path.name: path.read_text() for path in tmp_path.iterdir()} == {
        "rise_0001.obj": "older",
        "rise_0001.mtl": "older",
    }


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.parametrize("error", [ConvwassError("The disk is full."), KeyboardInterrupt()])
@pytest.mark.parametrize("name", STILLS)
def test_files_of_a_stopped_series_are_as_before(collection, tmp_path, monkeypatch, name, error):
    export_frames(collection, tmp_path / "rise", name)
    before, calls = contents(tmp_path), []
    for obj in frame_objects(collection):
        obj.location.x += 1.0
    bpy.context.view_layer.update()

    def stopped(*given):
        calls.append(given)
        if len(calls) == 3:
            raise error

    monkeypatch.setattr(exports, "write_draft", stopped)
    with pytest.raises(type(error)):
        export_frames(collection, tmp_path / "rise", name)
    assert contents(tmp_path) == before
    assert calls[-1][-1] == tmp_path / f"rise_0003.{name}"


def test_textures_that_are_stopped_are_as_before(collection, tmp_path, monkeypatch):
    export_frames(collection, tmp_path / "rise", "vat")
    before = contents(tmp_path)
    frame_objects(collection)[0].location.x += 1.0
    bpy.context.view_layer.update()

    def stopped(file):
        raise KeyboardInterrupt

    monkeypatch.setattr(vertex_animation_files, "write_still_gltf", stopped)
    with pytest.raises(KeyboardInterrupt):
        export_frames(collection, tmp_path / "rise", "vat")
    assert contents(tmp_path) == before


@pytest.mark.parametrize("name", ["obj", "vat"])
def test_there_must_be_room_for_all_files_of_a_series(collection, tmp_path, monkeypatch, name):
    """A frame needs less than 2 MB, and all four more."""
    monkeypatch.setattr(
        shutil, "disk_usage", lambda folder: SimpleNamespace(free=1 << 20 if name == "vat" else 1 << 21)
    )
    with pytest.raises(ConvwassError, match="of free space"):
        export_frames(collection, tmp_path / "rise", name)
    assert not list(tmp_path.iterdir())


def test_an_obj_names_its_materials_and_textures_as_seen_from_its_folder(collection, tmp_path):
    (tmp_path / "textures").mkdir()
    image = bpy.data.images.new("Moss", 2, 2)
    image.filepath_raw, image.file_format = str(tmp_path / "textures" / "moss.png"), "PNG"
    image.save()
    for obj in collection.objects:
        material = bpy.data.materials.new("Moss")
        shader = next(node for node in own_tree(material).nodes if node.type == "BSDF_PRINCIPLED")
        texture = material.node_tree.nodes.new("ShaderNodeTexImage")
        texture.image = image
        material.node_tree.links.new(texture.outputs[0], shader.inputs["Base Color"])
        obj.data.materials.clear()
        obj.data.materials.append(material)
    file = export_frames(collection, tmp_path / "rise", "obj")[0]
    assert "mtllib rise_0001.mtl\n" in file.read_text()
    assert "map_Kd textures/moss.png\n" in file.with_suffix(".mtl").read_text()
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


@pytest.mark.parametrize("name", ANIMATIONS)
def test_one_file_for_the_animation(collection, tmp_path, name, inventory):
    before = inventory()
    (file,) = export_frames(collection, tmp_path / "rise", name)
    assert inventory() == before
    assert file == tmp_path / f"rise{FORMATS[name].suffixes[0]}"
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    if name == "usd":
        bpy.ops.wm.usd_import(filepath=str(file))
    else:
        bpy.ops.wm.alembic_import(filepath=str(file))
    (obj,) = (obj for obj in bpy.data.objects if obj.type == "MESH")
    assert (scene.frame_start, scene.frame_end) == (3, 6)
    found, counts = [], []
    for frame in range(3, 7):
        scene.frame_set(frame)
        mesh = triangle_mesh(obj, bpy.context.evaluated_depsgraph_get())
        found.append(mesh.bounds[:, 2].mean())
        counts.append(len(mesh.faces))
    np.testing.assert_allclose(found, [0, 1, 2, 3], atol=1e-5)
    assert counts[:3] == [8, 8, 8]
    assert counts[3] > 8


def image_bytes(file):
    with opened_image(file) as image:
        image.colorspace_settings.name = "Non-Color"
        return np.rint(255 * pixel_values(image)[::-1, :, :3])


def test_textures_hold_the_triangles_of_every_frame(collection, tmp_path, inventory):
    """Decoded as by a shader, they are the triangles of the frames within half a quantum; surplus ones have no area."""
    before = inventory()
    files = export_frames(collection, tmp_path / "rise", "vat")
    assert inventory() == before
    record = json.loads(files[0].read_text())
    frames = frame_objects(collection)
    assert (record["topology"], record["frames"]) == ("changing", len(frames))
    read = {name: image_bytes(tmp_path / record["files"][name]) for name in ("positions_png", "colors_png")}
    grid = TextureGrid(record["vertices"], record["frames"], record["texture"]["width"])
    halves = read["positions_png"].reshape(2, grid.height, grid.width, 3)
    bounds = np.array([record["bounds"]["low"], record["bounds"]["high"]])
    points = joined_steps(np.stack([gathered(grid, half) for half in halves]), bounds)
    colors = gathered(grid, read["colors_png"])
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for obj, own in zip(frames, points.reshape(len(frames), -1, 3, 3), strict=True):
        corners = y_up(triangle_mesh(obj, depsgraph).corners)
        order, wanted = (
            np.lexsort(np.round(each, 3).reshape(len(each), 9).T) for each in (own[: len(corners)], corners)
        )
        quantum = (bounds[1] - bounds[0]) / 65535
        assert (np.abs(own[: len(corners)][order] - corners[wanted]) <= 0.5 * quantum + 1e-6).all()
        assert (np.ptp(own[len(corners) :], axis=1) == 0.0).all()
    np.testing.assert_array_equal(colors[0][0], [255, 0, 0])
    np.testing.assert_allclose(colors[1][0], 255 * srgb_of_scene(np.array([2 / 3, 0.0, 1 / 3])), atol=1.5)


_READERS = {
    ".abc": lambda file: bpy.ops.wm.alembic_import(filepath=file, as_background_job=False),
    ".glb": lambda file: bpy.ops.import_scene.gltf(filepath=file),
    ".usdc": lambda file: bpy.ops.wm.usd_import(filepath=file),
}


def corners_of(files, count=4):
    """Read the lowest and the highest corner of what files show in `count` frames from 3 on."""
    suffix, found = files[0].suffix, []
    for place in range(count):
        if place < len(files):
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            if suffix in _READERS:
                _READERS[suffix](str(files[place]))
            else:
                import_objects(files[place], None)
        scene = bpy.context.scene
        scene.frame_set(place if suffix == ".glb" else 3 + place)
        shown = [obj for obj in scene.objects if obj.type == "MESH" and min(obj.scale) > 0.5]
        (bounds,) = (triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).bounds for obj in shown)
        found.append(bounds)
    return np.array(found)


@pytest.mark.parametrize("name", ["stl", "gltf", *ANIMATIONS])
def test_frames_are_where_their_parent_is(collection, tmp_path, bare_scene, name):
    """Also those that are hidden now."""
    empty = bpy.data.objects.new("Place", None)
    bare_scene.collection.objects.link(empty)
    for obj in frame_objects(collection):
        obj.parent = empty
    for frame in range(3, 7):
        bare_scene.frame_set(frame)
    empty.location.x = 7.0
    middles = corners_of(export_frames(collection, tmp_path / "rise", name)).mean(axis=1)
    np.testing.assert_allclose(middles[:, 0], 7.0, atol=1e-5)
    # Every frame is read.
    np.testing.assert_allclose(middles[:, 2], [0.0, 1.0, 2.0, 3.0], atol=1e-5)


@pytest.mark.parametrize("name", ["stl", "gltf", *ANIMATIONS])
def test_frames_are_where_their_parent_is_at_their_time(collection, tmp_path, bare_scene, name, inventory):
    """Also where one frame is shown while its parent moves on."""
    empty = bpy.data.objects.new("Place", None)
    bare_scene.collection.objects.link(empty)
    key_travel(empty)
    frames = frame_objects(collection)
    for obj in frames:
        obj.parent = empty
    if name != "stl":
        show_instead(frames[1], frames[2])
    before = inventory()
    files = export_frames(collection, tmp_path / "rise", name)
    assert inventory() == before and bare_scene.frame_current == 3
    middles = corners_of(files).mean(axis=1)
    np.testing.assert_allclose(middles[:, 0], [10.0, 11.0, 12.0, 13.0], atol=1e-5)
    np.testing.assert_allclose(middles[:, 2], [0.0, 1.0, 2.0 if name == "stl" else 1.0, 3.0], atol=1e-5)


def key_travel(obj):
    """Let an object move along X by one from frame to frame, from 10 at frame 3."""
    for frame, place in ((3, 10.0), (6, 13.0)):
        obj.location.x = place
        obj.keyframe_insert("location", index=0, frame=frame)
    interpolate(curves_of(obj))


def show_instead(obj, other):
    """Show a frame object longer, in place of the next one."""
    for curve in curves_of(obj):
        curve.keyframe_points[-1].co.x += 1.0
    for curve in curves_of(other):
        for point in curve.keyframe_points:
            point.co.y = 1.0


def test_changes_of_edit_mode_are_exported(collection, tmp_path):
    obj = frame_objects(collection)[0]
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="SELECT")
    bpy.ops.transform.translate(value=(0.0, 0.0, 5.0))
    files = export_frames(collection, tmp_path / "rise", "stl")
    assert obj.mode == "EDIT"
    bpy.ops.object.mode_set(mode="OBJECT")
    np.testing.assert_allclose(corners_of(files).mean(axis=1)[:, 2], [5.0, 1.0, 2.0, 3.0], atol=1e-5)


@pytest.mark.parametrize("name", FORMATS)
def test_frames_are_as_their_modifiers_make_them(collection, tmp_path, name):
    for obj in frame_objects(collection):
        modifier = obj.modifiers.new("Rise", "DISPLACE")
        modifier.direction, modifier.mid_level, modifier.strength = "Z", 0.0, 5.0
    files = export_frames(collection, tmp_path / "rise", name)
    if name == "vat":
        table = json.loads(files[0].read_text())
        assert table["bounds"]["high"][1] == pytest.approx(8.5, abs=0.1)
    else:
        np.testing.assert_allclose(corners_of(files).mean(axis=1)[:, 2], [5.0, 6.0, 7.0, 8.0], atol=1e-5)


def push_down(obj, later):
    """Move the keys of an object to an NLA strip that plays them later."""
    data = obj.animation_data
    action, slot, start = data.action, data.action_slot, int(curves_of(obj)[0].range()[0]) + later
    strip = data.nla_tracks.new().strips.new("Strip", start, action)
    strip.action_slot = slot
    data.action = None


@pytest.mark.parametrize("name", ["gltf", *ANIMATIONS])
def test_strips_show_frames_in_files_when_they_show_them_in_the_scene(collection, tmp_path, bare_scene, name):
    for obj in frame_objects(collection):
        push_down(obj, 2)
    bare_scene.frame_set(5)
    expected = []
    for frame in range(3, 9):
        bare_scene.frame_set(frame)
        (shown,) = [number for number, obj in enumerate(frame_objects(collection)) if not obj.hide_render]
        expected.append(shown)
    assert expected == [0, 0, 0, 1, 2, 3]
    bare_scene.frame_set(5)
    files = export_frames(collection, tmp_path / "rise", name)
    assert bare_scene.frame_current == 5
    np.testing.assert_allclose(corners_of(files, 6).mean(axis=1)[:, 2], expected, atol=1e-5)


@pytest.mark.parametrize("is_tweaked", [False, True])
def test_a_path_lasts_as_long_as_its_strips(collection, is_tweaked):
    for obj in frame_objects(collection):
        push_down(obj, -2)
        obj.animation_data.use_tweak_mode = is_tweaked
        assert obj.animation_data.use_tweak_mode == is_tweaked
    assert shown_frames(collection)[-1] == 4


def test_a_muted_curve_does_not_show_a_frame_in_files(collection, tmp_path, bare_scene):
    frames = frame_objects(collection)
    bare_scene.frame_set(3)
    for curve in curves_of(frames[3]):
        curve.mute = True
    frames[3].hide_render = True
    (file,) = export_frames(collection, tmp_path / "rise", "gltf")
    tables, numbers = read_glb(file)
    (animation,) = tables["animations"]
    outputs = [numbers(animation["samplers"][channel["sampler"]]["output"]) for channel in animation["channels"]]
    assert [scales.max() for scales in outputs] == [1.0, 1.0, 1.0, 0.0]


@pytest.mark.parametrize("name", ["gltf"])
def test_frames_are_turned(collection, tmp_path, bare_scene, name):
    """Also those that are hidden in the first frame."""
    for obj in frame_objects(collection):
        obj.rotation_euler.x = 1.2
    found = corners_of(export_frames(collection, tmp_path / "rise", name))
    high = [np.cos(1.2) * place for place in range(4)]
    np.testing.assert_allclose(found.mean(axis=1)[:, 2], high, atol=0.02)


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "vat"])
def test_sheared_frames_keep_their_shape(collection, tmp_path, bare_scene, name):
    """Turned children of an unevenly scaled parent have a matrix that no location, rotation and scale give."""
    empty = bpy.data.objects.new("Stretch", None)
    bare_scene.collection.objects.link(empty)
    empty.scale.x = 3.0
    for obj in frame_objects(collection):
        obj.parent, obj.rotation_euler.y = empty, 0.6
    found = corners_of(export_frames(collection, tmp_path / "rise", name))
    # Half the extents of an octahedron that is turned, and then stretched.
    np.testing.assert_allclose(
        (found[:3, 1] - found[:3, 0]) / 2.0, [[3.0 * np.cos(0.6), 1.0, np.cos(0.6)]] * 3, atol=1e-5
    )


@pytest.mark.parametrize("name", FORMATS)
def test_a_frame_that_is_nowhere_is_named(collection, tmp_path, name, inventory):
    obj = frame_objects(collection)[1]
    obj.rotation_euler.x = float("nan")
    before = inventory()
    with pytest.raises(InputError, match=rf"^{re.escape(obj.name)}: its location, rotation or scale is not a number"):
        export_frames(collection, tmp_path / "rise", name)
    assert inventory() == before and not list(tmp_path.iterdir())


def mirror_frames(collection, scene):
    """Give the frames a parent that mirrors them."""
    empty = bpy.data.objects.new("Mirror", None)
    scene.collection.objects.link(empty)
    empty.scale.x = -1.0
    for obj in frame_objects(collection):
        obj.parent = empty
    bpy.context.view_layer.update()


@pytest.mark.parametrize("name", [*STILLS, *ANIMATIONS])
def test_mirrored_frames_point_outwards(collection, tmp_path, bare_scene, name):
    mirror_frames(collection, bare_scene)
    bare_scene.frame_set(4)
    file = export_frames(collection, tmp_path / "rise", name)[1 if name in STILLS else 0]
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    (obj,) = import_objects(file, None)
    bpy.context.scene.frame_set(4)
    assert triangle_mesh(obj, bpy.context.evaluated_depsgraph_get()).volume == pytest.approx(4.0 / 3.0, rel=1e-4)


def test_textures_of_mirrored_frames_hold_triangles_that_point_outwards(collection, bare_scene):
    mirror_frames(collection, bare_scene)
    bare_scene.frame_set(4)
    triangles = triangles_of_frames(frame_objects(collection)).points[1].reshape(-1, 3, 3)
    assert np.linalg.det(triangles).sum() / 6.0 == pytest.approx(4.0 / 3.0, rel=1e-4)


def test_usd_has_the_colors(collection, tmp_path):
    (file,) = export_frames(collection, tmp_path / "rise.usda", "usd")
    bpy.utils.expose_bundled_modules()
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.Open(str(file))
    (mesh,) = (prim for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    colors = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("displayColor")
    mixed = [tuple(colors.Get(time)[0]) for time in (3, 4, 5, 6)]
    np.testing.assert_allclose(mixed, [(1 - t / 3, 0, t / 3) for t in range(4)], atol=1e-6)


@pytest.mark.parametrize("name", [name for name in FORMATS if name != "vat"])
def test_sheet(make_object, octahedron, tmp_path, name):
    blends = triangle_blends(3, 3)
    bake = MorphBake.begin([make_object(shape) for shape in "ABC"], blends, {"resolution": 24}, 1)
    for blend in blends:
        bake.add(MorphFrame(blend, None if blend.source is not None else octahedron, {}))
    files = export_frames(bake.finish(hide_inputs=True), tmp_path, name)
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    shapes = [import_objects(file, None)[0] for file in files]
    meshes = [triangle_mesh(shape, bpy.context.evaluated_depsgraph_get()) for shape in shapes]
    assert sum(len(mesh.faces) for mesh in meshes) == 6 * 8
    # Two steps from side to side, and as many down.
    low = np.min([mesh.bounds[0] for mesh in meshes], axis=0)
    high = np.max([mesh.bounds[1] for mesh in meshes], axis=0)
    np.testing.assert_allclose(high - low, [2 + 2 * 2.6, 2, 2 + 2 * 2.6], atol=1e-4)


@pytest.mark.parametrize(
    ("given", "written"),
    [
        ("walk", "walk.usdc"),
        ("walk.v2", "walk.v2.usdc"),
        ("walk.usda", "walk.usda"),
        ("walk.usdz", "walk.usdz"),
        ("walk.blend", "walk.usdc"),
        ("", "Morph_A_to_B.usdc"),
    ],
)
def test_names(collection, tmp_path, given, written):
    assert export_frames(collection, tmp_path / given, "usd") == [tmp_path / written]
    assert (tmp_path / written).is_file()


def test_scene_is_unchanged(collection, bare_scene, tmp_path):
    bare_scene.frame_set(5)
    for name in FORMATS:
        export_frames(collection, tmp_path, name)
    assert bpy.context.scene == bare_scene
    assert (bare_scene.frame_start, bare_scene.frame_end, bare_scene.frame_current) == (1, 250, 5)
    assert [obj.name for obj in collection.objects if not obj.hide_render] == ["Morph 0003"]
    assert {slot.link for obj in collection.objects for slot in obj.material_slots} == {"DATA"}


def test_unknown_format(collection, tmp_path):
    with pytest.raises(InputError, match="no export format 'dxf'; choose one of obj, ply"):
        export_frames(collection, tmp_path, "dxf")


def test_folder_that_does_not_exist(collection, tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        export_frames(collection, tmp_path / "nowhere" / "walk.obj", "obj")


def test_collection_without_frames(tmp_path):
    with pytest.raises(InputError, match="Props contains no frames"):
        export_frames(bpy.data.collections.new("Props"), tmp_path, "obj")


@pytest.mark.parametrize("name", FORMATS)
def test_file_that_cannot_be_written(collection, tmp_path, name, inventory):
    suffix = FORMATS[name].suffixes[0]
    blocked = tmp_path / (f"walk_0001{suffix}" if name in STILLS else f"walk{suffix}")
    before = inventory()
    blocked.mkdir()
    with pytest.raises(ConvwassError):
        export_frames(collection, tmp_path / "walk", name)
    assert inventory() == before
