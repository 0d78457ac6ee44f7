# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: show properties and buttons; nothing is computed or written while drawing."""

from __future__ import annotations

import bpy

from . import armatures, baked, densities, light, morph, morph_guides, progress, recolor, soft_maps

MODULES = (progress, morph, morph_guides, baked, densities, soft_maps, armatures, recolor, light)
"""In the order in which they are drawn, from the top."""

register, unregister = bpy.utils.register_classes_factory([cls for module in MODULES for cls in module.classes])
