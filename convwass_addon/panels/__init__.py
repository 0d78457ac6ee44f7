# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: show properties and buttons; nothing is computed or written while drawing."""

from __future__ import annotations

import bpy

from . import (
    armatures,
    baked,
    densities,
    light,
    live,
    menus,
    morph,
    morph_guides,
    one_mesh,
    progress,
    recolor,
    soft_maps,
)

MODULES = (progress, morph, morph_guides, baked, one_mesh, live, densities, soft_maps, armatures, recolor, light)
"""In drawing order, from the top."""

_register_classes, _unregister_classes = bpy.utils.register_classes_factory(
    [cls for module in MODULES for cls in module.classes]
)


def register() -> None:
    """Add the panels, and the entries of Blender's menus."""
    _register_classes()
    menus.register()


def unregister() -> None:
    """Remove both."""
    menus.unregister()
    _unregister_classes()
