# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A density as one animated attribute: its values at any frame, with nothing but Blender itself."""

from __future__ import annotations

import json
import subprocess
import sys

import bpy
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st

from convwass_addon.bridge.densities.density_attributes import stored_frames
from convwass_addon.bridge.densities.density_nodes import COLORS, NAME, SCALE, color_name, frame_name
from convwass_addon.bridge.densities.density_player import (
    DensityKey,
    animate_density,
    density_modifier,
    density_value,
    played_densities,
    remove_density,
)
from convwass_addon.bridge.densities.density_store import DENSITIES_KEY, StoredDensity, store_density, stored_density
from convwass_addon.bridge.heat_map import heat_colors
from convwass_addon.bridge.keyframes import curves_of
from convwass_addon.bridge.nodes.node_inputs import node_input
from convwass_addon.errors import InputError
from tests.linked_objects import linked_to_new_file

TIMES = np.array([0.0, 0.1, 0.5, 0.55, 1.0])
KEYS = [DensityKey(10, 0.0), DensityKey(30, 1.0)]
ROUNDED = 2.0**-17 + 1e-6
"""What values may be off by: half a step of the stored ones, and single precision."""

READ = """
import bpy, json, sys
import numpy as np

def values_of(obj, name):
    obj = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    values = np.empty(len(obj.data.vertices), np.float32)
    obj.data.attributes[name].data.foreach_get("value", values)
    return values

def values_at(obj, name, frame):
    bpy.context.scene.frame_set(int(np.floor(frame)), subframe=float(frame - np.floor(frame)))
    return values_of(obj, name)
"""
"""Defines `values_of` and `values_at`: what a later modifier or a material reads."""

exec(READ)


@pytest.fixture
def obj(make_object):
    return make_object("A")


@pytest.fixture
def densities():
    """Five frames on the octahedron, some values zero."""
    values = np.random.default_rng(3).uniform(0, 7, (len(TIMES), 6))
    values[values < 1] = 0.0
    return values


def expected(densities, times, value):
    """Mix frames in plain words of NumPy."""
    column = [np.interp(value, times, values) for values in np.asarray(densities).T]
    return np.array(column) / np.max(densities)


def set_value(obj, value, name=NAME):
    density_value(obj, name).set(float(value))
    bpy.context.view_layer.update()


@pytest.mark.parametrize("frame", [-5, 10, 10.5, 12, 17.3, 20, 20.5, 21, 25.99, 30, 90])
def test_every_frame_has_its_values(obj, densities, frame):
    animate_density(obj, densities, TIMES, keys=KEYS)
    value = np.clip((frame - 10) / 20, 0, 1)
    found = values_at(obj, NAME, frame)  # noqa: F821
    np.testing.assert_allclose(found, expected(densities, TIMES, value), atol=5 * ROUNDED)
    assert found.max() <= 1


@settings(max_examples=12, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    gaps=st.lists(st.floats(0.01, 1), min_size=1, max_size=40),
    parts=st.lists(st.floats(0, 1), min_size=3, max_size=3),
    seed=st.integers(0, 99),
)
def test_any_value_of_any_times(obj, gaps, parts, seed):
    times = np.cumsum([3.0, *gaps])
    frames = np.random.default_rng(seed).uniform(0, 1, (len(times), 6))
    animate_density(obj, frames, times)
    for part in [*parts, 0, 1]:
        set_value(obj, part)
        wanted = expected(frames, (times - times[0]) / (times[-1] - times[0]), part)
        # Steps between frames are at least 1/40 of the path, which magnifies errors of single precision accordingly.
        np.testing.assert_allclose(values_of(obj, NAME), wanted, atol=3e-4)  # noqa: F821


def test_easing_is_that_of_the_curve(obj, densities):
    animate_density(obj, densities, TIMES, keys=KEYS, easing="SMOOTH")
    value = (1 - np.cos(np.pi * 0.25)) / 2
    found = values_at(obj, NAME, 15)  # noqa: F821
    np.testing.assert_allclose(found, expected(densities, TIMES, value), atol=1e-4)


def test_several_keys(obj, densities):
    animate_density(obj, densities, TIMES, keys=[*KEYS, DensityKey(30.5, 0.5)])
    np.testing.assert_allclose(
        values_at(obj, NAME, 30.25),  # noqa: F821
        expected(densities, TIMES, 0.75),
        atol=1e-4,
    )


