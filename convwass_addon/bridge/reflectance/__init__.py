# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert Blender's materials to reflectance lobes, and blended lobes to materials."""
