# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Saving: whole files or none."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import bpy
import pytest

from convwass_addon.bridge.files import checked_target, save_blend
from convwass_addon.errors import ConvwassError, InputError


def test_saved_file_opens(make_object, tmp_path):
    make_object("A")
    assert save_blend(tmp_path / "new.blend") == tmp_path / "new.blend"
    assert [path.name for path in tmp_path.iterdir()] == ["new.blend"]
    assert not bpy.data.filepath
    bpy.ops.wm.read_factory_settings(use_empty=True)
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


@pytest.mark.skipif(sys.platform == "win32", reason="HOME is not what Windows asks")
def test_home(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    assert checked_target(Path("~/a.obj")) == tmp_path / "a.obj"
