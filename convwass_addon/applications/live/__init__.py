# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Live morphs: blends at any weights at once, mixed from the level fields of a lattice that is filled meanwhile."""
