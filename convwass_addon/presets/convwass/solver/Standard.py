# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later

"""What a new scene has."""

import bpy

settings = bpy.context.scene.convwass_morph

settings.begin_preset()
