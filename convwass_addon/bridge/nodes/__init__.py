# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of materials and Geometry Nodes, whatever they compute."""
