# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check before work on a surface starts that it fits in memory."""

from __future__ import annotations

from ...errors import ResourceError
from ...geometry.meshes.mesh import TriangleMesh
from ...transport import Surface
from .. import memory

# Bytes per vertex at the peak of building a surface, measured with cholespy on spheres of 10 000 to 164 000 vertices.
_BUILD_BYTES = 3500
# Bytes per vertex: of a frame, while it is stored and when it is passed on; of the solver and the coarser meshes at
# their peak, slightly above the 3800 of a whole run at 500 000 vertices (docs/performance, "Meshes", memory); and of
# every edge of a graph, whose scalings are solved together, with copies.
_FRAME_BYTES = 16
_WORK_BYTES = 4000
_EDGE_BYTES = 140


def check_surface_memory(mesh: TriangleMesh) -> None:
    """Raise if the kernel of a mesh needs more memory than is free.

    Raises
    ------
    ResourceError
        The message states the needed and the free memory.
    """
    vertices = len(mesh.vertices)
    lacking = _shortage(_BUILD_BYTES * vertices)
    if lacking:
        raise ResourceError(
            "A mesh of {vertices} vertices needs about {needed:.1f} GB of memory and {free:.1f} GB are free. "
            "Decimate it.",
            vertices=vertices,
            **lacking,
        )


def check_frames_memory(surface: Surface, frames: int, edges: int = 0) -> None:
    """Raise if this many densities on a surface, on a graph with this many edges, need more memory than is free.

    Raises
    ------
    ResourceError
        The message states the needed and the free memory.
    """
    vertices = surface.shape[0]
    lacking = _shortage(vertices * (_FRAME_BYTES * frames + _WORK_BYTES + _EDGE_BYTES * edges))
    if lacking:
        raise ResourceError(
            "{frames} frames on {vertices} vertices need about {needed:.1f} GB of memory and {free:.1f} GB are free. "
            "Take fewer steps, or decimate the mesh.",
            vertices=vertices,
            frames=frames,
            **lacking,
        )


def _shortage(needed: int) -> dict[str, float]:
    """Return the needed and the free memory in GB if there is too little, otherwise nothing."""
    free = memory.available_memory()
    return {"needed": needed / 1e9, "free": free / 1e9} if free is not None and needed > free else {}
