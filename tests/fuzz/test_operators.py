# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators in unexpected contexts, with unexpected data and arguments: a message, never a traceback."""

from __future__ import annotations

from random import Random

import bpy
import pytest

from tests.fuzz.__main__ import BAD, batch
from tests.fuzz.operator_session import stored_keys
from tests.fuzz.stages import baked_morph, solved_density, stored_map
from tests.linked_objects import linked_to_new_file
from tests.operators.densities import ball
from tests.panels.drawing import draw, panels
from tests.rigs import chain

SESSIONS = 2
NONSENSE = ("", "{", "[" * 100_000, "null", 3, 2.5, [1, 2], b"CWMAP\0xxxx", "[[1, 2]]", '{"schema": 1}')


def operators():
    return [getattr(bpy.ops.convwass, name) for name in dir(bpy.ops.convwass)]


def test_a_few_sessions_of_the_campaign_pass():
    found = batch("tests", 0, SESSIONS)
    assert found[-1]["session"] == SESSIONS - 1, "the process ended early"
    assert [entry for entry in found if entry.get("outcome") in BAD] == []
    assert any(entry.get("outcome") == "finished" for entry in found)


@pytest.mark.usefixtures("empty_scene")
def test_without_a_window_operators_are_refused_quietly(capfd):
    """In a timer, the context has neither an active object nor a selection."""
    ball()
    with bpy.context.temp_override(window=None, area=None, region=None):
        assert not hasattr(bpy.context, "object")
        for operator in operators():
            operator.poll()
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize("value", NONSENSE, ids=lambda value: str(value)[:12])
def test_invalid_stored_data_gives_no_traceback(value, capfd):
    for make in (baked_morph, solved_density, stored_map):
        make(Random(0), bpy.context.scene, bpy.ops.convwass)
    for block in (*bpy.data.objects, *bpy.data.collections):
        for key in stored_keys(block):
            block[key] = value
    for panel in panels():
        draw(panel)
    for name in ("rebake_morph", "delete_morph", "make_player", "make_cache", "rebake_density", "transfer_by_map"):
        try:
            getattr(bpy.ops.convwass, name)()
        except RuntimeError as error:
            assert "Traceback" not in str(error), (name, error)
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.usefixtures("empty_scene")
def test_scripts_may_choose_objects_not_offered_by_panels(capfd):
    rig = chain(2)
    scene = bpy.context.scene
    own = scene.convwass_soft_map
    own.source = own.target = scene.convwass_recolor.palette_object = rig
    ball().data.color_attributes.new("Col", "FLOAT_COLOR", "POINT")
    for operator in operators():
        operator.poll()
    for name in ("add_map_pair", "recolor_attribute", "compute_soft_map"):
        assert not getattr(bpy.ops.convwass, name).poll()
    assert "Traceback" not in capfd.readouterr().err


@pytest.mark.usefixtures("empty_scene")
@pytest.mark.parametrize("thickness", [1e3, 1e30, float("inf"), float("nan")])
def test_an_extreme_thickness_is_refused(thickness):
    for place in (0, 3):
        bpy.ops.mesh.primitive_plane_add(location=(place, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    with pytest.raises(RuntimeError, match=r"[Tt]hickness"):
        bpy.ops.convwass.bake_morph(
            motion="TRANSPORT", frames=2, resolution=24, thickness=thickness, flat_output="MESH"
        )


@pytest.mark.usefixtures("empty_scene")
def test_an_odd_number_of_rows_is_made_even():
    own = bpy.context.scene.convwass_reflectance
    own.detail = 9
    assert own.reflectance_settings().rows == 10


def _linked_and_overridden(obj):
    """Yield a linked object, and then the library override that replaces it."""
    yield obj
    yield obj.override_create(remap_local_usages=True)


@pytest.mark.usefixtures("empty_scene")
def test_lists_of_linked_objects_are_unchanged(tmp_path, capfd):
    obj = ball()
    bpy.ops.convwass.add_density_stop(group="A")
    for own in _linked_and_overridden(linked_to_new_file(obj.name, tmp_path)):
        bpy.context.view_layer.objects.active = own
        for operator in ("add", "remove", "move"):
            assert not getattr(bpy.ops.convwass, f"{operator}_density_stop").poll()
        assert not bpy.ops.convwass.clear_density_stops.poll()
    assert "Traceback" not in capfd.readouterr().err
