# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Optimal transport on arrays: the paper, without meshes, files or Blender."""

from .barycenter import Barycenter, barycenter
from .bregman import KernelTooNarrowError
from .grid import Grid

__all__ = ["Barycenter", "Grid", "KernelTooNarrowError", "barycenter"]
