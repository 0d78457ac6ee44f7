# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the panels show, drawn into a recording layout; drawing has no other effect."""

from __future__ import annotations

import json
from types import SimpleNamespace

import bpy
import pytest

from convwass_addon.applications.morphs.diagnostics import Diagnostic
from convwass_addon.bridge.morphs.stored import frame_objects, store_diagnostics
from convwass_addon.panels.sidebar import draw_wrapped
from tests.operators.morphs import baked_morph

from .drawing import draw, forbid, named, panels
from .fake_layout import FakeLayout

pytestmark = pytest.mark.usefixtures("empty_scene")

LAYOUTS = ("PATH", "GRID", "TRIANGLE", "BLEND")


def draw_all(context=None):
    """Return what the panels of morphs draw; the others have tests of their own."""
    shown = [panel for panel in panels() if "morph" in panel.__name__]
    return [entry for panel in shown for entry in draw(panel, context)]


def settings():
    return bpy.context.scene.convwass_morph


@pytest.fixture
def shapes():
    bpy.ops.mesh.primitive_cube_add(location=(-3, 0, 0))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6)
    bpy.ops.object.select_all(action="SELECT")


@pytest.fixture
def baked(shapes):
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24)
    return baked_morph()


def test_an_empty_scene_shows_instructions():
    assert ("label", "Select at least two shapes") in draw_all()


def test_nothing_is_to_be_selected_while_a_bake_hides_the_shapes():
    progress = bpy.context.window_manager.convwass_progress
    progress.running = True
    drawn = draw(bpy.types.CONVWASS_PT_morph)
    progress.running = False
    assert ("label", "The shapes are hidden meanwhile") in drawn
    assert "Select at least" not in " ".join(text for _, text in drawn)


@pytest.mark.parametrize(("layout", "wanted"), {"GRID": "four", "TRIANGLE": "three", "BLEND": "at least two"}.items())
def test_without_a_selection_the_number_of_shapes_for_the_layout_is_shown(layout, wanted):
    settings().layout = layout
    drawn = draw(bpy.types.CONVWASS_PT_morph)
    assert ("label", f"Select {wanted} shapes") in drawn
    assert "This layout requires" not in " ".join(text for _, text in drawn)


def test_settings_do_not_move_when_nothing_is_selected():
    """Otherwise buttons move under the mouse."""
    without = [entry for entry in draw(bpy.types.CONVWASS_PT_morph) if entry[0] == "prop"]
    assert {("prop", "resolution"), ("prop", "motion")} <= set(without)
    bpy.ops.mesh.primitive_cube_add()
    assert [entry for entry in draw(bpy.types.CONVWASS_PT_morph) if entry[0] == "prop"] == without


def test_a_baked_sheet_offers_its_hidden_shapes(shapes):
    bpy.ops.mesh.primitive_cone_add(location=(3, 0, 0))
    bpy.ops.object.select_all(action="SELECT")
    assert ("operator", "convwass.select_morph_inputs") not in draw_all()
    settings().layout = "TRIANGLE"
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="TRIANGLE", steps=2, resolution=24, hide_inputs=True)
    # As after a bake whose objects are shown by something else.
    bpy.ops.object.select_all(action="DESELECT")
    drawn = draw(bpy.types.CONVWASS_PT_morph)
    assert {("label", "Select three shapes"), ("operator", "convwass.select_morph_inputs")} <= set(drawn)
    bpy.ops.convwass.select_morph_inputs()
    drawn = draw(bpy.types.CONVWASS_PT_morph)
    assert {("label", "Cone"), ("label", "Cube"), ("label", "Sphere")} <= set(drawn)
    assert ("operator", "convwass.select_morph_inputs") not in drawn


def test_the_selection_is_named_until_there_is_a_list(shapes):
    assert {("label", "Cube"), ("label", "Sphere"), ("text", "Make a List")} <= set(draw_all())
    bpy.ops.convwass.add_morph_inputs()
    drawn = draw_all()
    assert ("label", "Cube") not in drawn
    assert ("prop", "order") not in drawn
    assert drawn.count(("prop", "enabled")) == 2


def test_a_long_selection_is_cut_short():
    for _ in range(12):
        bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.select_all(action="SELECT")
    drawn = draw_all()
    assert ("label", "and 4 more") in drawn


def test_weights_are_shown_for_a_single_blend_only(shapes):
    bpy.ops.convwass.add_morph_inputs()
    shown = {}
    for layout in LAYOUTS:
        settings().layout = layout
        shown[layout] = ("prop", "weight") in draw_all()
    assert shown == {"PATH": False, "GRID": False, "TRIANGLE": False, "BLEND": True}


