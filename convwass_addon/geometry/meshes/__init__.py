# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangle meshes: measures, neighbors, nearest points, Laplacians, symmetry."""
