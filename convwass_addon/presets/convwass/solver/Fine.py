# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later

"""For the final bake: takes about ten times as long."""

import bpy

settings = bpy.context.scene.convwass_morph

settings.resolution = 128
settings.use_custom_blur = False
settings.blur = 1.5
settings.use_custom_sharpness = False
settings.sharpness = 0.75
settings.locality = 0.0
settings.entropy_limit = "OFF"
settings.entropy_bound = -2.0
settings.level = "volume"
settings.thin_parts = True
settings.mend = True
