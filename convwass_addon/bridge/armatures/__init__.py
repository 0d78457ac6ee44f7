# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Armatures, and meshes of edges, as graphs of joints and back."""
