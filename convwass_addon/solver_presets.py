# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Solver presets: shipped ones in ``presets``, and those that users save in their own folder."""

from __future__ import annotations

from pathlib import Path

import bpy
from bl_operators.presets import AddPresetBase

from .applications.morphs.morph_settings import MorphSettings
from .errors import InputError
from .schema import settings_of

SUBFOLDER = "convwass/solver"
"""Path of the presets within a preset folder."""

MENU = "CONVWASS_PT_solver_presets"
"""The popover that lists the presets."""

PRESET_PROPERTIES = tuple(name for one in settings_of(MorphSettings) if one.preset for name in one.properties)
"""Properties set by a preset; thickness and parts are excluded because they depend on the shapes."""


class CONVWASS_OT_add_solver_preset(AddPresetBase, bpy.types.Operator):
    """Save the solver settings as a preset, or remove a preset"""

    bl_idname = "convwass.add_solver_preset"
    bl_label = "Add Solver Preset"
    preset_menu = MENU
    preset_subdir = SUBFOLDER
    preset_defines = ("settings = bpy.context.scene.convwass_morph",)
    preset_values = tuple(f"settings.{name}" for name in PRESET_PROPERTIES)


def preset_names() -> list[str]:
    """Return the names of all presets."""
    folders = map(Path, bpy.utils.preset_paths(SUBFOLDER))
    files = (path for folder in folders for path in folder.glob("*.py"))
    return sorted(bpy.path.display_name(path.name, title_case=False) for path in files)


def apply_preset(name: str) -> bool:
    """Apply a preset to the current scene; return whether it exists.

    Raises
    ------
    InputError
        The preset is invalid: written by hand, or by another version.
    """
    path = bpy.utils.preset_find(name, SUBFOLDER, display_name=True)
    if not path:
        return False
    try:
        bpy.utils.execfile(path)
    except Exception as error:
        # Presets are Python scripts, which may fail in any way.
        reason = str(error).strip() or type(error).__name__
        raise InputError("The preset {name} cannot be used: {reason}", name=name, reason=reason) from error
    return True


def is_untouched(settings: bpy.types.PropertyGroup) -> bool:
    """Return whether none of the solver settings of a scene has been changed."""
    return not any(settings.is_property_set(name) for name in PRESET_PROPERTIES)


_FOLDER = str(Path(__file__).parent)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory((CONVWASS_OT_add_solver_preset,))


def register() -> None:
    """Register the shipped presets and the operator that saves new ones."""
    _register_classes()
    bpy.utils.register_preset_path(_FOLDER)


def unregister() -> None:
    """Unregister both."""
    bpy.utils.unregister_preset_path(_FOLDER)
    _unregister_classes()
