# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of outlines: match the curves around flat areas, and move the areas as these do."""
