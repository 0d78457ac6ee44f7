# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morphs on disk: volumes and caches, read back by Blender frame by frame."""

from __future__ import annotations

import shutil
import subprocess
import sys
from contextlib import contextmanager
from types import SimpleNamespace

import bpy
import numpy as np
import pytest
from mathutils import Matrix

from convwass_addon.applications.morphs.layouts import path_blends, triangle_blends
from convwass_addon.applications.morphs.morph_problem import MorphFrame
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.bridge.morphs.bake import MorphBake
from convwass_addon.bridge.morphs.disk import volume_output
from convwass_addon.bridge.morphs.disk.cache_output import as_cache
from convwass_addon.bridge.morphs.disk.disk_output import (
    FOLDER_KEY,
    disk_outputs,
    filled_folder,
    for_blender,
    free_folder,
    named_folder,
    output_folder,
    own_folder,
    packed_bytes,
    remember_folder,
)
from convwass_addon.bridge.morphs.disk.volume_output import as_volume
from convwass_addon.bridge.morphs.outputs import save_as
from convwass_addon.bridge.morphs.removal import remove_bake, remove_frames
from convwass_addon.bridge.morphs.stored import frame_objects
from convwass_addon.bridge.objects import triangle_mesh
from convwass_addon.errors import ConvwassError, InputError
from convwass_addon.progress import drained

CELL = 5.0 / 64


def bake(make_object, mesh, blends, shapes, first=3):
    """Bake octahedra that rise by one with every frame."""
    objects = [make_object(name) for name in shapes]
    made = MorphBake.begin(objects, blends, {"resolution": 64}, first)
    for number, blend in enumerate(blends):
        own = None if blend.source is not None else mesh.moved((0, 0, number))
        made.add(MorphFrame(blend, own, {}))
    return made.finish(hide_inputs=True)


@pytest.fixture
def collection(make_object, octahedron):
    return bake(make_object, octahedron, path_blends(2, 3), "AB")


def shown_heights(obj, frame):
    bpy.context.scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    if not len(obj.evaluated_get(depsgraph).to_mesh().vertices):
        return None
    return triangle_mesh(obj, depsgraph).bounds[:, 2]


OUTPUTS = {
    "volume": (lambda collection, folder: drained(as_volume(collection, folder)), 0.15),
    "alembic": (lambda collection, folder: as_cache(collection, folder, "alembic"), 1e-5),
    "usd": (lambda collection, folder: as_cache(collection, folder, "usd"), 1e-5),
}


@pytest.mark.parametrize("kind", OUTPUTS)
def test_every_frame_shows_its_shape(collection, tmp_path, kind):
    write, within = OUTPUTS[kind]
    output = write(collection, tmp_path)
    for frame, height in ((1, 0), (3, 0), (4, 1), (5, 2), (6, 0), (9, 0)):
        low, high = shown_heights(output.shown, frame)
        assert low == pytest.approx(height - 1, abs=within), frame
        assert high == pytest.approx(height + 1, abs=within), frame
        # Blurred corners lose as much on both sides.
        assert (low + high) / 2 == pytest.approx(height, abs=1e-3), frame
    assert output.size == sum(file.stat().st_size for file in output.files) > 0


def test_a_volume_is_where_the_parent_of_its_frames_is_at_their_time(bare_scene, collection, tmp_path):
    empty = bpy.data.objects.new("Place", None)
    bare_scene.collection.objects.link(empty)
    for frame, height in ((3, 10.0), (5, 20.0)):
        empty.location.z = height
        empty.keyframe_insert("location", frame=frame)
    for obj in frame_objects(collection):
        obj.parent = empty
    output = drained(as_volume(collection, tmp_path))
    assert np.mean(shown_heights(output.shown, 3)) == pytest.approx(10.0, abs=0.05)
    assert np.mean(shown_heights(output.shown, 5)) == pytest.approx(22.0, abs=0.05)