def test_only_defective_shapes_have_a_warning(shapes):
    bpy.ops.mesh.primitive_plane_add()
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.convwass.add_morph_inputs()
    # One of them is the button next to the list.
    assert draw_all().count(("operator", "convwass.check_morph_inputs")) == 2


def test_a_wrong_number_of_shapes_is_reported(shapes):
    settings().layout = "GRID"
    assert "This layout requires 4 shapes, not 2" in " ".join(text for _, text in draw_all())


@pytest.mark.parametrize("layout", ["PATH", "BLEND"])
def test_a_message_explains_the_disabled_button_if_the_list_is_too_short(shapes, layout):
    bpy.ops.convwass.add_morph_inputs()
    settings().layout = layout
    hint = ("label", "Add at least two shapes to the list")
    assert hint not in draw_all()
    settings().inputs[0].enabled = False
    assert hint in draw_all()


def test_objects_of_one_collection_are_offered_as_one_shape(shapes):
    """Two objects and a third one: three shapes, or two collections."""
    bpy.ops.mesh.primitive_cube_add(location=(3, 0, 0))
    other = bpy.data.collections.new("Other")
    bpy.context.scene.collection.children.link(other)
    other.objects.link(bpy.context.object)
    body = bpy.data.collections.new("Body")
    bpy.context.scene.collection.children.link(body)
    for obj in bpy.context.scene.objects:
        obj.select_set(True)
        if obj.users_collection[0] != other and other not in set(obj.users_collection):
            body.objects.link(obj)
    assert ("label", "3 selected objects: 3 shapes") in draw(bpy.types.CONVWASS_PT_morph)
    settings().grouping = "COLLECTIONS"
    drawn = draw(bpy.types.CONVWASS_PT_morph)
    assert ("label", "3 selected objects: 2 shapes") in drawn
    assert {("label", "Body"), ("label", "Other")} <= set(drawn)


def test_large_memory_use_is_shown_before_a_bake(shapes):
    settings().resolution = 1000
    assert settings().resolution == 1000
    assert any(text.startswith("Takes about ") for _, text in draw(bpy.types.CONVWASS_PT_morph))
    settings().resolution = 100
    assert not any(text.startswith("Takes about ") for _, text in draw(bpy.types.CONVWASS_PT_morph))


def test_flat_shapes_have_separate_settings():
    for text in ("A", "B"):
        bpy.ops.object.text_add()
        bpy.context.object.data.body = text
    bpy.ops.object.select_all(action="SELECT")
    drawn = draw_all()
    assert {("label", "Text"), ("prop", "flat_resolution"), ("prop", "words"), ("prop", "flat_output")} <= set(drawn)
    assert ("prop", "resolution") not in drawn
    bpy.ops.mesh.primitive_cube_add()
    bpy.ops.object.select_all(action="SELECT")
    assert ("prop", "resolution") in draw_all()


@pytest.mark.parametrize("layout", LAYOUTS)
def test_every_setting_is_shown(shapes, layout):
    """Every setting of the operator, for at least one layout."""
    settings().layout = layout
    settings().start, settings().entropy_limit, settings().output = "CUSTOM", "NUMBER", "CACHE"
    drawn = named(draw_all(), "prop")
    from convwass_addon.properties.morphs import MorphProperties

    only = {"frames": ("PATH",), "steps": ("GRID", "TRIANGLE")}
    only |= dict.fromkeys(("frame_step", "start", "frame_start", "fit_range", "follow"), ("PATH",))
    settings().output = "PLAYER"
    drawn |= named(draw_all(), "prop")
    # Shape keys have a time in every layout.
    settings().output = "SHAPE_KEYS"
    drawn |= named(draw_all(), "prop") - only.keys()
    flat = {"flat_resolution", "words", "flat_output", "grays"}
    every = {name for base in MorphProperties.__mro__ for name in vars(base).get("__annotations__", {})}
    assert len(every) > 30
    assert {name for name in every if layout in only.get(name, LAYOUTS)} - flat == drawn & every


@pytest.mark.parametrize("layout", LAYOUTS)
def test_shape_keys_have_frames_and_no_layout(shapes, layout):
    settings().layout, settings().output = layout, "SHAPE_KEYS"
    drawn = draw_all()
    assert {("prop", "frames"), ("prop", "start")} <= set(drawn)
    assert not {("prop", "layout"), ("prop", "steps"), ("prop", "weight"), ("prop", "frame_step")} & set(drawn)
    assert "This layout requires" not in " ".join(text for _, text in drawn)


def test_an_output_that_the_layout_cannot_have_is_explained(shapes):
    settings().layout, settings().output = "BLEND", "PLAYER"
    assert "there is nothing to play" in " ".join(text for _, text in draw_all())
    settings().output = "OBJECTS"
    assert "there is nothing to play" not in " ".join(text for _, text in draw_all())


