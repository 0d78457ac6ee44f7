# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Deformations of surfaces: registration, elasticity, interpolated rotations, removal of folds."""