@pytest.mark.parametrize("first", [-12, -2])
@pytest.mark.parametrize("kind", OUTPUTS)
def test_every_frame_before_0_shows_its_shape(make_object, octahedron, tmp_path, kind, first):
    write, within = OUTPUTS[kind]
    output = write(bake(make_object, octahedron, path_blends(2, 3), "AB", first), tmp_path)
    for number, height in ((-2, 0), (0, 0), (1, 1), (2, 2), (3, 0), (20, 0)):
        assert shown_heights(output.shown, first + number)[1] == pytest.approx(height + 1, abs=within), number


def test_files_past_frame_9999_are_one_sequence(make_object, octahedron, tmp_path):
    objects = [make_object(name) for name in "AB"]
    blends = path_blends(2, 3)
    made = MorphBake.begin(objects, blends, {"resolution": 64}, 9998)
    for number, blend in enumerate(blends):
        made.add(MorphFrame(blend, None if blend.source is not None else octahedron.moved((0, 0, number)), {}))
    output = drained(as_volume(made.finish(hide_inputs=True), tmp_path))
    assert [file.stem[-6:] for file in output.files] == ["_09998", "_09999", "_10000", "_10001"]
    for frame, height in ((9998, 0), (9999, 1), (10000, 2)):
        assert shown_heights(output.shown, frame)[1] == pytest.approx(height + 1, abs=0.15), frame


def test_the_level_of_a_volume_stays_editable(collection, tmp_path):
    shown = drained(as_volume(collection, tmp_path)).shown
    volumes = []
    for level in (0.25, 0.5, 0.75):
        shown.modifiers["Volume to Mesh"].threshold = level
        bpy.context.view_layer.update()
        volumes.append(triangle_mesh(shown, bpy.context.evaluated_depsgraph_get()).volume)
    assert volumes == sorted(volumes, reverse=True)
    assert volumes[1] == pytest.approx(4 / 3, rel=0.06)
    assert volumes[0] - volumes[2] > 0.1


def test_the_smoothing_of_a_volume_stays_editable(collection, tmp_path):
    shown = drained(as_volume(collection, tmp_path)).shown
    reach = []
    for rounds in (0, 5, 20):
        shown.modifiers["Smooth"].iterations = rounds
        bpy.context.view_layer.update()
        reach.append(np.ptp(triangle_mesh(shown, bpy.context.evaluated_depsgraph_get()).vertices[:, 2]))
    # The corners of an octahedron are rounded off.
    assert reach[0] > reach[1] > reach[2] > 1


def test_a_sheet_is_one_volume_of_all(make_object, octahedron, tmp_path):
    sheet = bake(make_object, octahedron, triangle_blends(3, 2), "ABC")
    output = drained(as_volume(sheet, tmp_path))
    assert len(output.files) == 1
    mesh = triangle_mesh(output.shown, bpy.context.evaluated_depsgraph_get())
    assert mesh.volume == pytest.approx(3 * 4 / 3, rel=0.1)


@pytest.mark.parametrize("kind", OUTPUTS)
def test_frames_may_go_and_the_file_may_move(collection, tmp_path, kind):
    """Paths are relative to the .blend file, and work in a Blender without the add-on."""
    (tmp_path / "before").mkdir()
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "before" / "morph ä.blend"))
    output = OUTPUTS[kind][0](collection, output_folder(named_folder("//", collection)))
    remove_frames(collection)
    assert frame_objects(collection) == []
    assert shown_heights(output.shown, 5)[1] == pytest.approx(3, abs=0.15)
    name = output.shown.name
    bpy.ops.wm.save_mainfile()
    moved = (tmp_path / "before").rename(tmp_path / "after") / "morph ä.blend"
    program = f"""
import bpy, sys
bpy.ops.wm.open_mainfile(filepath=sys.argv[1])
obj = bpy.data.objects[{name!r}]
for frame, height in ((3, 1), (5, 3), (6, 1)):
    bpy.context.scene.frame_set(frame)
    mesh = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    assert abs(max((obj.matrix_world @ v.co).z for v in mesh.vertices) - height) < 0.15, frame
print("shown")
"""
    done = subprocess.run([sys.executable, "-c", program, str(moved)], capture_output=True, text=True, check=False)
    assert "shown" in done.stdout, done.stderr


