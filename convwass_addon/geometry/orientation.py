# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make the faces of a mesh look outward, as far as the mesh allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from .edges import EdgeUse, edge_use, face_components
from .mesh import TriangleMesh

# Sample points per piece when asking whether it lies inside the others.
_PROBES = 9


def orient_outward(mesh: TriangleMesh, use: EdgeUse | None = None) -> TriangleMesh:
    """Turn faces over so that the solid is where it is meant to be.

    Pieces whose neighbouring faces disagree are made consistent and positive in volume. Consistent pieces keep their
    direction (an inner shell that faces inward is a cavity), except those that face inward without lying inside
    anything: those are turned over.

    Parameters
    ----------
    mesh : TriangleMesh
        Any triangles; open and non-manifold edges are left out of the comparison.
    use : EdgeUse, optional
        That of its faces, where it is known.

    Returns
    -------
    TriangleMesh
        The same vertices and triangles, some of them turned over; `mesh` itself where none are.
    """
    use = edge_use(mesh.faces) if use is None else use
    pieces = face_components(mesh.faces)
    turn, repaired = _disagreeing_faces(len(mesh.faces), use, pieces)
    outward = mesh
    if turn.any():
        faces = mesh.faces.copy()
        faces[turn] = faces[turn, ::-1]
        outward = TriangleMesh(mesh.vertices, faces)
    volumes = np.bincount(pieces, weights=outward.face_volumes)
    inward = repaired & (volumes < 0)
    for piece in np.flatnonzero((volumes < 0) & ~repaired):
        inward[piece] = not _inside_others(outward, pieces, piece)
    if not inward.any():
        return outward
    turn = inward[pieces]
    faces = outward.faces.copy()
    faces[turn] = faces[turn, ::-1]
    return TriangleMesh(mesh.vertices, faces)


def _disagreeing_faces(
    face_count: int, use: EdgeUse, pieces: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Find faces to turn over so that neighbours agree, and the pieces in which that was needed.

    A graph with two nodes per face, "as it is" and "turned over", joins the states that agree across an edge. Where
    its components part the two states of every face, either component is a consistent orientation; where they do not,
    the piece is one-sided (a Möbius strip) and stays as it is.
    """
    piece_count = int(pieces.max()) + 1
    paired = use.start[use.count == 2]
    one, other = use.face[paired], use.face[paired + 1]
    agree = use.forward[paired] != use.forward[paired + 1]
    repaired = np.zeros(piece_count, bool)
    repaired[pieces[one[~agree]]] = True
    if not repaired.any():
        return np.zeros(face_count, bool), repaired
    across = np.where(agree, other, other + face_count)
    back = np.where(agree, other + face_count, other)
    rows, columns = np.r_[one, one + face_count], np.r_[across, back]
    graph = coo_array((np.ones(len(rows), np.int8), (rows, columns)), shape=(2 * face_count, 2 * face_count))
    labels = connected_components(graph, directed=False)[1]
    kept, turned = labels[:face_count], labels[face_count:]
    # Of a pair of components keep the one in which fewer faces are turned; ties go to the smaller label.
    votes = np.bincount(labels[:face_count], minlength=labels.max() + 1)
    turn = (kept != turned) & ((votes[turned] > votes[kept]) | ((votes[turned] == votes[kept]) & (turned < kept)))
    return turn & repaired[pieces], repaired


def _inside_others(mesh: TriangleMesh, pieces: NDArray[np.int64], piece: int) -> bool:
    """Tell whether most of a piece lies where the other pieces make a solid."""
    own = np.unique(mesh.faces[pieces == piece])
    others = mesh.corners[pieces != piece]
    low, high = mesh.vertices[own].min(axis=0), mesh.vertices[own].max(axis=0)
    if not len(others) or (others.min(axis=(0, 1)) > high).any() or (others.max(axis=(0, 1)) < low).any():
        return False
    probes = mesh.vertices[own[np.linspace(0, len(own) - 1, _PROBES).astype(int)]]
    return float(np.median([winding_number(others, probe) for probe in probes])) > 0.5


def winding_number(corners: NDArray[np.float64], point: NDArray[np.float64]) -> float:
    """Generalized winding number of triangles `corners`, (m, 3, 3), about one point.

    The sum of signed solid angles over 4 pi (Van Oosterom and Strackee 1983; Jacobson et al. 2013).
    """
    a, b, c = np.moveaxis(corners - point, 1, 0)
    la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
    numerator = np.einsum("ij,ij->i", a, np.cross(b, c))
    dots = np.einsum("ij,ij->i", a, b) * lc + np.einsum("ij,ij->i", b, c) * la + np.einsum("ij,ij->i", c, a) * lb
    return float(np.arctan2(numerator, la * lb * lc + dots).sum() / (2.0 * np.pi))
