# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Orient the faces of a mesh outward, as far as possible."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays.components import component_labels
from ..arrays.equal_shares import at_equal_shares
from ..meshes.edges import EdgeUse, edge_use
from ..meshes.face_neighbors import FaceNeighbors
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import triangle_normals
from ..meshes.welding import place_labels
from .solid_angles import winding_numbers

# Sample points per component, or patch of one, for deciding where it lies.
_PROBES = 9
# How far in front of it they are, relative to its longest side.
_WITHIN = 1e-3
# Patches are large from this fraction of the area of their component on.
_LARGE = 0.02
# They face inward where the winding number in front of them is less than this. It is -1 where they enclose something,
# and -0.5 in front of a flat open piece.
_INVERTED = -0.75


def orient_outward(mesh: TriangleMesh, use: EdgeUse | None = None) -> TriangleMesh:
    """Flip faces so that they enclose the intended solid.

    Components with inconsistent faces are made consistent, with positive volume. Where a consistent component passes
    through itself, so that large parts of it face inward, as an arm that is attached inside out, those are flipped.
    Consistent components keep their orientation (an inward-facing inner shell is a cavity), except inward-facing ones
    that do not lie inside anything: those are flipped. Pieces that meet in a seam, as the front and the sides of solid
    text, are one component, though they share no vertices: alone, the wall of a hole would face inward. Copies of a
    piece in its place meet in no seam.

    Parameters
    ----------
    mesh : TriangleMesh
        Any triangles; boundary and non-manifold edges are ignored.
    use : EdgeUse, optional
        `edge_use(mesh.faces)`, if known.

    Returns
    -------
    TriangleMesh
        The same vertices and triangles, some of them flipped; `mesh` itself if none are.
    """
    use = edge_use(mesh.faces) if use is None else use
    neighbors, pieces = FaceNeighbors.of(use), _pieces(use, len(mesh.faces))
    is_open = np.isin(pieces, pieces[use.face[use.start[use.count == 1]]])
    if is_open.any():
        # Closed components have no seams, even if others touch them.
        places = place_labels(mesh.vertices)[mesh.faces[is_open]]
        seams = FaceNeighbors.of(edge_use(places)).unless_same(places).among(is_open)
        neighbors, pieces = neighbors.and_across(seams), _joined(pieces, seams)
    turn, repaired = _disagreeing_faces(neighbors, pieces)
    outward = _with_turned(mesh, turn)
    volumes = np.bincount(pieces, weights=outward.face_volumes)
    inward = repaired & (volumes < 0)
    for piece in np.flatnonzero((volumes < 0) & ~repaired):
        inward[piece] = not _inside_others(outward, pieces, piece)
    outward = _with_turned(outward, inward[pieces])
    if not repaired.any():
        return outward
    return _with_turned(outward, _turned_in(outward, repaired[pieces], pieces, neighbors))


def _with_turned(mesh: TriangleMesh, turn: NDArray[np.bool_]) -> TriangleMesh:
    """Return a mesh with some of its triangles, (m,), flipped; the mesh itself if there are none."""
    if not turn.any():
        return mesh
    faces = mesh.faces.copy()
    faces[turn] = faces[turn, ::-1]
    return TriangleMesh(mesh.vertices, faces)


def _pieces(use: EdgeUse, count: int) -> NDArray[np.int64]:
    """Return labels of triangles by piece, (count,). Solids that touch in a vertex are different pieces."""
    return component_labels(use.face[np.repeat(use.start, use.count)], use.face, count)


def _joined(pieces: NDArray[np.int64], seams: FaceNeighbors) -> NDArray[np.int64]:
    """Return labels of triangles by piece, (m,), with pieces joined that meet in seams."""
    return component_labels(*pieces[seams.faces], int(pieces.max()) + 1)[pieces]