@pytest.mark.parametrize("kind", OUTPUTS)
def test_deleting_the_morph_leaves_only_the_files(make_object, octahedron, tmp_path, inventory, kind):
    before = inventory()
    collection = bake(make_object, octahedron, path_blends(2, 2), "AB")
    output = OUTPUTS[kind][0](collection, tmp_path)
    assert output.shown in disk_outputs(collection)
    remove_bake(collection)
    left = {entry for entry in inventory() - before if entry[0] not in ("OBJECT", "MESH")}
    assert {entry[0] for entry in left} <= {"MATERIAL"}
    assert all(file.is_file() for file in output.files)


def filled(folder):
    folder.mkdir()
    (folder / "some_0001.vdb").write_bytes(b"of another morph")
    return folder


def test_a_folder_with_files_is_left_to_those_who_wrote_them(collection, tmp_path):
    assert free_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B"
    filled(tmp_path / "Morph_A_to_B")
    filled(tmp_path / "Morph_A_to_B_001")
    (tmp_path / "Morph_A_to_B_002").mkdir()
    assert free_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B_002"
    # The command line replaces the .blend file together with its files.
    assert named_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B"


def test_a_folder_is_given_to_one_morph_only(collection, tmp_path):
    """Also where its files are removed meanwhile: Blender would show what it has read of them before."""
    first = output_folder(free_folder(str(tmp_path), collection))
    assert free_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B_001"
    first.rmdir()
    assert free_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B_001"


def test_pictures_keep_their_folder_where_the_morph_is_renamed_but_not_where_the_file_is(collection, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "one.blend"))
    own = filled(tmp_path / "Take")
    remember_folder(collection, own)
    assert own_folder("//", collection) == own
    assert own_folder("//elsewhere", collection) == tmp_path / "elsewhere" / "Morph_A_to_B"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "two.blend"))
    # The first file still shows what is there.
    assert own_folder("//", collection) == tmp_path / "Morph_A_to_B"


def test_pictures_of_a_copy_get_another_folder(collection, tmp_path):
    own = filled(tmp_path / "Morph_A_to_B")
    remember_folder(collection, own)
    assert own_folder(str(tmp_path), collection) == own
    copy = bpy.data.collections.new("Copy")
    copy[FOLDER_KEY] = collection[FOLDER_KEY]
    assert own_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B_001"
    assert own_folder(str(tmp_path), copy) == tmp_path / "Copy"


@pytest.mark.parametrize("stored", ["", "{", "[1]", '{"folder": 3, "blend": ""}', '{"blend": ""}', 7])
def test_a_damaged_folder_is_not_used(collection, tmp_path, stored):
    collection[FOLDER_KEY] = stored
    assert own_folder(str(tmp_path), collection) == tmp_path / "Morph_A_to_B"


def test_a_stopped_volume_leaves_no_objects_and_the_files_before(collection, tmp_path, inventory):
    """Files of a sequence belong together."""
    before = inventory()
    old = tmp_path / f"{tmp_path.name}_0003.vdb"
    old.write_text("old")
    work = as_volume(collection, tmp_path)
    while next(work).fraction <= 0.4:
        pass
    work.close()
    assert inventory() == before
    assert list(tmp_path.iterdir()) == [old] and old.read_text() == "old"


def test_there_must_be_room_for_all_volumes(collection, tmp_path, monkeypatch):
    """The free space that is left after the first file would do for less than three more."""

    def written(_openvdb, file, *_):
        file.write_bytes(bytes(100_000))

    monkeypatch.setattr(volume_output, "_write", written)
    monkeypatch.setattr(shutil, "disk_usage", lambda folder: SimpleNamespace(free=290_000))
    with pytest.raises(ConvwassError, match="of free space"):
        next(as_volume(collection, tmp_path))
    assert not list(tmp_path.iterdir())


def test_a_folder_that_stays_empty_vanishes_with_those_made_for_it(tmp_path):
    (tmp_path / "there").mkdir()
    with pytest.raises(KeyboardInterrupt), filled_folder(tmp_path / "there" / "walk files" / "Morph") as folder:
        assert folder.is_dir()
        raise KeyboardInterrupt
    assert list(tmp_path.rglob("*")) == [tmp_path / "there"]


