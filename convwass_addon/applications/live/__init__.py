# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blends at any weights, at once: mixed from the level fields of a lattice of blends, which is filled meanwhile."""