def _disagreeing_faces(
    neighbors: FaceNeighbors, pieces: NDArray[np.int64]
) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Find faces to flip for consistency, and the components that need it.

    A graph has two nodes per face, "kept" and "flipped", and joins states that are consistent across an edge. If its
    components separate the two states of every face, each of them is a consistent orientation. Otherwise the mesh
    component is one-sided (a Möbius strip) and is left as it is.
    """
    face_count, piece_count = len(pieces), int(pieces.max()) + 1
    (one, other), agree = neighbors.faces, neighbors.agree
    repaired = np.zeros(piece_count, bool)
    repaired[pieces[one[~agree]]] = True
    if not repaired.any():
        return np.zeros(face_count, bool), repaired
    across = np.where(agree, other, other + face_count)
    back = np.where(agree, other + face_count, other)
    rows, columns = np.r_[one, one + face_count], np.r_[across, back]
    labels = component_labels(rows, columns, 2 * face_count)
    kept, turned = labels[:face_count], labels[face_count:]
    # Of two components, take the one that flips fewer faces; the smaller label wins ties.
    votes = np.bincount(labels[:face_count], minlength=labels.max() + 1)
    turn = (kept != turned) & ((votes[turned] > votes[kept]) | ((votes[turned] == votes[kept]) & (turned < kept)))
    return turn & repaired[pieces], repaired


def _turned_in(
    mesh: TriangleMesh, repaired: NDArray[np.bool_], pieces: NDArray[np.int64], neighbors: FaceNeighbors
) -> NDArray[np.bool_]:
    """Return which of the triangles of repaired components face inward, (m,).

    Before the repair, they agreed with each other in large patches.

    Parameters
    ----------
    mesh : TriangleMesh
        With consistent components.
    repaired : (m,) bool
        Triangles of components whose triangles did not agree before.
    pieces : (m,) int64
        Component of every triangle.
    neighbors : FaceNeighbors
        Those of the mesh before the repair.
    """
    patches = neighbors.agreeing().labels(len(pieces))
    large = np.flatnonzero(repaired & _is_large(mesh, patches, pieces))
    inward = np.zeros(len(pieces), bool)
    if not len(large):
        return inward
    for patch in _enclosing_less_than_nothing(mesh, patches, large):
        faces = patches == patch
        component = pieces == pieces[np.argmax(faces)]
        inward[faces] = _winding_in_front(_chosen(mesh, faces), _chosen(mesh, component)) < _INVERTED
    return inward


def _is_large(mesh: TriangleMesh, patches: NDArray[np.int64], pieces: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return which triangles, (m,), belong to patches that have much of the area of their component."""
    own, whole = (np.bincount(labels, weights=mesh.face_areas)[labels] for labels in (patches, pieces))
    return own >= _LARGE * whole


def _enclosing_less_than_nothing(
    mesh: TriangleMesh, patches: NDArray[np.int64], faces: NDArray[np.int64]
) -> NDArray[np.int64]:
    """Return the patches of some triangles, given by their indices, that have a negative volume about their centroids.

    Winding numbers take much longer, and most patches face outward.
    """
    found, labels = np.unique(patches[faces], return_inverse=True)
    corners, areas = mesh.corners[faces], mesh.face_areas[faces]
    points = corners.mean(axis=1)
    centers = np.stack([np.bincount(labels, weights=areas * own) for own in points.T], axis=1)
    centers /= np.bincount(labels, weights=areas)[:, None]
    heights = np.einsum("ij,ij->i", triangle_normals(corners), points - centers[labels])
    return found[np.bincount(labels, weights=areas * heights) < 0.0]


def _inside_others(mesh: TriangleMesh, pieces: NDArray[np.int64], piece: int) -> bool:
    """Return whether most of the space that an inward-facing component encloses is inside the solid of the others."""
    own, others = _chosen(mesh, pieces == piece), _chosen(mesh, pieces != piece)
    low, high = own.bounds
    if not len(others.faces) or (others.bounds[0] > high).any() or (others.bounds[1] < low).any():
        return False
    return _winding_in_front(own, others) > 0.5


def _chosen(mesh: TriangleMesh, faces: NDArray[np.bool_]) -> TriangleMesh:
    return TriangleMesh(mesh.vertices, mesh.faces[faces])


def _winding_in_front(own: TriangleMesh, mesh: TriangleMesh) -> float:
    """Return the median winding number of a mesh about points just in front of the triangles of another."""
    # The two meshes may share the surface.
    return float(np.median(winding_numbers(points_in_front(own, _PROBES, _WITHIN), mesh)))


def points_in_front(mesh: TriangleMesh, count: int, away: float) -> NDArray[np.float64]:
    """Return points in front of the triangles of a mesh, evenly spread over its area.

    Parameters
    ----------
    mesh : TriangleMesh
        At least one triangle.
    count : int
        Number of points.
    away : float
        Their distance from the triangles, relative to the longest side of the mesh.

    Returns
    -------
    (count, 3) float64
    """
    corners = mesh.corners[at_equal_shares(mesh.face_areas, count)]
    return corners.mean(axis=1) + away * mesh.longest_side * triangle_normals(corners)
