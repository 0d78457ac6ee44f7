# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names of point attributes of frames."""

COLOR, VELOCITY = "Color", "velocity"
"""The mixed color, and the velocity in scene units per second, as renderers expect."""

LOOK, SOURCE_WEIGHT, SOURCE_MATERIAL = "look_{}", "source_weight_{}", "source_material_{}"
"""For every input, numbered from 1."""

CARRIED_UV, CARRIED = "uv_{}_{}", "carried_{}_{}"
"""UV maps of corners, and other attributes of points, that materials of an input read: its number and their name."""

REST_POSITION, REST_NORMAL, GENERATED = "rest_position_{}", "rest_normal_{}", "generated_{}"
"""For every input: the place on it, the normal there, and the place in its bounds from 0 to 1, in its own space."""

LOOKS = "looks"
"""1 where a mesh has all attributes that the materials of the inputs read."""

CUSTOM_NORMAL = "custom_normal"
"""Blender's attribute for normals of points or corners."""