def test_pictures_have_settings_for_grays_and_folder(shapes):
    settings().output, settings().flat_output = "OBJECTS", "CURVE"
    assert not {("prop", "grays"), ("prop", "folder")} & set(draw_all())
    settings().flat_output = "PICTURE"
    assert {("prop", "grays"), ("prop", "folder")} <= set(draw_all())


def test_objects_that_show_all_frames_have_no_other_buttons(baked):
    frame_objects(baked)[0]["convwass_alone"] = True
    drawn = draw_all()
    assert ("operator", "convwass.make_player") not in drawn
    assert ("operator", "convwass.make_cache") not in drawn
    assert ("operator", "convwass.delete_morph") in drawn


def test_a_single_blend_is_neither_played_nor_a_pad(shapes):
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", layout="BLEND", resolution=24)
    offered = named(draw_all(), "operator")
    assert "convwass.make_volume" in offered
    assert not {"convwass.make_player", "convwass.make_blend_pad"} & offered


def test_a_morph_whose_frames_are_files_has_no_other_output(baked, tmp_path):
    bpy.ops.convwass.make_volume(folder=str(tmp_path))
    offered = named(draw_all(), "operator")
    assert "convwass.rebake_morph" in offered
    assert not offered & {"convwass.make_player", "convwass.make_blend_pad", "convwass.make_volume"}


def test_a_baked_morph_shows_its_buttons_and_its_diagnostics(baked):
    assert ("operator", "convwass.delete_morph") in draw_all()
    assert ("operator", "convwass.make_player") in draw_all()
    store_diagnostics(baked, [Diagnostic("NOT_CONVERGED", {"frames": "2-3", "error": 0.03})])
    text = " ".join(text for kind, text in draw_all() if kind == "label")
    assert "Less exact than asked for in 2-3, by up to 3.0%" in text
    baked["convwass_health"] = json.dumps([["NOT_CONVERGED", {}]])
    assert ("label", "No diagnostics available") in draw_all()


def test_sentences_are_wrapped_completely_to_the_width():
    text = "Resolution 64 is too coarse for thin parts of Cow (1.2 cells): 112 keeps them"
    system = SimpleNamespace(ui_scale=1.0)
    for width in (1, 200, 280, 900):
        context = SimpleNamespace(region=SimpleNamespace(width=width), preferences=SimpleNamespace(system=system))
        layout = FakeLayout()
        draw_wrapped(layout, context, text, "INFO")
        lines = [line for _, line in layout.drawn]
        assert " ".join(lines) == text
        assert len(lines) == 1 or max(map(len, lines)) <= max(16, (width - 60) / 6.2)


def test_sentences_are_drawn_where_the_interface_has_no_scale():
    """As in a Blender without a window."""
    system = SimpleNamespace(ui_scale=0.0)
    context = SimpleNamespace(region=SimpleNamespace(width=280), preferences=SimpleNamespace(system=system))
    layout = FakeLayout()
    draw_wrapped(layout, context, "one two three four five", "INFO")
    assert [line for _, line in layout.drawn] == ["one two three", "four five"]


def test_drawing_computes_and_writes_nothing(baked, monkeypatch):
    forbid(
        monkeypatch,
        "applications.morphs.shape_check.check_shape",
        "bridge.morphs.inputs.input_checks.triangle_mesh",
        "bridge.morphs.job.morph",
        "bridge.morphs.inputs.shape_reading.aligned_meshes",
        "bridge.morphs.inputs.shape_reading.triangle_mesh",
        "bridge.morphs.bake.diagnose",
    )
    for layout in LAYOUTS:
        settings().layout = layout
        before = contents()
        draw_all()
        assert contents() == before


def contents():
    """All that drawing could change: data-blocks, and settings of the scene."""
    own = settings()
    names = [prop.identifier for prop in own.bl_rna.properties if prop.identifier != "rna_type"]
    values = {name: str(getattr(own, name)) for name in names}
    return values, {(block.id_type, block.name) for block in bpy.data.user_map()}


def test_changed_shapes_of_a_morph_are_reported(baked):
    assert not [text for _, text in draw_all() if text.startswith("Changed since")]
    bpy.data.objects["Cube"].location.z += 1.0
    bpy.context.view_layer.update()
    assert "Changed since it was baked: Cube" in " ".join(text for _, text in draw_all())


def test_a_player_shows_its_value_and_how_to_remove_it(baked):
    bpy.ops.convwass.make_player()
    drawn = draw(bpy.types.CONVWASS_PT_baked_morph)
    offered = named(drawn, "operator")
    assert "convwass.remove_player" in offered
    assert "convwass.make_player" not in offered
    assert [name for kind, name in drawn if kind == "text" and name in ("Morph", "Playback")] == ["Morph", "Playback"]
