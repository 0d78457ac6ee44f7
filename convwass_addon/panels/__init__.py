# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Panels: show properties and buttons; nothing is computed or written while drawing."""

from __future__ import annotations

import bpy

from . import armatures, baked, densities, morph, soft_maps

register, unregister = bpy.utils.register_classes_factory(
    (*morph.classes, *baked.classes, *densities.classes, *soft_maps.classes, *armatures.classes)
)
