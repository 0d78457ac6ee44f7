# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving a morph out of the .blend file by its operators."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from convwass_addon.bridge.morphs.disk.disk_output import disk_outputs
from convwass_addon.operators.morph_bake import CONVWASS_OT_bake_morph
from tests.operators.morphs import two_balls
from tests.operators.running import Pressed, show_other_scene, started, until, window_context
from tests.scene import height_at


def bake():
    two_balls()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=3, resolution=24)


@pytest.fixture
def morph(empty_scene, scene_with):
    """A small bake, active."""
    scene_with(bake)
    return next(c for c in bpy.data.collections if "convwass_morph" in c)


@pytest.mark.parametrize(
    ("operator", "options", "files"),
    [("make_volume", {}, 4), ("make_cache", {"kind": "alembic"}, 1), ("make_cache", {"kind": "usd"}, 1)],
)
def test_the_frames_become_files(morph, tmp_path, operator, options, files):
    frames = [obj for obj in morph.objects if "convwass_weights" in obj]
    meshes = len(bpy.data.meshes)
    bpy.ops.ed.undo_push(message="baked")
    assert getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options) == {"FINISHED"}
    assert len(bpy.data.meshes) < meshes
    written = [file for file in Path(tmp_path).rglob("*") if file.is_file()]
    assert len(written) == files
    assert written[0].parent.name == "Morph_Icosphere_to_Icosphere_001"
    assert bpy.context.object in set(bpy.data.collections[morph.name].objects)
    assert len(frames) == 4


def test_a_surface_whose_volume_was_deleted_shows_the_next_one(morph, tmp_path):
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    surface = bpy.context.object
    bpy.data.objects.remove(next(obj for obj in bpy.data.objects if obj.type == "VOLUME"))
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.ops.convwass.make_volume(folder=str(tmp_path)) == {"FINISHED"}
    assert bpy.context.object == surface
    assert len(surface.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.polygons) > 0


@pytest.mark.parametrize(("operator", "options"), [("make_volume", {}), ("make_cache", {"kind": "alembic"})])
def test_readers_of_files_are_found_in_other_collections(morph, tmp_path, operator, options):
    getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options)
    readers, shown, elsewhere = list(morph.objects), bpy.context.object, bpy.data.collections.new("Other Morph")
    elsewhere["convwass_morph"] = morph["convwass_morph"]
    bpy.context.scene.collection.children.link(elsewhere)
    for obj in readers:
        elsewhere.objects.link(obj)
        morph.objects.unlink(obj)
    twin = shown.copy()
    bpy.context.scene.collection.objects.link(twin)
    bpy.context.view_layer.objects.active = shown
    assert bpy.ops.convwass.rebake_morph(which="ACTIVE") == {"FINISHED"}
    assert not morph.objects
    assert all(obj.users_collection == (elsewhere,) for obj in readers)
    assert len(list(tmp_path.iterdir())) == 2
    assert disk_outputs(elsewhere) == []
    assert bpy.context.object == shown
    bpy.ops.convwass.delete_morph()
    assert [obj for obj in bpy.data.objects if "convwass_output" in obj] == [twin]


@pytest.mark.parametrize("factor", [1.02, 0.98])
def test_cells_of_volumes_are_as_wide_as_openvdb_demands(empty_scene, tmp_path, factor):
    """Cubes of 0.1 mm at 16 cells."""
    for x in (0.0, 1.32e-4):
        bpy.ops.mesh.primitive_cube_add(size=1e-4 * factor, location=(x * factor, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=1, resolution=16)
    if factor > 1.0:
        assert bpy.ops.convwass.make_volume(folder=str(tmp_path)) == {"FINISHED"}
    else:
        with pytest.raises(RuntimeError, match="is too small for volumes: its cells would be"):
            bpy.ops.convwass.make_volume(folder=str(tmp_path))
        assert not contents(tmp_path)


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize(
    ("operator", "options"), [("make_volume", {}), ("make_cache", {"kind": "alembic"}), ("make_cache", {"kind": "usd"})]
)
def test_two_morphs_of_one_name_do_not_share_files(empty_scene, tmp_path, operator, options):
    first, second = two_bakes()
    name = first.name
    for morph in (first, second):
        bpy.context.view_layer.objects.active = morph.objects[0]
        morph.name = name
        assert getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options) == {"FINISHED"}
        if morph == first:
            kept = contents(tmp_path)
            first.name = "Take 1"
    assert kept.items() < contents(tmp_path).items()
    assert len(list(tmp_path.iterdir())) == 2


