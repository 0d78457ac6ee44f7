# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Correct the volume of a closed mesh on its way to another shape, such that it changes evenly.

A body whose lengths grow evenly has too little volume on the way, and joints that bend lose some. Two corrections
remove that. First, the whole mesh is scaled about the fixed point of its growth, as if its volume had grown evenly.
Then vertices are moved along their normals, in proportion to the thickness of the body there, by a factor that gives
the mesh the volume it should have.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...geometry.arrays.chunks import chunks
from ...geometry.meshes.edge_means import EdgeMeans
from ...geometry.meshes.edges import topology
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import area_normals, unit_vectors
from ...geometry.solids.inner_balls import touching_radii
from ...progress import Control, Progress, Work
from ...sentence import Sentence

# Approximate number of vertices at which the thickness is measured; distance, relative to the square root of the area,
# that counts as much as a normal rotated by 60 degrees; rounds of averaging over neighbors.
_BALLS, _TURN, _SMOOTHINGS = 2000, 0.05, 8
# Fraction of the work of making the volume even for measuring the thickness, with 260 000 and 1 040 000 vertices, and
# number of vertices processed together for it.
_MEASURED, _AT_ONCE = 0.3, 1 << 17
# Largest change of the thickness, as a fraction; more would fold the surface.
_MOST = 0.25


def has_volume(mesh: TriangleMesh) -> bool:
    """Return whether a mesh is closed, manifold and outward, so that it has a volume to keep."""
    return len(mesh.faces) > 0 and topology(mesh).closed and mesh.volume > 0.0


def with_even_volume(
    samples: NDArray[np.float64], mesh: TriangleMesh, message: Sentence, control: Control
) -> Work[NDArray[np.float64]]:
    """Return positions along a path, (f, n, 3), at which the volume changes evenly.

    Parameters
    ----------
    samples : (f, n, 3) float64
        Positions at even steps of time. The first and the last stay as they are.
    mesh : TriangleMesh
        At the first of them; see :func:`has_volume`.
    message : Sentence
        Reported with the progress.
    control : Control
        Stops the work.
    """
    last = TriangleMesh(samples[-1], mesh.faces)
    growth = Growth.between(mesh, last)
    control.check()
    yield Progress(0.0, message)
    means, thickness = EdgeMeans.of(mesh), []
    for own in (mesh, last):
        yield Progress(0.5 * _MEASURED * len(thickness), message)
        thickness.append(_thickness(own, means, control))
    found = samples.copy()
    for index in range(1, len(samples) - 1):
        control.check()
        yield Progress(_MEASURED + (1.0 - _MEASURED) * index / len(samples), message)
        t = index / (len(samples) - 1)
        grown = TriangleMesh(growth.evenly_in_volume(samples[index], t), mesh.faces)
        own = (1.0 - t) * thickness[0] + t * thickness[1]
        found[index] = thickened(grown, own, (1.0 - t) * mesh.volume + t * last.volume)
    return found


@dataclass(frozen=True)
class Growth:
    """The even growth of a shape to another.

    Attributes
    ----------
    scale : float
        How much longer the second one is.
    shift : (3,) float64
        Where the growth without rotation takes the origin.
    """

    scale: float
    shift: NDArray[np.float64]

    @classmethod
    def between(cls, first: TriangleMesh, last: TriangleMesh) -> Growth:
        """Compare two meshes with the same faces by their centers, and by distances from these.

        If volumes were compared, a body that only gets thicker would be scaled about its center, and its feet would
        sink into the ground on the way.
        """
        centers, spreads = [], []
        for mesh in (first, last):
            center = mesh.area_center
            centers.append(center)
            spreads.append(mesh.vertex_areas @ np.square(mesh.vertices - center).sum(axis=1) / mesh.area)
        scale = float(np.sqrt(spreads[1] / spreads[0]))
        return cls(scale, centers[1] - scale * centers[0])

    def evenly_in_volume(self, points: NDArray[np.float64], t: float) -> NDArray[np.float64]:
        """Scale points, (n, 3), of a time t as if not the lengths but the volume of the mesh had grown evenly.

        Points are scaled about the fixed point of the growth, so that what rests on the ground stays there.
        """
        gain = self.scale - 1.0
        if abs(gain) < 1e-9:
            return points
        factor = np.cbrt(1.0 + t * (self.scale**3 - 1.0)) / (1.0 + t * gain)
        return factor * points + (factor - 1.0) / gain * self.shift


def thickened(mesh: TriangleMesh, thickness: NDArray[np.float64], volume: float) -> NDArray[np.float64]:
    """Return the vertices, (n, 3), after moving them along their normals, such that the mesh has a given volume.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed, outward.
    thickness : (n,) float64
        Vertices move by this times a common factor.
    volume : float
        The volume; if the factor would exceed a quarter, it stays there.
    """
    centered = mesh.vertices - mesh.vertices.mean(axis=0)
    areas = area_normals(centered, mesh.faces)
    offsets = thickness[:, None] * unit_vectors(areas)
    # The volume is a polynomial of the factor, whose value and slope here, and slope elsewhere, give all but the cubic
    # term. The areas are its gradient.
    missing = volume - float(np.einsum("nd,nd->", areas, centered)) / 3.0
    slope = float(np.einsum("nd,nd->", areas, offsets))
    factor = float(np.clip(missing / slope, -_MOST, _MOST)) if slope > 0.0 else 0.0
    if factor:
        there = area_normals(centered + factor * offsets, mesh.faces)
        bend = (float(np.einsum("nd,nd->", there, offsets)) - slope) / (2.0 * factor)
        root = max(slope**2 + 4.0 * bend * missing, 0.0)
        # The solution of bend x^2 + slope x = missing that stays finite without a bend.
        factor = float(np.clip(2.0 * missing / (slope + np.sqrt(root)), -_MOST, _MOST))
    return mesh.vertices + factor * offsets


def _thickness(mesh: TriangleMesh, means: EdgeMeans, control: Control) -> NDArray[np.float64]:
    """Return the smoothed radius of the largest balls that touch a mesh from inside, (n,)."""
    chosen = np.arange(0, len(mesh.vertices), max(1, len(mesh.vertices) // _BALLS))
    # Vertices between those with balls take the radius of the nearest that faces the same way.
    normals = mesh.vertex_normals
    places = np.concatenate([mesh.vertices, _TURN * mesh.root_area * normals], axis=1)
    tree, nearest = cKDTree(places[chosen]), np.empty(len(places), np.int64)
    for some in chunks(len(places), _AT_ONCE):
        control.check()
        nearest[some] = tree.query(places[some])[1]
    control.check()
    radii = touching_radii(mesh, chosen)[nearest]
    for _ in range(_SMOOTHINGS):
        control.check()
        radii = 0.5 * (radii + means.mean(radii))
    return radii
