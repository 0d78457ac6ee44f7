# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: read properties, call one application through the bridge, report."""

from __future__ import annotations

import bpy

from . import (
    background,
    bake_morph,
    density_manage,
    density_measure,
    density_paint,
    density_stops,
    density_travel,
    edit_inputs,
    manage_morph,
    output_morph,
    play_morph,
)

_MODULES = (
    background,
    bake_morph,
    edit_inputs,
    manage_morph,
    output_morph,
    play_morph,
    density_paint,
    density_measure,
    density_stops,
    density_travel,
    density_manage,
)

register, unregister = bpy.utils.register_classes_factory([cls for module in _MODULES for cls in module.classes])
