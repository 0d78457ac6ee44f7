# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""OpenVDB's Python module, which Blender brings along from 4.5 on."""

from __future__ import annotations

from types import ModuleType

import bpy


def openvdb_module() -> ModuleType | None:
    """Return OpenVDB for Python; None in a Blender that was built without it."""
    if hasattr(bpy.utils, "expose_bundled_modules"):
        bpy.utils.expose_bundled_modules()
    try:
        import openvdb
    except ImportError:
        return None
    return openvdb
