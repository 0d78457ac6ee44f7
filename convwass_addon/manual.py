# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pages of the documentation for Blender's *Online Manual*, in the context menu of every button and setting.

The zip files contain the pages as HTML. A checkout has only their Markdown files, which are opened instead.
"""

from __future__ import annotations

from pathlib import Path

import bpy

PAGES = {
    "ops.convwass.": (
        ("*live*", "live"),
        ("*guide*", "motions"),
        ("*densit*", "densities"),
        ("measure_*", "densities"),
        ("distance_*", "densities"),
        ("*map*", "soft_maps"),
        ("show_distribution", "soft_maps"),
        ("fit_armature", "armatures"),
        ("*joint*", "armatures"),
        ("*pins", "armatures"),
        ("recolor_*", "palettes"),
        ("write_cube", "palettes"),
        ("build_grade_nodes", "palettes"),
        ("blend_materials", "light"),
        ("blend_skies", "light"),
        ("import_lobes", "light"),
        ("export_*", "exports"),
        ("*", "morphs"),
    ),
    "types.convwass_pg_": (
        ("*live*", "live"),
        ("*guide*", "motions"),
        ("*densit*", "densities"),
        ("*map*", "soft_maps"),
        ("armature*", "armatures"),
        ("recolor*", "palettes"),
        ("reflectance*", "light"),
        ("sky*", "light"),
        ("*", "morphs"),
    ),
}
"""Names of pages for the operators and property groups that match a pattern; the first match counts."""

_PACKAGE = Path(__file__).resolve().parent


def manual_map() -> tuple[str, list[tuple[str, str]]]:
    """Return the address of the pages, and pairs of a pattern of identifiers in lower case and a file name."""
    folder, suffix = _PACKAGE / "pages", ".html"
    if not folder.is_dir():
        folder, suffix = _PACKAGE.parent / "docs", ".md"
    pairs = [(f"bpy.{kind}{pattern}", page + suffix) for kind, pages in PAGES.items() for pattern, page in pages]
    return f"{folder.as_uri()}/", pairs


def register() -> None:
    """Let Blender look up the pages."""
    bpy.utils.register_manual_map(manual_map)


def unregister() -> None:
    """Undo `register`."""
    bpy.utils.unregister_manual_map(manual_map)
