# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Moving a morph out of the .blend file by its operators."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest


@pytest.fixture
def morph(empty_scene):
    """A small bake, active."""
    for x in (0.0, 3.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(frames=3, resolution=24)
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


def test_an_unsaved_file_has_no_folder_beside_it(morph):
    with pytest.raises(RuntimeError, match="save that first"):
        bpy.ops.convwass.make_volume()
    assert sum("convwass_weights" in obj for obj in morph.objects) == 4


def test_undo_brings_the_frames_back(morph, tmp_path):
    name = morph.name
    bpy.ops.ed.undo_push(message="baked")
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    bpy.ops.ed.undo_push(message="moved")
    bpy.ops.ed.undo()
    assert sum("convwass_weights" in obj for obj in bpy.data.collections[name].objects) == 4


def test_without_a_morph_they_say_what_is_missing(empty_scene):
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
def test_a_bake_puts_its_files_where_it_is_told(empty_scene, tmp_path, output, kind, suffix):
    for x in (0.0, 3.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(frames=2, resolution=24, output=output, folder=str(tmp_path), cache_format=kind)
    assert {file.suffix for file in tmp_path.rglob("*.*") if file.is_file()} == {suffix}
    assert bpy.context.object["convwass_output"] == output.lower()


def test_large_meshes_are_worth_a_warning(empty_scene, monkeypatch, capfd):
    from convwass_addon.operators import bake_morph

    monkeypatch.setattr(bake_morph, "_LARGE_MEGABYTES", 0.0)
    for x in (0.0, 3.0):
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=2, location=(x, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.bake_morph(frames=2, resolution=24)
    assert "MB to the file" in capfd.readouterr().out
