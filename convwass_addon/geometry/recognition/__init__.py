# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes of special form: extrusions, solids of revolution and tubes."""
