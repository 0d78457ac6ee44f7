# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between the surfaces of two shapes, and registrations of their meshes to each other."""
