# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Linear algebra: rotations, means of linear maps, products, and sparse systems."""
