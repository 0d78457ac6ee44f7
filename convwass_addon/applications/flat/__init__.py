# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Morph flat shapes: text, curves, logos, silhouettes and grey images, in two dimensions."""
