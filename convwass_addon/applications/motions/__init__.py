# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions: move shapes towards each other, so that only the remaining difference is transported."""
