# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Inputs of morphs: shapes that are read, checked, followed and hidden, and the guides on them."""
