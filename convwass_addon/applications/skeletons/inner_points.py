# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The point inside a body behind a point of its surface, for setting a pin with one click."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.closest_points import ClosestPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...transport import Surface
from ..workers import one_blas_thread
from .skeleton_bodies import SkeletonBody, skeleton_body

# Chosen by eye; docs/performance, "Skeletons", lists what these and the other constants of the fit achieve.
# Blur along the surface, in half thicknesses behind the point, that moves the mean to the middle of a limb.
_REACH = 2.0
# Least blur in mean edge lengths: narrower kernels resolve edges, not the surface.
_LEAST_BLUR = 1.5
# If the mean is not deep enough, the blur is widened by this factor, at most this often.
_WIDER, _ROUNDS = 1.4, 6
# Fraction of the desired depth that is sufficient.
_SHALLOW = 0.4
# A click within this many diagonals of a part of the body is on that part.
_NEAR = 0.02


@dataclass(frozen=True)
class InnerPoint:
    """A point inside a body.

    Attributes
    ----------
    position : (3,) float64
        Its position.
    depth : float
        Its distance from the surface.
    """

    position: NDArray[np.float64]
    depth: float


@dataclass(frozen=True)
class _Body:
    """A body with its lookup structures."""

    body: SkeletonBody
    surface: Surface
    closest: ClosestPointFinder


class InnerPointFinder:
    """Finds points inside one body behind points of its surface, reusing computed data between calls.

    Parameters
    ----------
    mesh : TriangleMesh
        The body.
    """

    def __init__(self, mesh: TriangleMesh) -> None:
        self._mesh = mesh
        self._bodies: list[_Body] = []

    def find(self, point: ArrayLike, depth: float = 1.0) -> InnerPoint:
        """Return the point inside the body behind a point of its surface.

        A unit mass at the point is diffused along the surface until its mean lies inside. If that fails, the middle of
        the body straight behind the point is used.

        Parameters
        ----------
        point : (3,)
            On or near the surface.
        depth : float
            1 reaches about the middle of the limb, less stays closer to the surface.

        Raises
        ------
        InputError
            The body encloses nothing, or the depth is not positive.
        """
        if not (np.isfinite(depth) and depth > 0):
            raise InputError("The depth of a pin must be a positive number.")
        clicked = np.asarray(point, dtype=np.float64).reshape(3)
        own = self._at(clicked)
        body, surface = own.body, own.surface
        found = own.closest.find(clicked[None])
        corners, shares = body.surface.faces[found.triangles[0]], found.shares[0]
        mass = np.zeros(surface.shape)
        mass[corners] += shares / surface.weights[corners]
        foot, normal = found.interpolated(body.surface.corners)[0], _normal(body.surface.corners[found.triangles[0]])
        start = foot - 1e-6 * body.surface.diagonal * normal
        thickness = min(body.inside.first_hit(start, -normal), body.surface.diagonal)
        blur = max(depth * _REACH * 0.5 * thickness / surface.unit_length, _LEAST_BLUR * surface.mean_edge_length)
        wanted = 0.5 * thickness * min(depth, 1.0)
        for _ in range(_ROUNDS):
            place = _mean(mass, surface, blur)
            reached = float(body.inside.distances(place[None])[0])
            if reached >= _SHALLOW * wanted and body.inside.contains(place[None])[0]:
                return InnerPoint(place, reached)
            blur *= _WIDER
        # On a sheet, a blur wide enough to get around its edge spreads everywhere.
        place = body.inside.nearest(foot[None], wanted).positions[0]
        return InnerPoint(place, float(body.inside.distances(place[None])[0]))

    def _at(self, point: NDArray[np.float64]) -> _Body:
        """Return the part of the body at a point; among separate parts, another may be nearer than the last one."""
        for known in self._bodies:
            if known.closest.find(point[None]).distances[0] <= _NEAR * known.body.surface.diagonal:
                return known
        body = skeleton_body(self._mesh, point[None], ("",))
        surface = Surface(body.surface.vertices, body.surface.faces)
        self._bodies.append(_Body(body, surface, ClosestPointFinder(body.surface.corners)))
        return self._bodies[-1]


def _mean(mass: NDArray[np.float64], surface: Surface, blur: float) -> NDArray[np.float64]:
    """Mean position of a mass after a blur, given as a standard deviation in units of the domain."""
    kernel = surface.with_kernel(2.0 * blur**2)
    with one_blas_thread():
        heat = kernel.apply(mass) * kernel.weights
    return heat @ surface.positions / heat.sum()


def _normal(corners: NDArray[np.float64]) -> NDArray[np.float64]:
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return normal / max(np.linalg.norm(normal), np.finfo(float).tiny)
