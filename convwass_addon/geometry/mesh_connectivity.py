# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How the solid inside a mesh is connected, from the mesh alone: no grid is too coarse to part fingers that touch."""

from __future__ import annotations

import numpy as np

from ..progress import UNINTERRUPTED, Control
from .connectivity import Connectivity
from .edges import edge_use, face_components, topology
from .mesh import TriangleMesh
from .welding import welded
from .winding import lattice_winding

# Cells along the longest side of the lattice on which overlaps are looked for, and free ones around it.
_CELLS, _MARGIN = 64, 2
# A component may overlap itself in this share of its volume, as where skin folds in an armpit. Beyond, what overlaps
# may be meant to be joined, as the ends of a bent tube.
_FOLDED = 5e-3


def mesh_connectivity(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> Connectivity | None:
    """Count pieces, handles and bubbles of the solid that a mesh bounds, by the Euler number of every component.

    A closed orientable surface with V vertices and F triangles has the genus 1 - (V - F / 2) / 2.

    Parameters
    ----------
    mesh : TriangleMesh
        Facing outward (:func:`.orientation.orient_outward`); a component that faces inward is a bubble.
    control : Control
        Ends the work when cancelled.

    Returns
    -------
    Connectivity or None
        None where the surface does not tell: it is open, not a manifold, or its components overlap each other.
    """
    whole = welded(mesh)
    if not len(whole.faces) or not topology(whole, edge_use(whole.faces)).closed:
        return None
    of_faces = face_components(whole.faces)
    of_vertices = np.empty(len(whole.vertices), np.int64)
    of_vertices[whole.faces] = of_faces[:, None]
    # Twice the Euler number; odd or more than that of a sphere where a vertex joins several fans of triangles.
    doubled = 2 * np.bincount(of_vertices) - np.bincount(of_faces)
    if (doubled % 4 != 0).any() or (doubled > 4).any():
        return None
    bubbles = int((np.bincount(of_faces, weights=whole.face_volumes) < 0.0).sum())
    overlap = _overlapping_share(whole, control)
    if overlap > (_FOLDED if len(doubled) == 1 else 0.0):
        return None
    return Connectivity(len(doubled) - bubbles, int((4 - doubled).sum()) // 4, bubbles)


def _overlapping_share(mesh: TriangleMesh, control: Control) -> float:
    """Return the share of the filled cells of a coarse lattice around which the surface winds more than once."""
    extent = np.ptp(mesh.bounds, axis=0)
    spacing = float(extent.max()) / _CELLS
    cells = np.ceil(extent / spacing).astype(int) + 2 * _MARGIN
    origin = mesh.bounds.mean(axis=0) - cells * spacing / 2
    winding = lattice_winding((mesh.corners - origin) / spacing, tuple(int(count) for count in cells), control)
    return float((winding > 1.5).sum() / max((winding > 0.5).sum(), 1))
