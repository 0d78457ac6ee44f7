# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Palettes of images, transferred by transport: to images, lookup tables and grades."""