def test_files_that_were_there_outlive_an_interrupt(tmp_path):
    (tmp_path / "old.abc").write_text("old")
    with pytest.raises(KeyboardInterrupt), filled_folder(tmp_path) as folder:
        (folder / "new.abc").write_text("new")
        raise KeyboardInterrupt
    assert [file.name for file in tmp_path.iterdir()] == ["old.abc"]


@contextmanager
def interrupted_in(function):
    """Let an interrupt come when a function is called."""

    def interrupt(frame, event, _):
        if event == "call" and frame.f_code is function.__code__:
            raise KeyboardInterrupt

    sys.setprofile(interrupt)
    try:
        yield
    finally:
        sys.setprofile(None)


@pytest.mark.parametrize("output", ["alembic", "usd", "volume"])
def test_files_whose_blend_is_not_saved_are_removed(collection, tmp_path, output):
    with pytest.raises(KeyboardInterrupt), interrupted_in(save_blend):
        save_as(collection, output, tmp_path / "there.blend")
    assert list(tmp_path.iterdir()) == []


def test_missing_frames_and_folders_are_reported(collection, tmp_path):
    with pytest.raises(InputError, match="Save the file first"):
        named_folder("//convwass", collection)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is a file"):
        named_folder(str(tmp_path / "file"), collection)
    with pytest.raises(InputError, match="cannot be created"):
        output_folder(tmp_path / "file" / "folder")
    remove_frames(collection)
    with pytest.raises(InputError, match="contains no frames"):
        drained(as_volume(collection, tmp_path))
    with pytest.raises(InputError, match="contains no frames"):
        as_cache(collection, tmp_path, "usd")


def test_missing_openvdb_is_reported(collection, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "openvdb", None)
    with pytest.raises(InputError, match="this Blender lacks; use another Blender, or Make Cache"):
        drained(as_volume(collection, tmp_path / "volumes"))


def test_paths_are_relative_where_the_file_has_a_place(tmp_path):
    assert for_blender(tmp_path / "x.vdb") == str(tmp_path / "x.vdb")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "here.blend"))
    assert for_blender(tmp_path / "files" / "x.vdb") == "//files/x.vdb"


def test_packed_meshes_have_the_size_of_their_arrays(make_object):
    first = make_object("A")
    twin = bpy.data.objects.new("Twin", first.data)
    assert packed_bytes([first]) == packed_bytes([first, twin]) == 6 * 12 + 24 * 8 + 12 * 8 + 8 * 4


@pytest.mark.parametrize("kind", ["alembic", "usd"])
def test_a_cache_may_be_written_again_while_it_is_shown(collection, tmp_path, kind):
    first = as_cache(collection, tmp_path, kind)
    assert shown_heights(first.shown, 5)[1] == pytest.approx(3, abs=1e-5)
    second = as_cache(collection, tmp_path, kind)
    assert second.files == first.files
    assert list(tmp_path.iterdir()) == list(second.files)
    for shown in (first.shown, second.shown):
        assert shown_heights(shown, 4)[1] == pytest.approx(2, abs=1e-5)
    shown = second.shown.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert "displayColor" in shown.to_mesh().attributes


def test_duplicates_show_a_cache_that_is_written_again(collection, tmp_path, inventory):
    folders = [tmp_path / name for name in ("first", "second")]
    for folder in folders:
        folder.mkdir()
    first = as_cache(collection, folders[0], "alembic").shown
    twin = first.copy()
    bpy.context.scene.collection.objects.link(twin)
    before = inventory()
    for obj in frame_objects(collection):
        obj.data.transform(Matrix.Translation((0.0, 0.0, 1.0)))
    as_cache(collection, folders[1], "alembic")
    assert [kind for kind, _ in inventory()].count("CACHEFILE") == [kind for kind, _ in before].count("CACHEFILE") == 1
    for shown in (first, twin):
        assert shown_heights(shown, 4)[1] == pytest.approx(3, abs=1e-5)
