# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Presets that are shipped, presets that users add, and the preferences that name one of them."""

from __future__ import annotations

import typing
from pathlib import Path
from types import SimpleNamespace

import bpy
import pytest

import convwass_addon
from convwass_addon import preferences, solver_presets
from convwass_addon.preferences import Preferences
from convwass_addon.properties.morph_solver import SolverProperties
from convwass_addon.solver_presets import PRESET_PROPERTIES, SUBFOLDER, apply_preset, is_untouched, preset_names

pytestmark = pytest.mark.usefixtures("empty_scene")

SHIPPED = Path(convwass_addon.__file__).parent / "presets" / SUBFOLDER


def settings():
    return bpy.context.scene.convwass_morph


def values():
    return {name: getattr(settings(), name) for name in PRESET_PROPERTIES}


def test_the_shipped_ones_are_found_and_get_finer():
    assert preset_names() == ["Draft", "Fine", "Standard"]
    found = {}
    for name in preset_names():
        assert apply_preset(name)
        found[name] = settings().resolution
    assert found["Draft"] < found["Standard"] < found["Fine"]
    assert not apply_preset("No Such")


def test_the_standard_preset_equals_a_new_scene():
    before = values()
    apply_preset("Standard")
    assert values() == before


@pytest.mark.parametrize("name", ["Draft", "Standard", "Fine"])
def test_the_shipped_ones_set_everything(name):
    apply_preset(name)
    expected = values()
    for prop in settings().bl_rna.properties:
        if prop.identifier in PRESET_PROPERTIES:
            setattr(settings(), prop.identifier, another_value(prop))
    assert not any(value == expected[prop] for prop, value in values().items())
    apply_preset(name)
    assert values() == expected


def another_value(prop):
    """A value that no preset sets."""
    if prop.type == "BOOLEAN":
        return not prop.default
    if prop.type == "ENUM":
        return next(item.identifier for item in prop.enum_items if item.identifier != prop.default)
    most = prop.hard_max if prop.hard_max < 1e9 else 7.0
    return most if most != prop.default else prop.hard_min


def test_presets_keep_settings_of_the_shapes():
    solver = set(PRESET_PROPERTIES)
    assert solver < set(SolverProperties.__annotations__)
    assert not solver & {"thickness", "parts", "layout", "frames"}


def test_users_add_and_remove_their_own():
    settings().resolution, settings().use_custom_blur, settings().blur = 77, True, 2.5
    assert bpy.ops.convwass.add_solver_preset(name="My Own") == {"FINISHED"}
    try:
        assert "My Own" in preset_names()
        settings().resolution, settings().blur = 20, 1.0
        path = bpy.utils.preset_find("My Own", SUBFOLDER, display_name=True)
        bpy.ops.script.execute_preset(filepath=path, menu_idname=solver_presets.MENU)
        assert (settings().resolution, settings().blur) == (77, 2.5)
    finally:
        bpy.ops.convwass.add_solver_preset(name="My Own", remove_name=True)
    assert "My Own" not in preset_names()


def test_the_default_preset_is_applied_to_the_first_shapes_of_an_unchanged_scene(monkeypatch):
    module = "convwass_addon.operators.morph_inputs.preferences"
    monkeypatch.setattr(module, lambda _: Preferences(default_preset="Fine"))
    bpy.ops.mesh.primitive_cube_add()
    assert is_untouched(settings())
    bpy.ops.convwass.add_morph_inputs()
    assert settings().resolution == 160
    bpy.ops.convwass.clear_morph_inputs()
    settings().resolution = 33
    bpy.ops.convwass.add_morph_inputs()
    assert settings().resolution == 33


@pytest.mark.parametrize(
    "content", ["settings.", "1 / 0", "\0", "bpy.context.scene.convwass_morph.resolution = 'many'", "raise"]
)
def test_an_invalid_default_preset_is_reported_and_ignored(content, monkeypatch, tmp_path, capfd):
    preset = tmp_path / "Broken.py"
    preset.write_text(f"import bpy\n{content}\n", encoding="utf-8")
    monkeypatch.setattr(bpy.utils, "preset_find", lambda *_, **__: str(preset))
    bpy.ops.mesh.primitive_cube_add()
    assert bpy.ops.convwass.add_morph_inputs() == {"FINISHED"}
    assert [item.object for item in settings().inputs] == [bpy.context.object]
    told = capfd.readouterr()
    assert "The preset Standard cannot be used" in told.out and "Traceback" not in told.out + told.err


def two_shapes():
    bpy.ops.mesh.primitive_cube_add(location=(-3, 0, 0))
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=6)
    bpy.ops.object.select_all(action="SELECT")


