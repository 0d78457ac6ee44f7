# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of point attributes of frames."""

COLOR, VELOCITY = "Color", "velocity"
"""The mixed color, and the velocity in scene units per second, as renderers expect."""

LOOK, SOURCE_WEIGHT, SOURCE_MATERIAL = "look_{}", "source_weight_{}", "source_material_{}"
"""For every input, numbered from 1."""

CUSTOM_NORMAL = "custom_normal"
"""Blender's attribute for normals of points or corners."""
