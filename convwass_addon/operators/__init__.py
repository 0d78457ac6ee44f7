# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Operators: read properties, call one application through the bridge, report."""

from __future__ import annotations

import bpy

from . import (
    armature_fit,
    armature_pins,
    armature_place,
    attached_parts,
    background,
    density_manage,
    density_measure,
    density_paint,
    density_stops,
    density_travel,
    live_morph,
    morph_asset,
    morph_bake,
    morph_export,
    morph_guides,
    morph_inputs,
    morph_manage,
    morph_output,
    morph_play,
    picking,
    recolor_attribute,
    recolor_clip,
    recolor_grade,
    recolor_image,
    reflectance_blend,
    reflectance_import,
    sky_blend,
    soft_map_compute,
    soft_map_pairs,
    soft_map_transfer,
    soft_map_view,
    texture_bake,
)

_MODULES = (
    background,
    morph_bake,
    morph_guides,
    morph_inputs,
    morph_manage,
    morph_asset,
    morph_output,
    morph_export,
    attached_parts,
    texture_bake,
    morph_play,
    live_morph,
    density_paint,
    density_measure,
    density_stops,
    density_travel,
    density_manage,
    soft_map_pairs,
    soft_map_compute,
    soft_map_transfer,
    soft_map_view,
    armature_pins,
    armature_place,
    armature_fit,
    recolor_image,
    recolor_clip,
    recolor_grade,
    recolor_attribute,
    reflectance_blend,
    reflectance_import,
    sky_blend,
)

register, _unregister_classes = bpy.utils.register_classes_factory(
    [cls for module in _MODULES for cls in module.classes]
)


def unregister() -> None:
    """Unregister the operators; running work is cancelled first, and its partial results are removed."""
    try:
        picking.stop_waiting(bpy.context)
        live_morph.stop_live(bpy.context)
        background.stop_running(bpy.context)
    finally:
        _unregister_classes()