def test_scale_gives_the_densities_back(obj, densities):
    animate_density(obj, densities, TIMES)
    node_input(density_modifier(obj, NAME), SCALE).set(stored_density(obj, NAME).scale)
    set_value(obj, 0.5)
    np.testing.assert_allclose(values_of(obj, NAME), densities[2], atol=1e-4)  # noqa: F821
    np.testing.assert_allclose(stored_frames(obj), densities / densities.max(), atol=ROUNDED)


def test_later_modifiers_interpolate_it_and_carry_no_frames(obj, densities):
    obj.modifiers.new("Subdivision", "SUBSURF").subdivision_type = "SIMPLE"
    animate_density(obj, densities, TIMES)
    assert [modifier.type for modifier in obj.modifiers] == ["NODES", "SUBSURF"]
    set_value(obj, 0.1)
    found = values_of(obj, NAME)  # noqa: F821
    corners = [*(edge.vertices for edge in obj.data.edges), *(face.vertices for face in obj.data.polygons)]
    middles = [expected(densities, TIMES, 0.1)[list(own)].mean() for own in corners]
    np.testing.assert_allclose(np.sort(found[6:]), np.sort(middles), atol=1e-4)
    names = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes.keys()
    assert [name for name in names if "frame" in name] == []


def test_heat_colors(obj, densities):
    modifier = animate_density(obj, densities, TIMES)
    set_value(obj, 0.3)
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert color_name(NAME) not in evaluated.data.attributes
    node_input(modifier, COLORS).set(True)
    bpy.context.view_layer.update()
    colors = obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.attributes[color_name(NAME)].data
    wanted = heat_colors(expected(densities, TIMES, 0.3))
    np.testing.assert_allclose([item.color for item in colors], wanted, atol=2e-3)


def test_again_replaces_frames_and_keeps_keys(obj, densities, inventory):
    animate_density(obj, densities, TIMES, keys=KEYS)
    node_input(density_modifier(obj, NAME), SCALE).set(2.0)
    before = inventory()
    animate_density(obj, 1 - densities[:3] / 7, [0, 0.5, 1])
    assert inventory() == before
    assert len(obj.modifiers) == 1
    assert frame_name(NAME, 2) in obj.data.attributes
    assert frame_name(NAME, 3) not in obj.data.attributes
    np.testing.assert_allclose(
        values_at(obj, NAME, 15),  # noqa: F821
        2 * expected(1 - densities[:3] / 7, [0, 0.5, 1], 0.25),
        atol=1e-4,
    )
    animate_density(obj, densities, TIMES, keys=[DensityKey(1, 1), DensityKey(2, 0)])
    np.testing.assert_allclose(
        values_at(obj, NAME, 100),  # noqa: F821
        2 * expected(densities, TIMES, 0),
        atol=1e-4,
    )


def test_removed_without_a_trace(obj, densities, inventory):
    before, attributes = inventory(), obj.data.attributes.keys()
    animate_density(obj, densities, TIMES, keys=KEYS)
    remove_density(obj)
    assert inventory() == before
    assert obj.data.attributes.keys() == attributes
    assert list(obj.modifiers) == []
    assert obj.animation_data is None or obj.animation_data.action is None
    assert DENSITIES_KEY not in obj
    with pytest.raises(InputError, match="A does not play a density Density"):
        remove_density(obj)


def test_other_animation_of_the_object_is_kept(obj, densities):
    obj.keyframe_insert("location", frame=5)
    animate_density(obj, densities, TIMES, keys=KEYS)
    remove_density(obj)
    assert len(obj.animation_data.action.layers[0].strips[0].channelbags[0].fcurves) == 3


def test_two_densities_side_by_side(obj, densities):
    animate_density(obj, densities, TIMES, NAME)
    animate_density(obj, densities[::-1], 1 - TIMES[::-1], "Density.001")
    assert set(played_densities(obj)) == {NAME, "Density.001"}
    set_value(obj, 0.2, NAME)
    set_value(obj, 0.8, "Density.001")
    wanted = expected(densities, TIMES, 0.2)
    np.testing.assert_allclose(values_of(obj, NAME), wanted, atol=1e-4)  # noqa: F821
    np.testing.assert_allclose(values_of(obj, "Density.001"), wanted, atol=1e-4)  # noqa: F821
    remove_density(obj, NAME)
    np.testing.assert_allclose(values_of(obj, "Density.001"), wanted, atol=1e-4)  # noqa: F821


