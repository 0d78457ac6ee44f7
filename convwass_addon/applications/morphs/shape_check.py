# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Find problems of a shape before it is morphed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ...errors import InputError
from ...geometry.meshes.edges import edge_use, topology
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.welding import welded
from ...geometry.solids.orientation import orient_outward
from ...geometry.solids.plates import Plates
from ...progress import UNINTERRUPTED, Control
from .volumes import Lattice, voxelized

Verdict = Literal["SOUND", "FLIPPED", "HOLES", "NO_VOLUME"]

# Cells along the longest side of the grid on which the volume is checked, as in a quick bake.
_RESOLUTION = 64
_SIGMA = 1.0
# A closed surface around this many of these cells has volume; the exact check takes seconds for millions of triangles.
_CLEAR_CELLS = 1000.0


@dataclass(frozen=True)
class ShapeFindings:
    """Problems of a shape; only a missing volume prevents a bake.

    Attributes
    ----------
    has_volume : bool
        Whether it encloses a volume.
    open_edges : int
        Edges with only one face, after welding vertices at the same position; without those of sheets beside solids,
        which become plates.
    flipped_faces : int
        Faces with inward normals.
    """

    has_volume: bool
    open_edges: int
    flipped_faces: int

    @property
    def worst(self) -> Verdict:
        """The most serious problem."""
        if not self.has_volume:
            return "NO_VOLUME"
        if self.open_edges:
            return "HOLES"
        return "FLIPPED" if self.flipped_faces else "SOUND"


def check_shape(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> ShapeFindings:
    """Find problems that a shape may cause in a morph; takes some seconds for a million triangles.

    Parameters
    ----------
    mesh : TriangleMesh
        In any space; at least one triangle.
    control : Control
        Stops the work.
    """
    joined = welded(mesh)
    if not len(joined.faces):
        return ShapeFindings(has_volume=False, open_edges=0, flipped_faces=0)
    control.check()
    use = edge_use(joined.faces)
    outward = orient_outward(joined, use)
    control.check()
    found = topology(outward, use if outward is joined else None)
    plates = Plates.of_outward(outward) if found.open_edges else None
    open_edges = (
        found.open_edges if plates is None else topology(TriangleMesh(joined.vertices, plates.faces)).open_edges
    )
    return ShapeFindings(
        has_volume=(found.closed and _is_clear(outward)) or _has_volume(mesh, control),
        open_edges=open_edges,
        flipped_faces=int((outward.faces != joined.faces).any(axis=1).sum()),
    )


def _is_clear(outward: TriangleMesh) -> bool:
    cell = outward.longest_side / _RESOLUTION
    return outward.volume > _CLEAR_CELLS * cell**3


def _has_volume(mesh: TriangleMesh, control: Control) -> bool:
    if not mesh.longest_side > 0.0:
        return False
    lattice = Lattice.around([mesh], _RESOLUTION, _SIGMA)
    try:
        voxelized(mesh, "", 0, lattice, thickness=0.0, control=control)
    except InputError:
        return False
    return True
