# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later

"""Quick: thin parts may be lost."""

import bpy

settings = bpy.context.scene.convwass_morph

settings.begin_preset()
settings.resolution = 50