def test_objects_that_share_the_mesh(obj, densities, bare_scene):
    animate_density(obj, densities, TIMES)
    twin = obj.copy()
    bare_scene.collection.objects.link(twin)
    animate_density(obj, densities[:2], [0, 1])
    for one in (obj, twin):
        set_value(one, 0.5)
        wanted = expected(densities[:2], [0, 1], 0.5)
        np.testing.assert_allclose(values_of(one, NAME), wanted, atol=1e-4)  # noqa: F821
    remove_density(obj)
    np.testing.assert_allclose(values_of(twin, NAME), wanted, atol=1e-4)  # noqa: F821


@pytest.mark.parametrize("has_other_keys", [False, True])
def test_linked_duplicates_keep_their_keys(obj, densities, bare_scene, has_other_keys):
    if has_other_keys:
        obj.keyframe_insert("location", frame=5)
    animate_density(obj, densities, TIMES, keys=KEYS)
    middle = values_at(obj, NAME, 15)  # noqa: F821
    removed, keyed_again = obj.copy(), obj.copy()
    for twin in (removed, keyed_again):
        bare_scene.collection.objects.link(twin)
    assert removed.animation_data.action == obj.animation_data.action
    remove_density(removed)
    animate_density(keyed_again, densities, TIMES, keys=[DensityKey(100, 0.0), DensityKey(200, 1.0)])
    np.testing.assert_allclose(values_at(obj, NAME, 15), middle, atol=1e-4)  # noqa: F821
    np.testing.assert_allclose(values_at(keyed_again, NAME, 15), densities[0] / densities.max(), atol=1e-4)  # noqa: F821
    assert len(curves_of(removed)) == (3 if has_other_keys else 0)
    assert len(bpy.data.actions) == 2 + has_other_keys


def test_copies_with_a_mesh_of_their_own_keep_their_frames(obj, densities, bare_scene):
    animate_density(obj, densities, TIMES)
    twin = obj.copy()
    twin.data = obj.data.copy()
    bare_scene.collection.objects.link(twin)
    animate_density(obj, densities[:2], [0, 1])
    for one, frames, times in ((obj, densities[:2], [0, 1]), (twin, densities, TIMES)):
        set_value(one, 0.3)
        wanted = expected(frames, times, 0.3)
        np.testing.assert_allclose(values_of(one, NAME), wanted, atol=1e-4)  # noqa: F821


@pytest.mark.parametrize(
    ("name", "message"), [("", "needs a name"), *((name, "cannot be") for name in (".hidden", "a*b", "x" * 60))]
)
def test_names_that_cannot_be(obj, densities, name, message):
    with pytest.raises(InputError, match=message):
        animate_density(obj, densities, TIMES, name)


@pytest.mark.parametrize("name", ["position", "Paint"])
def test_names_that_are_taken(obj, densities, name, inventory):
    obj.vertex_groups.new(name="Paint")
    before = inventory()
    with pytest.raises(InputError, match=f"A already has a vertex group or an attribute {name}"):
        animate_density(obj, densities, TIMES, name)
    assert inventory() == before


@pytest.mark.parametrize("name", ["density", "velocity", "heat", "N"])
def test_names_that_renderers_take(obj, densities, name):
    with pytest.raises(InputError, match=f"Renderers use {name} for something else"):
        animate_density(obj, densities, TIMES, name)


def test_strange_names(obj, densities):
    name = 'Ünï "quote" [1]'
    animate_density(obj, densities, TIMES, name, keys=KEYS)
    np.testing.assert_allclose(
        values_at(obj, name, 20),  # noqa: F821
        expected(densities, TIMES, 0.5),
        atol=1e-4,
    )


def test_edit_mode_is_refused(obj, densities):
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    with pytest.raises(InputError, match="A is in Edit Mode"):
        animate_density(obj, densities, TIMES)


@pytest.mark.parametrize(
    ("frames", "times"),
    [
        (np.ones((1, 6)), [0]),
        (np.ones((2, 5)), [0, 1]),
        (np.ones((2, 6)), [0, 0]),
        (-np.ones((2, 6)), [0, 1]),
        (np.full((2, 6), np.nan), [0, 1]),
    ],
)
def test_arrays_that_do_not_fit(obj, frames, times):
    with pytest.raises(ValueError, match=r"densities|times"):
        animate_density(obj, frames, times)
    assert list(obj.modifiers) == []


def test_densities_without_mass(obj):
    animate_density(obj, np.zeros((2, 6)), [0, 1])
    assert not values_of(obj, NAME).any()  # noqa: F821


