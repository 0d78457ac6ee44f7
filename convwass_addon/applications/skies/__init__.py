# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation between skies: suns move, their glow is transported, the rest fades."""
