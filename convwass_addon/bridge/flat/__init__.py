# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs: text, curves, flat meshes, images and drawings as outlines, and frames as curve objects or meshes."""
