# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangulated limbs that move with the body of a flat shape, and retract into it along themselves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.meshes.edges import proper_part
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.plane.closed_curves import ClosedCurve, boundary_of
from ...geometry.plane.outline_limbs import OutlineLimb
from ...geometry.remeshing.planar_mesh import planar_mesh, without_bridges

# Vertices this close to a cut, or to each other, are on it, or the same; relative to the length of the cut.
_SAME = 1e-6


@dataclass(frozen=True)
class AttachedLimb:
    """The vertices of a limb, attached to those of a body on the cut between both.

    Attributes
    ----------
    root : (r,) int64
        Vertices of the body on the cut, from its first end to its last one.
    along : (r,) float64
        Their places on the cut at rest, from 0 to 1.
    coordinates : (n, 2) float64
        Of the vertices of the limb, as :meth:`.OutlineLimb.coordinates` gives them.
    reaches : (n,) float64
        Distances of the end of the limb along the axis, at the places of the vertices.
    axis : complex
        The axis of the limb over the direction from the first end of the cut to the last one.
    """

    root: NDArray[np.int64]
    along: NDArray[np.float64]
    coordinates: NDArray[np.float64]
    reaches: NDArray[np.float64]
    axis: complex

    def moved(self, body: NDArray[np.float64], left: float, scale: float) -> NDArray[np.float64]:
        """Return the vertices of the limb, (n, 3).

        The limb turns and widens as the line between the ends of the cut does, and slides back along its axis, onto the
        curve that the cut has become. What is beside the cut retracts towards it, too.

        Parameters
        ----------
        body : (m, 3)
            Vertices of the moved body, in the plane z = 0.
        left : float
            Share of its reach by which the limb stands out.
        scale : float
            Size of the body over that at rest.
        """
        x, y = body[self.root, :2].T
        places, distances = self.coordinates.T
        reached = np.maximum(distances - (1.0 - left) * self.reaches, left * np.minimum(distances, 0.0))
        on_cut = np.clip(places, 0.0, 1.0)
        across = complex(x[-1] - x[0], y[-1] - y[0])
        found = np.interp(on_cut, self.along, x) + 1j * np.interp(on_cut, self.along, y)
        direction = across / abs(across) if across else 0.0
        found = found + left * (places - on_cut) * across + scale * reached * self.axis * direction
        return np.column_stack([found.real, found.imag, np.zeros(len(found))])


def with_limb(
    body: TriangleMesh, limb: OutlineLimb, edge: float, marks: NDArray[np.float64]
) -> tuple[TriangleMesh, AttachedLimb]:
    """Return a triangulated body together with a limb that was cut from it.

    Parameters
    ----------
    body : TriangleMesh
        In the plane z = 0, facing up, with vertices at both ends of the cut. Its vertices come first in the result.
    limb : OutlineLimb
        The limb.
    edge : float
        Length of the edges of its triangles.
    marks : (k, 2)
        Points of its outline that are vertices, such as the ends of cuts of what was cut from it.
    """
    root, along = _on_cut(body, limb)
    points = body.vertices[root, :2]
    ring = ClosedCurve(np.concatenate([limb.sampled(edge, marks)[1:-1], points[::-1]]))
    # The root is not divided further.
    longest = max(edge, float(np.linalg.norm(np.diff(points, axis=0), axis=1).max()) * (1.0 + _SAME))
    mesh = without_bridges(planar_mesh(boundary_of([ring]), longest))
    used, faces = proper_part(mesh)
    own = mesh.vertices[used]
    away, nearest = cKDTree(points).query(own[:, :2])
    is_root = away <= _SAME * limb.width
    number = np.where(is_root, root[nearest], len(body.vertices) + np.cumsum(~is_root) - 1)
    whole = TriangleMesh(np.concatenate([body.vertices, own[~is_root]]), np.concatenate([body.faces, number[faces]]))
    begin, end = limb.cut
    axis = complex(*limb.axis) * limb.width / complex(*(end - begin))
    coordinates = limb.coordinates(own[~is_root, :2])
    return whole, AttachedLimb(root, along, coordinates, limb.reaches(coordinates[:, 0]), axis)


def _on_cut(body: TriangleMesh, limb: OutlineLimb) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
    """Return the vertices of a body on the cut of a limb, in order, and their places on it."""
    begin, end = limb.cut
    across = (end - begin) / limb.width
    away = body.vertices[:, :2] - begin
    along, beside = away @ across / limb.width, away @ np.array([-across[1], across[0]])
    root = np.flatnonzero((np.abs(beside) <= _SAME * limb.width) & (along >= -_SAME) & (along <= 1.0 + _SAME))
    root = root[np.argsort(along[root], kind="stable")]
    return root, along[root]
