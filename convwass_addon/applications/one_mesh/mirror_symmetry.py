# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Keep the motion of a symmetric mesh symmetric, about a plane that moves with it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.meshes.mirror_planes import MirrorPlane

# Mirror images are looked for within this distance, as a fraction of the size, and so many vertices may have none.
_NEAR, _MOST_SINGLE = 2e-3, 0.02


@dataclass(frozen=True)
class MirrorSymmetry:
    """Which vertices of a mesh are mirror images of each other.

    Attributes
    ----------
    partners : (n,) int64
        The mirror image of every vertex; the vertex itself on the plane.
    has_partner : (n,) bool
        False for vertices without a mirror image, whose partner is the vertex itself.
    """

    partners: NDArray[np.int64]
    has_partner: NDArray[np.bool_]

    @classmethod
    def of(cls, vertices: NDArray[np.float64], plane: MirrorPlane, name: str) -> MirrorSymmetry:
        """Pair vertices, (n, 3).

        Raises
        ------
        InputError
            More than a few vertices have no mirror image; the message calls the mesh `name`.
        """
        near = _NEAR * float(np.ptp(vertices, axis=0).max())
        distances, found = cKDTree(vertices).query(plane.mirrored(vertices))
        own = np.arange(len(vertices))
        # Vertices that are split along UV seams have others in the same place, any of which may be found.
        found = np.where((vertices[found] == vertices).all(axis=1), own, found)
        has_partner = (distances <= near) & (vertices[found[found]] == vertices).all(axis=1)
        if (~has_partner).mean() > _MOST_SINGLE:
            raise InputError(
                "{name} is not symmetric: {share:.0%} of its vertices have no mirror image across its local X axis. "
                "Turn off Symmetric.",
                name=name,
                share=float((~has_partner).mean()),
            )
        return cls(np.where(has_partner, found, own), has_partner)

    def plane(self, points: NDArray[np.float64]) -> MirrorPlane:
        """Return the plane about which moved vertices, (n, 3), are most nearly symmetric.

        With the center c of the pairs, the normal n minimizes sum_i n . (p_i - c) (q_i - c) . n, where q_i is the
        partner of p_i: this is least squares over all planes through c.
        """
        one, other = points[self.has_partner], points[self.partners[self.has_partner]]
        center = one.mean(axis=0)
        moments = (one - center).T @ (other - center)
        return MirrorPlane(center, np.linalg.eigh(0.5 * (moments + moments.T))[1][:, 0])

    def mirrored_sides(self, points: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return moved vertices, (n, 3), made symmetric by mirroring one side onto the other, for both sides.

        Unlike means of both, they keep what was done to single vertices of that side. Vertices on the plane are
        projected onto it.
        """
        plane = self.plane(points)
        heights = plane.heights(points)
        mirrored = plane.mirrored(points)[self.partners]
        on_plane = self.has_partner & (self.partners == np.arange(len(points)))
        middle = points - heights[:, None] * plane.normal
        # Of a pair on the same side, one vertex stays.
        above = heights > heights[self.partners]
        found = []
        for kept in (above, ~above):
            sided = np.where((kept | ~self.has_partner)[:, None], points, mirrored)
            found.append(np.where(on_plane[:, None], middle, sided))
        return found[0], found[1]

    def symmetrized(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return moved vertices, (n, 3), each at the mean of its place and the mirror image of its partner's."""
        mirrored = self.plane(points).mirrored(points)[self.partners]
        return np.where(self.has_partner[:, None], 0.5 * (points + mirrored), points)
