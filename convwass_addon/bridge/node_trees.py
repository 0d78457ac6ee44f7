# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of data-blocks."""

from __future__ import annotations

import bpy


def own_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Return the node tree of a data-block; created if missing."""
    if block.node_tree is None:  # Blender 4.5; later versions always use nodes and warn about this property
        block.use_nodes = True
    return block.node_tree
