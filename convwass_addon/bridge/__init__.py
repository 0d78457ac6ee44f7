# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The only room where Blender's data becomes arrays and arrays become Blender's data."""
