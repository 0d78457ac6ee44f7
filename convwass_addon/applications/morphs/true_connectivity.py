# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How shapes are connected, told more exactly than their cells show it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...errors import InputError
from ...geometry.connectivity import Connectivity
from ...geometry.mesh import TriangleMesh
from ...geometry.mesh_connectivity import mesh_connectivity
from ...geometry.occupancy import occupancy
from ...geometry.orientation import orient_outward
from .extraction import connectivity_of
from .morph_settings import MorphSettings
from .volumes import Lattice

# How much finer a solid is read whose mesh does not tell, and most cells of that: as many take a second or two.
_FINER, _MOST_CELLS = 2, 8_000_000


def true_connectivity(
    shape: TriangleMesh, index: int, lattice: Lattice, settings: MorphSettings
) -> Connectivity | None:
    """Tell pieces, handles and bubbles from the mesh, or where that does not tell from a finer lattice.

    Parameters
    ----------
    shape : TriangleMesh
        Input `index`, in scene units.
    index : int
        Which input.
    lattice : Lattice
        That of the blends.
    settings : MorphSettings
        How surfaces are read.

    Returns
    -------
    Connectivity or None
        None where the lattice is as fine as can be afforded, or the shape encloses nothing.
    """
    outward = orient_outward(shape)
    told = mesh_connectivity(outward)
    cells = np.multiply(lattice.shape, _FINER)
    if told is not None or cells.prod() > _MOST_CELLS:
        return told
    finer = replace(lattice, shape=tuple(int(count) for count in cells), spacing=lattice.spacing / _FINER)
    try:
        return connectivity_of(occupancy(finer.to_cells(outward, index), finer.shape), settings)
    except InputError:
        return None
