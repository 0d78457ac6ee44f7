# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Palettes of images: carried from one to another by transport, as pictures, tables and grades."""
