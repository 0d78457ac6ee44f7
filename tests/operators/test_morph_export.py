# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writing morphs and meshes with shape keys for other programs."""

from __future__ import annotations

import bpy
import numpy as np
import pytest

from convwass_addon.applications.one_mesh.key_paths import KeyPath
from convwass_addon.bridge.one_mesh.shape_keys import animate_sliders, object_with_keys
from tests.operators.morphs import two_balls
from tests.rigs import chain

# Blender's own add-ons use what newer versions of NumPy and Python advise against.
pytestmark = [pytest.mark.usefixtures("empty_scene"), pytest.mark.filterwarnings("ignore::DeprecationWarning")]


@pytest.fixture
def keyed():
    bpy.ops.mesh.primitive_cube_add()
    source = bpy.context.object
    rest = np.array([vertex.co for vertex in source.data.vertices])
    path = KeyPath("Up", (1.0,), (rest + np.array([0.0, 0.0, 2.0]))[None], 0.9, 0.0, 0.0, 0.0, 0)
    obj = object_with_keys(source, source.data.copy(), [path], bpy.context.scene)
    animate_sliders(obj, ["Up"], 1, 2)
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.mark.parametrize(("name", "count"), [("keys.glb", 1), ("keys.json", 5)])
def test_the_active_mesh_with_keys_is_written(keyed, tmp_path, name, count):
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / name)) == {"FINISHED"}
    assert (tmp_path / name).is_file()
    assert len(list(tmp_path.iterdir())) == count


@pytest.mark.parametrize("name", ["keys.glb", "keys.fbx", "keys.abc"])
def test_modifiers_that_a_file_lacks_are_named(keyed, tmp_path, capfd, name):
    rigs = [chain(name=rig) for rig in ("Body", "Face")]
    for rig in rigs:
        keyed.modifiers.new(rig.name, "ARMATURE").object = rig
    keyed.modifiers.new("Fine", "SUBSURF")
    keyed.modifiers.new("Off", "SUBSURF").show_viewport = False
    bpy.context.view_layer.objects.active = keyed
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / name)) == {"FINISHED"}
    is_named = "lacks the modifiers of Cube Morph (Face, Fine);" in capfd.readouterr().out
    assert is_named == (name != "keys.abc")


def test_what_cannot_be_written_is_refused(keyed, tmp_path, monkeypatch):
    with pytest.raises(RuntimeError, match="end in"):
        bpy.ops.convwass.export_morph(filepath=str(tmp_path / "keys.xyz"))
    with pytest.raises(RuntimeError, match="Choose a file"):
        bpy.ops.convwass.export_morph()
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RuntimeError, match=r"Save the file first, since //keys\.glb is relative to it"):
        bpy.ops.convwass.export_morph(filepath="//keys.glb")
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(RuntimeError, match="is in Edit Mode"):
        bpy.ops.convwass.export_morph(filepath=str(tmp_path / "keys.abc"))
    bpy.ops.object.mode_set(mode="OBJECT")
    assert list(tmp_path.iterdir()) == []
    bpy.context.view_layer.objects.active = None
    assert not bpy.ops.convwass.export_morph.poll()


def test_the_active_morph_is_written(tmp_path):
    two_balls()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=20)
    assert bpy.ops.convwass.export_morph(filepath=str(tmp_path / "morph.obj")) == {"FINISHED"}
    assert len(list(tmp_path.glob("*.obj"))) == 3
