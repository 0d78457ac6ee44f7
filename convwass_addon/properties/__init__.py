# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Properties of scenes, objects and operators, with a module for every panel, and the state of the running job."""

from __future__ import annotations

from types import ModuleType


def registered() -> tuple[ModuleType, ...]:
    """Return the modules that register properties; imported here because they import bpy."""
    from . import armatures, densities, light, live, morph_guides, morph_inputs, one_mesh, progress, recolor, soft_maps

    return (progress, morph_inputs, morph_guides, one_mesh, live, densities, soft_maps, armatures, recolor, light)
