# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees of data-blocks."""

from __future__ import annotations

import bpy


def own_tree(block: bpy.types.Material | bpy.types.World) -> bpy.types.NodeTree:
    """Return the node tree of a data-block, which it gets where it has none."""
    if block.node_tree is None:  # Blender 4.5; later ones come with nodes and warn of this property
        block.use_nodes = True
    return block.node_tree
