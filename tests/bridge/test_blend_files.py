# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender files that are opened, appended or refused."""

from __future__ import annotations

from pathlib import Path

import bpy
import pytest

from convwass_addon.bridge.files.blend_files import (
    NAMES_SHOWN,
    appended_instances,
    appended_objects,
    listed_names,
    open_blend,
)
from convwass_addon.bridge.files.output_paths import save_blend
from convwass_addon.errors import InputError


@pytest.fixture
def file(make_object, tmp_path):
    for name in ("A", "B"):
        make_object(name)
    path = save_blend(tmp_path / "two.blend")
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return path


def test_opening(file):
    open_blend(file)
    assert {obj.name for obj in bpy.context.scene.objects} == {"A", "B"}


def test_appending_all_or_some_each_once(file):
    assert sorted(appended_objects(file, None)) == ["A", "B"]
    found = appended_objects(file, ["B", "B"])
    assert list(found) == ["B"]
    assert found["B"].name == "B.001"
    assert not bpy.context.scene.objects


def test_no_names_append_nothing(file):
    assert appended_objects(file, []) == {}
    assert not bpy.data.objects


def test_names_that_are_not_there(file):
    with pytest.raises(InputError, match=r"two\.blend has no object 'C'; it contains A, B"):
        appended_objects(file, ["A", "C"])
    assert not bpy.data.objects


def test_names_of_collections_are_listed_with_those_of_objects(file):
    bpy.ops.wm.open_mainfile(filepath=str(file))
    bpy.data.collections.new("Parts").objects.link(bpy.data.objects["A"])
    bpy.data.collections["Parts"].use_fake_user = True
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    with pytest.raises(InputError, match=r"two\.blend has no object or collection 'C'; it contains A, B, .*Parts"):
        appended_instances(file, ["A", "C"])
    assert not bpy.data.objects
    assert list(appended_instances(file, ["A", "Parts"])) == ["Parts"]


@pytest.mark.parametrize("read", [open_blend, lambda path: appended_objects(path, None)])
def test_invalid_blend_files(tmp_path, read):
    (tmp_path / "a.blend").write_bytes(b"BLENDER nonsense")
    with pytest.raises(InputError, match=r"a\.blend could not be read; it is damaged"):
        read(tmp_path / "a.blend")


def test_lists_end():
    assert str(listed_names([])) == "no objects"
    assert listed_names(["b", "a"]) == "a, b"
    assert str(listed_names(map(str, range(NAMES_SHOWN + 3)))).endswith("and 3 more")


def test_files_that_may_not_be_opened_are_not_called_damaged(tmp_path, monkeypatch):
    path = tmp_path / "secret.blend"
    path.write_bytes(b"no .blend file")

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    # The superuser may read everything.
    monkeypatch.setattr(Path, "open", refuse)
    for use in (open_blend, lambda file: appended_objects(file, None), lambda file: appended_instances(file, ["A"])):
        with pytest.raises(InputError, match=r"secret\.blend cannot be opened: Permission denied"):
            use(path)
