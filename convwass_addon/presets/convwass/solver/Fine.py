# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later

"""For the final bake: takes about four times as long."""

import bpy

settings = bpy.context.scene.convwass_morph

settings.begin_preset()
settings.resolution = 160
