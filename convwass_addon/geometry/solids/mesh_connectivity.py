# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Topology of the solid inside a mesh, from the mesh alone, since a grid may not resolve touching fingers."""

from __future__ import annotations

import numpy as np

from ...progress import UNINTERRUPTED, Control
from ..level_sets.connectivity import Connectivity
from ..meshes.edges import face_components, topology
from ..meshes.mesh import TriangleMesh
from ..meshes.welding import welded
from .coarse_cells import CoarseCells
from .winding import lattice_winding

# A component may overlap itself in this fraction of its volume, as where skin folds in an armpit. A larger overlap may
# be an intended connection, as of the ends of a bent tube.
_FOLDED = 5e-3


def mesh_connectivity(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> Connectivity | None:
    """Count components, handles and bubbles of the solid bounded by a mesh, by Euler characteristics.

    A closed orientable surface with V vertices and F triangles has the genus 1 - (V - F / 2) / 2.

    Parameters
    ----------
    mesh : TriangleMesh
        Oriented outward (:func:`.orientation.orient_outward`); an inward component is a bubble.
    control : Control
        Stops the work when cancelled.

    Returns
    -------
    Connectivity or None
        None if the surface does not determine them: it is open, not a manifold, or its components overlap.
    """
    whole = welded(mesh)
    if not len(whole.faces) or not topology(whole).closed:
        return None
    of_faces = face_components(whole.faces)
    of_vertices = np.empty(len(whole.vertices), np.int64)
    of_vertices[whole.faces] = of_faces[:, None]
    # Twice the Euler number; odd, or more than that of a sphere, where a vertex joins several fans of triangles.
    doubled = 2 * np.bincount(of_vertices) - np.bincount(of_faces)
    if (doubled % 4 != 0).any() or (doubled > 4).any():
        return None
    bubbles = int((np.bincount(of_faces, weights=whole.face_volumes) < 0.0).sum())
    overlap = _overlapping_share(whole, control)
    if overlap > (_FOLDED if len(doubled) == 1 else 0.0):
        return None
    return Connectivity(len(doubled) - bubbles, int((4 - doubled).sum()) // 4, bubbles)


def _overlapping_share(mesh: TriangleMesh, control: Control) -> float:
    """Return the fraction of filled cells of a coarse grid with a winding number above one."""
    cells = CoarseCells.around(mesh)
    winding = lattice_winding(cells.corners, cells.shape, control)
    return float((winding > 1.5).sum() / max((winding > 0.5).sum(), 1))
