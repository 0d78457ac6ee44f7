# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files are saved completely or not at all."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy
import pytest

from convwass_addon.bridge.files.output_paths import checked_folder, checked_target, file_stem, made_folder, save_blend
from convwass_addon.drafts import DraftFiles
from convwass_addon.errors import ConvwassError, InputError


def test_saved_file_opens(make_object, tmp_path):
    make_object("A")
    assert save_blend(tmp_path / "new.blend") == tmp_path / "new.blend"
    assert [path.name for path in tmp_path.iterdir()] == ["new.blend"]
    assert not bpy.data.filepath
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "new.blend"))
    assert "A" in bpy.data.objects


def test_saving_again_replaces(make_object, tmp_path):
    target = tmp_path / "a.blend"
    target.write_bytes(b"old")
    make_object("A")
    save_blend(target)
    assert target.stat().st_size > 1000
    assert [path.name for path in tmp_path.iterdir()] == ["a.blend"]


def test_relative_paths(tmp_path):
    picture = tmp_path / "textures" / "a.png"
    picture.parent.mkdir()
    image = bpy.data.images.new("a", 4, 4)
    image.filepath_raw, image.file_format = str(picture), "PNG"
    image.save()
    image.use_fake_user = True
    save_blend(tmp_path / "a.blend")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    assert bpy.data.images["a"].filepath.replace("\\", "/") == "//textures/a.png"


def test_failed_saving_leaves_the_old_file(make_object, tmp_path, monkeypatch):
    target = tmp_path / "a.blend"
    target.write_bytes(b"old")
    make_object("A")

    def full(*_):
        raise OSError("No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(ConvwassError, match="No space left"):
        save_blend(target)
    assert target.read_bytes() == b"old"
    assert [path.name for path in tmp_path.iterdir()] == ["a.blend"]


def test_folder_that_does_not_exist(tmp_path):
    with pytest.raises(InputError, match="does not exist"):
        save_blend(tmp_path / "nowhere" / "a.blend")


@pytest.mark.parametrize("check", [checked_target, made_folder])
def test_file_instead_of_folder(tmp_path, check):
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="file is a file; choose a folder"):
        check(tmp_path / "file" / "x.blend")


def test_folder_instead_of_file(tmp_path):
    with pytest.raises(InputError, match="is a folder"):
        save_blend(tmp_path)


def test_other_ending(tmp_path):
    with pytest.raises(InputError, match=r"name it a\.blend"):
        save_blend(tmp_path / "a.obj")
    assert not list(tmp_path.iterdir())


def test_folder_that_cannot_be_written(tmp_path, monkeypatch):
    monkeypatch.setattr(os, "access", lambda *_: False)
    with pytest.raises(InputError, match="cannot be written to"):
        save_blend(tmp_path / "a.blend")


def test_protected_files_are_kept(tmp_path, monkeypatch):
    target = tmp_path / "a.blend"
    target.write_bytes(b"published")
    # The superuser may write everything.
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != target)
    with pytest.raises(InputError, match="is protected from being overwritten"):
        save_blend(target)
    assert target.read_bytes() == b"published"


@pytest.mark.skipif(sys.platform == "win32", reason="HOME is not what Windows asks")
def test_home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert checked_target(Path("~/a.obj")) == tmp_path / "a.obj"


def test_drafts_take_their_places_together(tmp_path):
    (tmp_path / "old.cube").write_text("old")
    drafts = DraftFiles()
    targets = [tmp_path / "old.cube", tmp_path / "new" / "a.cube"]
    for target in targets:
        drafts.draft_of(target).write_text("new")
    assert targets[0].read_text() == "old" and not targets[1].exists()
    assert drafts.keep() == targets
    drafts.discard()
    assert [target.read_text() for target in targets] == ["new", "new"]
    assert sorted(tmp_path.rglob("*.*")) == sorted(targets)


def test_discarded_drafts_leave_nothing(tmp_path):
    (tmp_path / "old.cube").write_text("old")
    drafts = DraftFiles()
    for target in (tmp_path / "old.cube", tmp_path / "new" / "a.cube"):
        drafts.draft_of(target).write_text("new")
    drafts.draft_of(tmp_path / "never.cube")
    drafts.discard()
    assert list(tmp_path.iterdir()) == [tmp_path / "old.cube"] and (tmp_path / "old.cube").read_text() == "old"


def test_truncated_drafts_replace_nothing(tmp_path):
    targets = [tmp_path / "a.cube", tmp_path / "b.png"]
    drafts = DraftFiles()
    for target in targets:
        target.write_text("old")
        drafts.draft_of(target).write_text("new")
    with pytest.raises(ConvwassError, match="the disk may be full"):
        drafts.keep()
    drafts.discard()
    assert sorted(tmp_path.iterdir()) == targets and targets[0].read_text() == "old"


def test_a_draft_that_cannot_be_placed_is_reported(tmp_path):
    (tmp_path / "a.png").mkdir()
    drafts = DraftFiles()
    drafts.draft_of(tmp_path / "a.png").write_text("new")
    with pytest.raises(ConvwassError, match="could not be written"):
        drafts.keep()
    drafts.discard()
    assert list(tmp_path.iterdir()) == [tmp_path / "a.png"]


def test_folders_are_checked(tmp_path):
    assert checked_folder(str(tmp_path)) == tmp_path
    assert checked_folder(str(tmp_path / "new")) == tmp_path / "new" and not (tmp_path / "new").exists()
    (tmp_path / "file").write_text("x")
    for wrong, said in (
        (tmp_path / "file", "is a file"),
        (tmp_path / "none" / "new", "does not exist"),
        ("//x", "Save the file"),
        ("", "Choose a folder"),
        (" ", "Choose a folder"),
    ):
        with pytest.raises(InputError, match=said):
            checked_folder(str(wrong))


@pytest.mark.parametrize("letter", ["a", "ж", "名"])
def test_names_of_255_bytes_leave_room_for_numbers_and_extensions(letter):
    stem = file_stem(255 // len(letter.encode()) * letter)
    assert len(f".{stem}_0001.usdc@".encode()) <= 220
    assert stem.startswith(40 * letter)


def test_long_names_that_begin_alike_stay_apart():
    stem = file_stem(255 * "a")
    assert stem == file_stem(255 * "a") != file_stem(250 * "a")
    assert file_stem("A to B/C") == "A_to_B_C"
