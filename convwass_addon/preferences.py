# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Preferences of the add-on: frame caches, number of threads, default preset."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import bpy
from bpy.props import IntProperty, StringProperty

from . import extension_id
from .solver_presets import preset_names

STANDARD = "Standard"


def _matching_presets(_self: bpy.types.AddonPreferences, _context: bpy.types.Context, text: str) -> list[str]:
    return [name for name in preset_names() if text.lower() in name.lower()]


class CONVWASS_AP_preferences(bpy.types.AddonPreferences):
    """Preferences of the add-on."""

    bl_idname = extension_id()

    cache_folder: StringProperty(
        name="Cache Folder",
        description="Keep finished frames in this folder permanently, with the data needed to share them between "
        "machines and to compute fractional frames; if empty, frames of recent bakes are kept in a folder "
        "of the extension. Used for all files, so it must be an absolute path",
        subtype="DIR_PATH",
    )
    spare_megabytes: IntProperty(
        name="Kept Frames",
        description="Megabytes of frames kept without a cache folder, so that an interrupted bake can continue and a "
        "repeated one is fast; 0 keeps none",
        default=1000,
        min=0,
        soft_max=20_000,
    )
    threads: IntProperty(
        name="Threads",
        description="Number of frames computed at the same time; 0 for one per processor, as memory allows",
        default=0,
        min=0,
        max=1024,
    )
    default_preset: StringProperty(
        name="Default Preset",
        description="Solver preset for a scene when the first shapes are added to its input list",
        default=STANDARD,
        search=_matching_presets,
    )

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "cache_folder")
        row = layout.row()
        row.active = not self.cache_folder
        row.prop(self, "spare_megabytes")
        layout.prop(self, "threads")
        layout.prop(self, "default_preset")


@dataclass(frozen=True)
class Preferences:
    """The values of the preferences.

    Attributes
    ----------
    cache_folder : Path or None
        Permanent frame cache; relative if it was given relative to the open file.
    spare_folder : Path or None
        Cache of limited size otherwise; None if disabled or not available.
    spare_bytes : int
        Size limit of that cache.
    workers : int or None
        Number of threads; None for one per processor.
    default_preset : str
        Name of a solver preset; empty for none.
    """

    cache_folder: Path | None = None
    spare_folder: Path | None = None
    spare_bytes: int = 0
    workers: int | None = None
    default_preset: str = STANDARD


def preferences(context: bpy.types.Context | None = None) -> Preferences:
    """Return the preferences, or the defaults if the package is not enabled as an add-on."""
    addon = (context or bpy.context).preferences.addons.get(extension_id())
    if addon is None or addon.preferences is None:
        return Preferences()
    own = addon.preferences
    folder = Path(own.cache_folder.removeprefix("//")) if own.cache_folder else None
    spare = _own_folder() if own.spare_megabytes and folder is None else None
    return Preferences(folder, spare, own.spare_megabytes * 1_000_000, own.threads or None, own.default_preset)


def _own_folder() -> Path | None:
    """Return the extension's own folder; only installed extensions have one."""
    try:
        return Path(bpy.utils.extension_path_user(extension_id(), path="frames"))
    except ValueError:
        return None


register, unregister = bpy.utils.register_classes_factory((CONVWASS_AP_preferences,))
