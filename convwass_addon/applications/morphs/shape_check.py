# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist should know about a shape before it is morphed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from ...errors import InputError
from ...geometry.edges import edge_use, topology
from ...geometry.mesh import TriangleMesh
from ...geometry.orientation import orient_outward
from ...geometry.welding import welded
from .volumes import Lattice, voxelized

Verdict = Literal["SOUND", "FLIPPED", "HOLES", "NO_VOLUME"]

# Cells along the longest side with which the volume is looked for: what a quick bake has.
_RESOLUTION = 64
_SIGMA = 1.0
# A closed surface around so many of these cells needs no closer look, which takes seconds for millions of triangles.
_CLEAR_CELLS = 1000.0


@dataclass(frozen=True)
class ShapeFindings:
    """What is wrong with a shape; a bake copes with all but a missing volume.

    Attributes
    ----------
    has_volume : bool
        Whether it encloses some.
    open_edges : int
        Edges with one face only, where vertices in one place count as one.
    flipped_faces : int
        Faces that look the wrong way.
    """

    has_volume: bool
    open_edges: int
    flipped_faces: int

    @property
    def worst(self) -> Verdict:
        """What matters most."""
        if not self.has_volume:
            return "NO_VOLUME"
        if self.open_edges:
            return "HOLES"
        return "FLIPPED" if self.flipped_faces else "SOUND"


def check_shape(mesh: TriangleMesh) -> ShapeFindings:
    """Look for what may go wrong with a shape in a morph; takes a fraction of a second.

    Parameters
    ----------
    mesh : TriangleMesh
        In any space; with one triangle at least.
    """
    joined = welded(mesh)
    if not len(joined.faces):
        return ShapeFindings(has_volume=False, open_edges=0, flipped_faces=0)
    use = edge_use(joined.faces)
    outward = orient_outward(joined, use)
    found = topology(outward, use if outward is joined else None)
    return ShapeFindings(
        has_volume=(found.closed and _is_clear(outward)) or _has_volume(mesh),
        open_edges=found.open_edges,
        flipped_faces=int((outward.faces != joined.faces).any(axis=1).sum()),
    )


def _is_clear(outward: TriangleMesh) -> bool:
    cell = float(np.ptp(outward.bounds, axis=0).max()) / _RESOLUTION
    return outward.volume > _CLEAR_CELLS * cell**3


def _has_volume(mesh: TriangleMesh) -> bool:
    if not np.ptp(mesh.bounds, axis=0).max() > 0.0:
        return False
    lattice = Lattice.around([mesh], _RESOLUTION, _SIGMA)
    try:
        voxelized(mesh, "", 0, lattice, thickness=0.0)
    except InputError:
        return False
    return True
