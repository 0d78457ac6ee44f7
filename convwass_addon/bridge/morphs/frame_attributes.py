# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of what the meshes of frames carry at their points."""

COLOR, VELOCITY = "Color", "velocity"
"""Point attributes of frames: the mixed color, and scene units per second, which is what renderers expect."""

LOOK, SOURCE_WEIGHT, SOURCE_MATERIAL = "look_{}", "source_weight_{}", "source_material_{}"
"""Point attributes of frames for every input, counted from 1."""

CUSTOM_NORMAL = "custom_normal"
"""Blender's own attribute for normals of points or corners."""
