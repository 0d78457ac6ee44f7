# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: read properties, call one application through the bridge, report."""

from __future__ import annotations

import bpy

from . import bake_morph, edit_inputs, manage_morph, output_morph, play_morph

register, unregister = bpy.utils.register_classes_factory(
    (*bake_morph.classes, *edit_inputs.classes, *manage_morph.classes, *output_morph.classes, *play_morph.classes)
)
