# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What shows morphs in full copies of a scene, for which Blender copies neither node groups nor what reads files."""

from __future__ import annotations

from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon.bridge.flat.picture_bake import pictures_of
from convwass_addon.bridge.morphs.disk.disk_output import disk_outputs
from convwass_addon.bridge.morphs.stand_ins import frames_modifier, stand_ins
from convwass_addon.bridge.morphs.stored import stored_morph
from tests.operators.morphs import add


def the_morphs():
    return [collection for collection in bpy.data.collections if "convwass_morph" in collection]


def shower(morph):
    """The player of a morph, the blend of its pad, or the mesh that shows its files."""
    players = [obj for obj in stand_ins(morph) if frames_modifier(obj) and not obj.hide_render]
    return next(iter(players), None) or next(obj for obj in disk_outputs(morph) if obj.type == "MESH")


def seen(scene, morph):
    """Bounds of what shows a morph in the middle and at its ends, (3, 2, 3)."""
    bpy.context.window.scene = scene
    found = []
    for frame in (1, 2.5, 4):
        scene.frame_set(int(frame), subframe=frame % 1)
        mesh = shower(morph).evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        points = np.array([vertex.co for vertex in mesh.vertices])
        found.append([points.min(axis=0), points.max(axis=0)])
    return np.array(found)


@pytest.fixture(params=["PLAYER", "PAD", "VOLUME", "CACHE"])
def copied(empty_scene, request, tmp_path):
    """A morph whose shapes were changed in a full copy of its scene."""
    for place, kind in enumerate(("cube", "uv_sphere", "cone")[: 3 if request.param == "PAD" else 2]):
        add(kind, location=(3 * place, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    options = {"output": "PLAYER", "layout": "TRIANGLE"} if request.param == "PAD" else {"output": request.param}
    folder = str(tmp_path / "files")
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", resolution=16, frames=3, steps=3, folder=folder, **options)
    (morph,) = the_morphs()
    bpy.ops.scene.new(type="FULL_COPY")
    copy = next(other for other in the_morphs() if other != morph)
    for obj in stored_morph(copy).objects:
        obj.scale = (1.5, 1.5, 1.5)
    bpy.context.view_layer.update()
    return SimpleNamespace(scenes=[empty_scene, bpy.context.scene], morphs=[morph, copy])


@pytest.mark.parametrize("place", [0, 1])
@pytest.mark.parametrize("operator", ["rebake_morph", "delete_morph"])
def test_what_happens_to_one_of_them_leaves_the_other_as_it_is(copied, place, operator):
    changed, kept = place, 1 - place
    before = [seen(scene, morph) for scene, morph in zip(copied.scenes, copied.morphs, strict=True)]
    np.testing.assert_array_equal(*before)
    bpy.context.window.scene = copied.scenes[changed]
    copied.scenes[changed].frame_set(1)
    bpy.context.view_layer.objects.active = shower(copied.morphs[changed])
    assert getattr(bpy.ops.convwass, operator)() == {"FINISHED"}
    np.testing.assert_array_equal(seen(copied.scenes[kept], copied.morphs[kept]), before[kept])
    if operator == "rebake_morph":
        ratio = 1.5 if changed == 1 else 1.0
        after = seen(copied.scenes[changed], copied.morphs[changed])
        np.testing.assert_allclose(np.ptp(after[0], axis=0), ratio * np.ptp(before[0][0], axis=0), rtol=0.2)
    # The copy is complete: nothing of the other one is needed.
    bpy.context.window.scene = copied.scenes[kept]
    bpy.context.view_layer.objects.active = shower(copied.morphs[kept])
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}


def test_pictures_of_a_copy_are_seen_in_its_scene_only(empty_scene, tmp_path):
    for place, letter in enumerate("AB"):
        bpy.ops.object.text_add(location=(2 * place, 0, 0))
        bpy.context.object.data.body = letter
    bpy.ops.object.select_all(action="SELECT")
    folder = str(tmp_path / "files")
    bpy.ops.convwass.bake_morph(frames=2, flat_resolution=64, flat_output="PICTURE", folder=folder)
    (morph,) = the_morphs()
    before = pictures_of(morph)
    bpy.ops.scene.new(type="FULL_COPY")
    copy = next(other for other in the_morphs() if other != morph)
    bpy.context.view_layer.objects.active = copy.objects[0]
    assert bpy.ops.convwass.rebake_morph() == {"FINISHED"}
    assert pictures_of(morph) == before
    assert not set(pictures_of(copy)) & set(before)
    assert all(path.exists() for path in (*before, *pictures_of(copy)))