def test_files_of_another_blend_are_kept(morph, tmp_path):
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "one.blend"))
    bpy.ops.convwass.make_volume()
    bpy.ops.wm.save_mainfile()
    kept = contents(tmp_path / "convwass")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    two_bakes()
    bpy.context.object.users_collection[0].name = "Morph Icosphere to Icosphere.001"
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "two.blend"))
    bpy.ops.convwass.make_volume()
    assert kept.items() < contents(tmp_path / "convwass").items()


def test_an_unsaved_file_has_no_folder(morph):
    with pytest.raises(RuntimeError, match="Save the file first"):
        bpy.ops.convwass.make_volume()
    assert sum("convwass_weights" in obj for obj in morph.objects) == 4


def test_undo_brings_the_frames_back(morph, tmp_path):
    name = morph.name
    bpy.ops.ed.undo_push(message="baked")
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    assert sum("convwass_weights" in obj for obj in bpy.data.collections[name].objects) == 4


def test_without_a_morph_they_report_it(empty_scene):
    for operator in (bpy.ops.convwass.make_volume, bpy.ops.convwass.make_cache):
        assert not operator.poll()
        with pytest.raises(RuntimeError, match="Select an object of a baked morph"):
            operator()


def test_a_morph_whose_frames_are_on_disk_can_be_deleted(morph, tmp_path):
    bpy.ops.convwass.make_cache(folder=str(tmp_path))
    bpy.ops.convwass.delete_morph()
    assert not any("convwass_output" in obj for obj in bpy.data.objects)
    assert not bpy.data.cache_files


@pytest.mark.parametrize(("output", "kind", "suffix"), [("CACHE", "usd", ".usdc"), ("VOLUME", "alembic", ".vdb")])
def test_a_bake_writes_its_files_to_the_given_folder(empty_scene, tmp_path, output, kind, suffix):
    two_balls()
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT", frames=2, resolution=24, output=output, folder=str(tmp_path), cache_format=kind
    )
    assert {file.suffix for file in tmp_path.rglob("*.*") if file.is_file()} == {suffix}
    assert bpy.context.object["convwass_output"] == output.lower()


def test_large_meshes_are_worth_a_warning(empty_scene, monkeypatch, capfd):
    from convwass_addon.operators import morph_results

    monkeypatch.setattr(morph_results, "packed_bytes", lambda objects: 300e6)
    two_balls()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24)
    assert "300 MB to the file" in capfd.readouterr().out


def two_bakes():
    """Bake two morphs that follow each other in time; each sets the scene's frame range."""
    for x in (0.0, 3.0):
        bpy.ops.mesh.primitive_cube_add(location=(x, 0, 0), scale=(1, 1, 1 + x / 3))
    first, second = bpy.context.scene.objects.keys()
    made = []
    for start in (1, 11):
        settings = {"frames": 3, "resolution": 24, "start": "CUSTOM", "frame_start": start, "hide_inputs": False}
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs=f"{first},{second}", **settings)
        made.append(bpy.context.object.users_collection[0])
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 11, 14
    return made


@pytest.mark.parametrize(
    ("operator", "options"), [("make_volume", {}), ("make_cache", {"kind": "alembic"}), ("make_cache", {"kind": "usd"})]
)
@pytest.mark.parametrize("place", [0, 1])
def test_each_of_two_morphs_has_its_own_frames(empty_scene, tmp_path, operator, options, place):
    morph = two_bakes()[place]
    first = (1, 11)[place]
    bpy.context.view_layer.objects.active = morph.objects[0]
    assert getattr(bpy.ops.convwass, operator)(folder=str(tmp_path), **options) == {"FINISHED"}
    shown = bpy.context.object
    heights = [height_at(shown, first + step) for step in range(4)]
    assert heights[0] == pytest.approx(2.0, abs=0.2) and heights[-1] == pytest.approx(4.0, abs=0.3)
    assert heights == sorted(heights) and heights[2] - heights[1] > 0.3
    if operator == "make_volume":
        numbers = [file.stem[-4:] for file in sorted(tmp_path.rglob("*.vdb"))]
        assert numbers == [f"{first + step:04d}" for step in range(4)]


