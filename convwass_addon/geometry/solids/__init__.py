# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The solids that meshes bound: voxels, inside and outside, topology, orientation and thickness."""
