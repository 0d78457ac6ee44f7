# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Mixtures of baked blends by Geometry Nodes, from signed distances that are stored with them."""
