# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: show properties and buttons; nothing is computed or written while drawing."""

from __future__ import annotations

import bpy

from . import armatures, baked, densities, light, morph, morph_guides, progress, recolor, soft_maps

# What comes first is drawn above the others.
_MODULES = (progress, morph, morph_guides, baked, densities, soft_maps, armatures, recolor, light)

register, unregister = bpy.utils.register_classes_factory([cls for module in _MODULES for cls in module.classes])