def test_stored_settings(obj, densities):
    told = StoredDensity(["Head", "Tail"], {"blur": 0.1, "steps": 5}, [{"iterations": 3}])
    animate_density(obj, densities, 10 * TIMES, description=told)
    found = stored_density(obj, NAME)
    assert (found.inputs, found.settings, found.records) == (told.inputs, told.settings, told.records)
    assert found.times == pytest.approx(TIMES.tolist())
    assert found.scale == densities.max()
    animate_density(obj, densities[:2], [0, 1])
    assert stored_density(obj, NAME).inputs == ["Head", "Tail"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "damaged"),
        ("[]", "not a table"),
        ('{"schema": 2, "densities": {}}', "schema 2"),
        ('{"schema": 1, "densities": []}', "not a table"),
        ('{"schema": 1, "densities": {"Density": 1}}', "not a table"),
        ('{"schema": 1, "densities": {"Density": {}}}', "inputs"),
        ("NaN", "NaN where a number belongs"),
        ("[" * 100_000, "damaged"),
        ('{"schema": 1, "densities": {}}', "no baked density"),
    ],
)
def test_damaged_memories(obj, densities, text, words):
    obj[DENSITIES_KEY] = text
    with pytest.raises(InputError, match=words):
        stored_density(obj, NAME)
    animate_density(obj, densities, TIMES)
    assert stored_density(obj, NAME).times == pytest.approx(TIMES.tolist())


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("inputs", [1]),
        ("settings", {"a": {"b": 1}}),
        ("records", [1]),
        ("times", [1, 0]),
        ("times", [True]),
        ("scale", 0),
        ("scale", True),
        ("outputs", {"groups": [1]}),
    ],
)
def test_every_field_is_checked(obj, field, value):
    store_density(obj, NAME, StoredDensity(outputs={"groups": ["a"]}))
    data = json.loads(obj[DENSITIES_KEY])
    data["densities"][NAME][field] = value
    obj[DENSITIES_KEY] = json.dumps(data)
    with pytest.raises(InputError, match="damaged"):
        stored_density(obj, NAME)


def test_it_plays_in_a_blender_without_the_extension(obj, densities, tmp_path):
    animate_density(obj, densities, TIMES, keys=KEYS)
    frames = [5, 10, 11.25, 20.5, 29.9, 40]
    file, answer_file = tmp_path / "plain.blend", tmp_path / "found.json"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    script = (
        f"{READ}\n"
        f"bpy.ops.wm.open_mainfile(filepath={str(file)!r}, use_scripts=False)\n"
        "def all_values(obj):\n"
        f"    return [values_at(obj, {NAME!r}, frame).tolist() for frame in {frames}]\n"
        "found = {'opened': all_values(bpy.data.objects['A'])}\n"
        "for link in (True, False):\n"
        "    bpy.ops.wm.read_factory_settings(use_empty=True)\n"
        f"    with bpy.data.libraries.load({str(file)!r}, link=link) as (source, target):\n"
        "        target.objects = ['A']\n"
        "    bpy.context.scene.collection.objects.link(target.objects[0])\n"
        "    found['linked' if link else 'appended'] = all_values(target.objects[0])\n"
        "assert not any(name.startswith('convwass_addon') for name in sys.modules)\n"
        f"open({str(answer_file)!r}, 'w').write(json.dumps(found))\n"
        "import os; os._exit(0)\n"
    )
    answer = subprocess.run([sys.executable, "-I", "-c", script], capture_output=True, text=True, timeout=300)
    assert answer.returncode == 0, answer.stdout + answer.stderr
    found = json.loads(answer_file.read_text())
    wanted = [expected(densities, TIMES, np.clip((frame - 10) / 20, 0, 1)) for frame in frames]
    for way in ("opened", "linked", "appended"):
        np.testing.assert_allclose(found[way], wanted, atol=1e-4, err_msg=way)


def test_linked_objects_are_refused(obj, densities, tmp_path):
    linked = linked_to_new_file("A", tmp_path)
    with pytest.raises(InputError, match="A is linked from another file"):
        animate_density(linked, densities, TIMES)


def test_no_modifier_of_another_kind_is_taken(obj, densities):
    obj.modifiers.new("Play Density", "NODES")
    with pytest.raises(InputError, match="does not play a density"):
        density_modifier(obj)
    animate_density(obj, densities, TIMES)
    assert len(obj.modifiers) == 2
