# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output of the command line can be baked again in the window with the same settings."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import bpy
import numpy as np
import pytest

from convwass_addon import cli
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.bridge.densities.density_attributes import stored_frames
from convwass_addon.bridge.densities.density_store import stored_density
from convwass_addon.bridge.morphs.morph_request import MorphRequest
from convwass_addon.bridge.morphs.stored import MORPH_KEY, frame_objects, stored_morph
from convwass_addon.bridge.vertex_groups import write_group
from convwass_addon.operators.density_changes import changed_inputs

pytestmark = [
    pytest.mark.usefixtures("empty_scene"),
    # Blender's own exporters under NumPy 2.5.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
]

QUICK = ["--resolution", "24", "--frames", "2"]
FLAT = ["text:A", "text:B", "--resolution", "64", "--frames", "2"]
# The start of a morph is stored explicitly by rebaking, so that it stays in place.
TOLD = {"start", "frame_start"}


@pytest.fixture
def solids(tmp_path):
    """Four shapes in one file, as arguments of the command line."""
    names = []
    for place, make in enumerate(("cube", "ico_sphere", "cone", "cylinder")):
        getattr(bpy.ops.mesh, f"primitive_{make}_add")(location=(3 * place, 0, 0))
        names.append(bpy.context.object.name)
    file = tmp_path / "solids.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    return [f"{file}:{name}" for name in names]


def baked(words, tmp_path):
    """Bake on the command line, open the result, and return the morph with one of its objects active."""
    target = tmp_path / "morph.blend"
    assert cli.main(["morph", "--motion", "transport", *words, "--out", str(target)]) == 0
    bpy.ops.wm.open_mainfile(filepath=str(target))
    return the_morph()


def the_morph():
    (morph,) = (collection for collection in bpy.data.collections if MORPH_KEY in collection)
    return morph


def seen(morph):
    """Return what a morph shows: types and weights of its frames, or the kinds of its files."""
    frames = [(obj.type, [round(w, 6) for w in obj["convwass_weights"]]) for obj in frame_objects(morph)]
    return frames, sorted(obj["convwass_output"] for obj in morph.objects if "convwass_output" in obj)


SOLID = {
    "path": (2, QUICK),
    "blend": (2, ["--weights", "0.25,0.75", "--resolution", "24"]),
    "grid": (4, ["--layout", "grid", "--steps", "2", "--resolution", "24"]),
    "triangle": (3, ["--layout", "triangle", "--steps", "2", "--resolution", "24"]),
    "player": (2, [*QUICK, "--output", "player"]),
    "pad": (3, ["--layout", "triangle", "--steps", "2", "--resolution", "24", "--output", "pad"]),
    "volume": (2, [*QUICK, "--output", "volume"]),
    "alembic": (2, [*QUICK, "--output", "alembic"]),
    "settings": (
        2,
        [*QUICK, "--align", "principal-axes", "--scale", "equal-volume", "--blur", "1.25", "--sharpness", "0.5"],
    ),
}
LETTERS = {
    "curve": [],
    "mesh": ["--flat-output", "mesh"],
    "drawing": ["--flat-output", "drawing"],
    "picture": ["--flat-output", "picture", "--grays", "threshold"],
    "letters": ["--words", "letters"],
}


def compare(morph):
    before, shown, name = stored_morph(morph), seen(morph), morph.name
    assert bpy.ops.convwass.rebake_morph(which="ALL") == {"FINISHED"}
    again = the_morph()
    after = stored_morph(again)
    assert again.name == name and seen(again) == shown
    assert after.first_frame == before.first_frame
    assert {key: value for key, value in after.settings.items() if key not in TOLD and key != "tolerance"} == {
        key: value for key, value in before.settings.items() if key not in TOLD and key != "tolerance"
    }


@pytest.mark.parametrize("kind", SOLID)
def test_a_morph_of_solids_is_rebaked_with_its_settings(solids, tmp_path, kind):
    count, options = SOLID[kind]
    compare(baked([*solids[:count], *options], tmp_path))


@pytest.mark.parametrize("kind", LETTERS)
def test_a_morph_of_letters_is_rebaked_with_its_settings(tmp_path, kind):
    compare(baked([*FLAT, *LETTERS[kind]], tmp_path))


@pytest.mark.parametrize("words", [["--layout", "path"], ["--weights", "1,3"]])
def test_inputs_and_settings_are_taken_over(solids, tmp_path, words):
    morph = baked([*solids[:2], *QUICK, *words, "--align", "centered"], tmp_path)
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}
    own = bpy.context.scene.convwass_morph
    assert {obj.name for obj in bpy.context.selected_objects} == set(stored_morph(morph).inputs)
    assert (own.resolution, own.frames, own.alignment) == (24, 2, "CENTERED")
    assert own.layout == ("BLEND" if "--weights" in words else "PATH")
    assert [item.weight for item in own.inputs] == ([1.0, 3.0] if "--weights" in words else [])


