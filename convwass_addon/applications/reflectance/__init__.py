# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Reflectance of materials: lobes as distributions on the hemisphere, and interpolation between materials."""
