# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees whose links are laid by reroutes."""

from __future__ import annotations

import bpy


def with_reroutes(tree: bpy.types.NodeTree) -> None:
    """Lay every link of a tree by a reroute."""
    for start, end in [(link.from_socket, link.to_socket) for link in tree.links]:
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(start, reroute.inputs[0])
        tree.links.new(reroute.outputs[0], end)