def test_frames_between_others_are_refused_with_a_message(solids, tmp_path):
    morph = baked([*solids[:2], *QUICK, "--cache", str(tmp_path / "cache"), "--at", "0.5,1.5"], tmp_path)
    before = seen(morph)
    with pytest.raises(RuntimeError, match="made with --at"):
        bpy.ops.convwass.rebake_morph(which="ALL")
    assert seen(the_morph()) == before
    bpy.context.view_layer.objects.active = frame_objects(morph)[0]
    assert bpy.ops.convwass.select_morph_inputs() == {"FINISHED"}


def test_all_settings_of_a_bake_are_stored_and_taken_over():
    arguments = bpy.ops.convwass.bake_morph.get_rna_type().properties
    usual = MorphRequest()
    for name, value in usual.as_dict().items():
        if name not in ("weights", "at", "guides"):
            assert arguments[name].default == value, name
    asked = replace(usual, layout="GRID", steps=7, alignment="CENTERED", start="CUSTOM", frame_start=9, words="LETTERS")
    solver = MorphSettings(
        motion="transport", resolution=33, blur=2.0, entropy_limit=-1.5, level="half-max", mend=False
    )
    own = bpy.context.scene.convwass_morph
    own.take_stored({**solver.as_dict(), **asked.as_dict()})
    assert own.request() == asked
    assert own.solver_settings() == solver
    assert own.flat_resolution == 512
    own.take_stored({**FlatSettings(resolution=300).as_dict(), **usual.as_dict(), "flat": True})
    assert (own.flat_settings().resolution, own.flat_settings().words, own.resolution) == (300, "mass", 33)


def test_morphs_of_earlier_versions_load_what_was_done_without_a_choice():
    own = bpy.context.scene.convwass_morph
    own.motion, own.growth = "GUIDED", "SIZE"
    own.take_stored({"resolution": 33})
    assert (own.resolution, own.motion, own.growth) == (33, "TRANSPORT", "VOLUME")


@pytest.fixture
def ball(tmp_path):
    bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=3)
    obj = bpy.context.object
    obj.name = "Ball"
    points = np.array([vertex.co for vertex in obj.data.vertices])
    for name, axis in (("East", 0), ("North", 1), ("Up", 2)):
        write_group(obj, name, (points[:, axis] > 0.8).astype(float))
    file = tmp_path / "ball.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    return SimpleNamespace(word=f"{file}:Ball", out=tmp_path / "flow.blend")


def animated(ball, *words):
    assert cli.main(["density", ball.word, *words, "--out", str(ball.out)]) == 0
    bpy.ops.wm.open_mainfile(filepath=str(ball.out))
    obj = bpy.data.objects["Ball"]
    bpy.context.view_layer.objects.active = obj
    return obj


@pytest.mark.parametrize(
    "words",
    [
        ["--from", "East", "--to", "North", "--steps", "3"],
        ["--through", "East", "North", "Up", "--steps", "2", "--trail", "--entropy-limit", "off"],
        ["--from", "Up", "--to", "East", "--steps", "2", "--entropy-limit", "-1.5", "--blur", "0.35", "--match-pieces"],
    ],
)
def test_a_density_is_interpolated_again_with_its_settings(ball, words):
    obj = animated(ball, *words)
    before, frames = stored_density(obj, "Density"), stored_frames(obj)
    assert changed_inputs(obj, before) == []
    assert bpy.ops.convwass.rebake_density(only_if_changed=True) == {"CANCELLED"}
    assert bpy.ops.convwass.rebake_density() == {"FINISHED"}
    after = stored_density(obj, "Density")
    assert after.inputs == before.inputs and after.settings.keys() == before.settings.keys()
    for name, value in before.settings.items():
        # Blender stores single precision.
        assert after.settings[name] == (pytest.approx(value, rel=1e-6) if _is_numeric(value) else value), name
    np.testing.assert_allclose(after.times, before.times, atol=1e-6)
    np.testing.assert_allclose(stored_frames(obj), frames, atol=2e-3)


def _is_numeric(value):
    items = value if isinstance(value, list) else [value]
    return all(isinstance(item, (int, float)) and not isinstance(item, bool) for item in items)


def test_a_density_without_groups_is_refused(ball):
    animated(ball, "--from", "vertex:1", "--to", "vertex:9", "--steps", "2")
    with pytest.raises(RuntimeError, match="no vertex group vertex:1"):
        bpy.ops.convwass.rebake_density()