def with_preferences(**values):
    """A context whose add-on has these preferences."""
    usual = {"cache_folder": "", "spare_megabytes": 1000, "threads": 0, "default_preset": "Standard"}
    own = SimpleNamespace(**{**usual, **values})
    addons = {"convwass_addon": SimpleNamespace(preferences=own)}
    return SimpleNamespace(preferences=SimpleNamespace(addons=addons))


def test_preferences_are_read(tmp_path):
    assert preferences.preferences(bpy.context) == Preferences()
    # What is no installed extension has no folder of its own.
    assert preferences.preferences(with_preferences()) == Preferences(spare_bytes=1_000_000_000)
    read = preferences.preferences(with_preferences(cache_folder=str(tmp_path), threads=3, default_preset="Fine"))
    assert read == Preferences(tmp_path, None, 1_000_000_000, 3, "Fine")


def test_an_extension_keeps_frames_in_its_own_folder_by_default(monkeypatch, tmp_path):
    monkeypatch.setattr(bpy.utils, "extension_path_user", lambda name, path: str(tmp_path / name / path))
    own = tmp_path / "convwass_addon" / "frames"
    assert preferences.preferences(with_preferences()) == Preferences(None, own, 1_000_000_000)
    assert preferences.preferences(with_preferences(spare_megabytes=0)).spare_folder is None
    assert preferences.preferences(with_preferences(cache_folder=str(tmp_path))).spare_folder is None


def test_an_interrupted_bake_continues_from_kept_frames(monkeypatch, tmp_path, capfd):
    """Blender was closed, or another file opened: pressing the button again is enough."""
    spare = Preferences(None, tmp_path / "spare", 1_000_000_000, 1)
    monkeypatch.setattr("convwass_addon.operators.morph_bake.preferences", lambda: spare)
    two_shapes()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs="Cube, Sphere", frames=8, resolution=24)
    for path in sorted((tmp_path / "spare").iterdir(), key=lambda path: path.stat().st_mtime_ns)[-2:]:
        path.unlink()
    bpy.ops.convwass.bake_morph(motion="TRANSPORT", inputs="Cube, Sphere", frames=8, resolution=24)
    told = [line for line in capfd.readouterr().out.splitlines() if "meshes" in line]
    assert [line.rpartition(": ")[2] for line in told] == [
        "9 meshes, frames 1 to 9",
        "9 meshes, 4 of them from the cache, frames 1 to 9",
    ]


def test_a_bake_without_a_usable_folder_continues_and_reports_it(monkeypatch, tmp_path, capfd):
    (tmp_path / "file").write_text("")
    spare = Preferences(None, tmp_path / "file", 1_000_000_000, 1)
    monkeypatch.setattr("convwass_addon.operators.morph_bake.preferences", lambda: spare)
    two_shapes()
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24) == {"FINISHED"}
    assert "Warning: The cache folder" in capfd.readouterr().out


def test_a_bake_keeps_its_frames_where_the_preferences_say(monkeypatch, tmp_path):
    monkeypatch.setattr(
        "convwass_addon.operators.morph_bake.preferences", lambda: Preferences(tmp_path / "cache", workers=1)
    )
    two_shapes()
    assert bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24) == {"FINISHED"}
    assert len(list((tmp_path / "cache").glob("*.frame"))) == 3


def test_an_invalid_cache_folder_is_reported_and_nothing_is_left_behind(monkeypatch, tmp_path):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("convwass_addon.operators.morph_bake.preferences", lambda: Preferences(tmp_path / "file"))
    two_shapes()
    with pytest.raises(RuntimeError, match="cache folder"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24)
    assert len(bpy.data.collections) == 0


@pytest.mark.parametrize("given", ["//frames", "frames"])
def test_a_cache_folder_that_depends_on_the_open_file_is_refused(monkeypatch, tmp_path, given):
    read = preferences.preferences(with_preferences(cache_folder=given))
    monkeypatch.setattr("convwass_addon.operators.morph_bake.preferences", lambda: read)
    monkeypatch.chdir(tmp_path)
    two_shapes()
    with pytest.raises(RuntimeError, match="The cache folder frames is relative, so it depends on the file"):
        bpy.ops.convwass.bake_morph(motion="TRANSPORT", frames=2, resolution=24)
    assert not list(tmp_path.iterdir())
    assert len(bpy.data.collections) == 0


def test_preferences_show_all_that_they_have():
    drawn = []
    layout = SimpleNamespace(prop=lambda _, name: drawn.append(name), row=lambda: layout)
    preferences.CONVWASS_AP_preferences.draw(SimpleNamespace(layout=layout, cache_folder=""), bpy.context)
    assert drawn == ["cache_folder", "spare_megabytes", "threads", "default_preset"]
    default = typing.get_type_hints(preferences.CONVWASS_AP_preferences, vars(preferences))["default_preset"]
    assert default.keywords["search"](None, None, "f") == ["Draft", "Fine"]