@pytest.mark.parametrize("layout", ["BLEND", "GRID"])
def test_a_static_morph_has_no_cache_and_leaves_nothing_behind(empty_scene, tmp_path, layout):
    for x in (0.0, 3.0, 6.0, 9.0)[: 4 if layout == "GRID" else 2]:
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout=layout, steps=2, resolution=16)
    frames = len(bpy.context.object.users_collection[0].objects)
    with pytest.raises(RuntimeError, match="bake an animation"):
        bpy.ops.convwass.make_cache(folder=str(tmp_path))
    assert list(tmp_path.iterdir()) == []
    assert len(bpy.context.object.users_collection[0].objects) == frames


def test_a_cache_that_cannot_be_read_back_is_removed(morph, tmp_path, monkeypatch):
    from convwass_addon.bridge.morphs.disk import cache_output

    monkeypatch.setattr(cache_output, "export_frames", lambda _, file, kind: file.write_bytes(b"no archive"))
    with pytest.raises(RuntimeError, match="would contain no animated mesh"):
        bpy.ops.convwass.make_cache(folder=str(tmp_path))
    assert list(tmp_path.iterdir()) == []
    assert sum("convwass_weights" in obj for obj in morph.objects) == 4


def test_a_first_shape_that_lasts_is_written_from_its_beginning(empty_scene, tmp_path):
    """Its only key is at its end."""
    two_balls()
    bpy.ops.convwass.bake_morph(
        motion="TRANSPORT", frames=4, frame_step=2, resolution=16, start="CUSTOM", frame_start=5
    )
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    assert [file.stem[-4:] for file in sorted(tmp_path.rglob("*.vdb"))] == ["0005", "0006", "0007", "0008", "0009"]


@pytest.mark.parametrize(("output", "key"), [("PLAYER", "convwass_shows"), ("CACHE", "convwass_output")])
def test_the_morph_of_the_scene_that_it_began_in_is_handed_over(morph, tmp_path, output, key):
    """Another morph is active by then; it is not changed."""
    own, frames = bpy.context.scene, list(morph.objects)
    names = "\n".join(obj.name for obj in own.objects if "convwass_weights" not in obj)
    settings = {"frames": 2, "resolution": 24, "folder": str(tmp_path)}
    pressed = Pressed(CONVWASS_OT_bake_morph, motion="TRANSPORT", inputs=names, output=output, **settings)
    window = window_context()
    assert started(pressed, window)
    other = show_other_scene(window)
    other.collection.children.link(morph)
    other.view_layers[0].objects.active = frames[0]
    assert until(pressed, window) == {"FINISHED"}
    assert [kind for kind, _ in pressed.reports] == ["INFO"]
    # Fields of a player are kept by an object that no scene has.
    (shown,) = (obj for obj in bpy.data.objects if key in obj and obj.users_scene)
    assert own in shown.users_scene and other not in shown.users_scene
    assert list(morph.objects) == frames and not morph.hide_render


@pytest.mark.parametrize("operator", ["make_volume", "make_cache"])
def test_a_mesh_that_a_copy_was_converted_to_is_kept(morph, tmp_path, operator):
    """As for a simulation."""
    getattr(bpy.ops.convwass, operator)(folder=str(tmp_path))
    reader = bpy.context.object
    bpy.ops.object.duplicate()
    bpy.ops.object.convert(target="MESH")
    mine = bpy.context.object
    mine.name = "A Rigid Body"
    count = len(mine.data.polygons)
    bpy.context.view_layer.objects.active = reader
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert bpy.context.object == reader and not mine.modifiers
    assert bpy.ops.convwass.delete_morph() == {"FINISHED"}
    assert bpy.data.objects.get("A Rigid Body") == mine and len(mine.data.polygons) == count > 0
