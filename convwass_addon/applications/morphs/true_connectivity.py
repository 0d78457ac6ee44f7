# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Connectivity of shapes, more accurate than on the grid of a morph."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import InputError
from ...geometry.level_sets.connectivity import Connectivity
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.mesh_connectivity import mesh_connectivity
from ...geometry.solids.occupancy import occupancy
from ...geometry.solids.orientation import orient_outward
from ...progress import Control
from .extraction import connectivity_of
from .morph_settings import MorphSettings
from .volumes import Lattice

# Refinement of the grid for solids whose mesh is not reliable, and its maximum number of cells, which takes a second or
# two.
_FINER, _MOST_CELLS = 2, 8_000_000


def true_connectivity(
    shape: TriangleMesh, index: int, lattice: Lattice, settings: MorphSettings, control: Control
) -> Connectivity | None:
    """Determine pieces, handles and bubbles from the mesh or, if the mesh is not reliable, from a finer grid.

    Parameters
    ----------
    shape : TriangleMesh
        Input `index`, in scene units.
    index : int
        Index of the input.
    lattice : Lattice
        The grid of the blends.
    settings : MorphSettings
        Settings for extracting surfaces.
    control : Control
        Stops the work when cancelled.

    Returns
    -------
    Connectivity or None
        None if a finer grid would be too large, or if the shape encloses nothing.
    """
    outward = orient_outward(shape)
    told = mesh_connectivity(outward, control)
    cells = np.multiply(lattice.shape, _FINER)
    if told is not None or cells.prod() > _MOST_CELLS:
        return told
    finer = replace(lattice, shape=tuple(int(count) for count in cells), spacing=lattice.spacing / _FINER)
    try:
        return connectivity_of(occupancy(finer.to_cells(outward, index), finer.shape, control), settings)
    except InputError:
        return None
