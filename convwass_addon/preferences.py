# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The add-on's preferences: where caches go, how many threads compute, and which preset new scenes begin with."""

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
        description="Keep finished frames here for good, with what is needed to share them between machines and to "
        "make frames between them; empty keeps those of the last bakes in a folder of the extension. It is one for "
        "all files, so give a whole path",
        subtype="DIR_PATH",
    )
    spare_megabytes: IntProperty(
        name="Kept Frames",
        description="Megabytes of frames that are kept without a cache folder, so that a bake goes on where Blender "
        "was closed or another file was opened, and one that is repeated is quick; 0 keeps none",
        default=1000,
        min=0,
        soft_max=20_000,
    )
    threads: IntProperty(
        name="Threads",
        description="Frames that are computed at the same time; 0 takes one per processor, as far as memory allows",
        default=0,
        min=0,
        max=1024,
    )
    default_preset: StringProperty(
        name="Default Preset",
        description="Solver preset that a scene begins with when the first shapes are put on its list of inputs",
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
    """What the user prefers.

    Attributes
    ----------
    cache_folder : Path or None
        Where finished frames are kept for good; not absolute where it was given from the open file on.
    spare_folder : Path or None
        Where they are kept otherwise, up to a size; None where none are to be, or where there is no such place.
    spare_bytes : int
        That size.
    workers : int or None
        Threads that compute; None for as many as there are processors.
    default_preset : str
        Name of a solver preset; empty for none.
    """

    cache_folder: Path | None = None
    spare_folder: Path | None = None
    spare_bytes: int = 0
    workers: int | None = None
    default_preset: str = STANDARD


def preferences(context: bpy.types.Context | None = None) -> Preferences:
    """Return the preferences; the defaults where the package runs without being enabled as an add-on."""
    addon = (context or bpy.context).preferences.addons.get(extension_id())
    if addon is None or addon.preferences is None:
        return Preferences()
    own = addon.preferences
    folder = Path(own.cache_folder.removeprefix("//")) if own.cache_folder else None
    spare = _own_folder() if own.spare_megabytes and folder is None else None
    return Preferences(folder, spare, own.spare_megabytes * 1_000_000, own.threads or None, own.default_preset)


def _own_folder() -> Path | None:
    """Return where the extension may write; only what was installed as an extension has such a folder."""
    try:
        return Path(bpy.utils.extension_path_user(extension_id(), path="frames"))
    except ValueError:
        return None


register, unregister = bpy.utils.register_classes_factory((CONVWASS_AP_preferences,))
