# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Carriers: meshes on which shapes are deformed, fine enough to bend and coarse enough to be fast."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from ...geometry.arrays.label_sums import label_sums
from ...geometry.deformation.component_links import component_links
from ...geometry.deformation.limb_axes import LimbAxes
from ...geometry.deformation.poisson_deformation import Links, PoissonDeformation
from ...geometry.deformation.thickness_links import thickness_links
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.barycentric import barycentric_coordinates
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.edges import proper_part
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.surface_samples import SurfaceSamples
from ...geometry.remeshing.coarsening import coarsened, coarsening_steps
from ...geometry.remeshing.subdivision import bendable
from ...geometry.solids.orientation import orient_outward
from ...progress import Control, drained, shares_within
from ..usable_meshes import require_surface, too_intricate

# A mesh with up to this many times the vertices of a carrier is its own carrier.
_NEAR_ENOUGH = 1.5
# Meshes that cannot be simplified are used unchanged up to this many times the vertices of a carrier.
_BEARABLE = 8
# Number of sampled vertices, the distance up to which they are linked, in sizes of the surface, and the stiffness of
# their positions, which hold the surface over a twentieth of its size (docs/performance, "Maps and registrations").
_SAMPLES, _REACH, _ANCHORING = 300, 0.4, 400.0
# Fractions of the work until a shape faces outward and until it is coarser, measured with 1 040 000 vertices.
_ORIENTED, _COARSENED = 0.25, 0.95


@dataclass(frozen=True)
class Carrier:
    """A shape and the mesh on which it is deformed.

    Attributes
    ----------
    name : str
        Name of the shape, for messages.
    rest : TriangleMesh
        The shape at rest, with long edges divided. The vertices of the input come first.
    parents : (t,) int64 or None
        The triangle of the input that contains each triangle of `rest`; None if nothing was divided.
    mesh : TriangleMesh
        The deformed mesh, oriented outward; it has the vertices of `rest`, or is coarser.
    seeds : (c,) int64
        For each of its vertices, the index of that vertex in `rest`.
    blend : csr_array or None
        The vertices of `rest` as weighted means of those of `mesh`, (n, c); None if they are the same.
    poisson : PoissonDeformation
        Deformation solver of `mesh`.
    """

    name: str
    rest: TriangleMesh
    parents: NDArray[np.int64] | None
    mesh: TriangleMesh
    seeds: NDArray[np.int64]
    blend: csr_array | None
    poisson: PoissonDeformation = field(repr=False)

    @cached_property
    def unit(self) -> UnitShape:
        """The mesh rescaled to unit area."""
        return UnitShape.of(self.mesh)

    @cached_property
    def limb_axes(self) -> LimbAxes:
        """Axes of the limbs that its vertices belong to."""
        return LimbAxes.of(self.unit)

    @cached_property
    def finder(self) -> FacingPointFinder:
        """Finds points on the mesh."""
        return FacingPointFinder(self.mesh)

    def __getstate__(self) -> dict[str, object]:
        # Factorizations cannot be pickled, and these are only needed while motions are prepared.
        return {name: value for name, value in self.__dict__.items() if name not in ("unit", "limb_axes", "finder")}

    @cached_property
    def samples(self) -> SurfaceSamples:
        """Sampled vertices of `mesh` that represent its parts."""
        return SurfaceSamples.of(self.mesh, _SAMPLES, _REACH)

    def posed(self, rest: NDArray[np.float64]) -> Carrier:
        """Return the carrier of another pose, given by the vertices of `rest`; its samples stay the same."""
        mesh = TriangleMesh(self.mesh.vertices + rest[self.seeds] - self.rest.vertices[self.seeds], self.mesh.faces)
        poisson = PoissonDeformation(mesh, self.poisson.links, _ANCHORING)
        posed = replace(self, rest=TriangleMesh(rest, self.rest.faces), mesh=mesh, poisson=poisson)
        vars(posed)["samples"] = self.samples
        return posed

    def following_gradients(self) -> Carrier:
        """Return the carrier whose triangles follow their gradients alone, while each component moves straight.

        Joints between samples are left out: neighboring coils of a spiral are close to each other, but far along it.
        """
        found = replace(self, poisson=PoissonDeformation(self.mesh, Links.none()))
        vars(found)["samples"] = replace(self.samples, pairs=self.samples.pairs[:0])
        return found

    def places(self, vertices: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the vertices of `mesh` nearest to given vertices of `rest`, (k,)."""
        return cKDTree(self.mesh.vertices).query(self.rest.vertices[vertices])[1]

    def embedding(self, shape: TriangleMesh) -> ClosestPoints:
        """Return the points of the input at the vertices of `rest`: its vertices, then those on its triangles."""
        count, rest = len(shape.vertices), self.rest
        triangle, corner = np.zeros(len(rest.vertices), np.int64), np.zeros(len(rest.vertices), np.int64)
        if self.parents is not None:
            # Of the triangles around a point, take the largest: some may have no area.
            order = np.argsort(shape.face_areas[self.parents], kind="stable")
            triangle[rest.faces[order].ravel()] = np.repeat(self.parents[order], 3)
        # Unused vertices are invisible, so the first corner of the first triangle serves for them.
        for place in range(3):
            triangle[shape.faces[:, place]], corner[shape.faces[:, place]] = np.arange(len(shape.faces)), place
        shares = np.eye(3)[corner]
        dividing = rest.vertices[count:, None]
        shares[count:] = barycentric_coordinates(shape.corners[triangle[count:]], dividing)[:, 0]
        return ClosestPoints(triangle, shares, np.zeros(len(rest.vertices)))

    def carried(self, points: NDArray[np.float64], gradients: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the deformed vertices of `rest`, (n, 3).

        Parameters
        ----------
        points : (c, 3)
            The deformed vertices of `mesh`.
        gradients : (m, 3, 3)
            Deformation gradients of its triangles.
        """
        if self.blend is None:
            return points
        areas = self.mesh.face_areas
        corners = self.mesh.faces.ravel()
        count = len(points)
        weighted = np.repeat(areas[:, None] * gradients.reshape(-1, 9), 3, axis=0)
        sums = label_sums(corners, weighted, count)
        totals = np.bincount(corners, np.repeat(areas, 3), count)
        local = np.where(totals[:, None] > 0, sums / np.where(totals > 0, totals, 1.0)[:, None], np.eye(3).ravel())
        # Average the affine maps of the carrier's vertices around each vertex.
        shifts = points - np.einsum("nij,nj->ni", local.reshape(-1, 3, 3), self.mesh.vertices)
        blended = self.blend @ np.concatenate([local, shifts], axis=1)
        return np.einsum("nij,nj->ni", blended[:, :9].reshape(-1, 3, 3), self.rest.vertices) + blended[:, 9:]


def carrier_of(mesh: TriangleMesh, name: str, count: int, control: Control) -> Carrier:
    """Prepare a shape without guides for deformation.

    Parameters
    ----------
    mesh : TriangleMesh
        Any triangles; scene units.
    name : str
        Name of the shape, for messages.
    count : int
        Wanted number of vertices of the carrier.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        The mesh has no area, is too far from the origin, or cannot be simplified enough.
    """
    return drained(carrier_steps(mesh, name, np.empty(0, np.int64), count, control))


def carrier_steps(
    mesh: TriangleMesh, name: str, kept: NDArray[np.int64], count: int, control: Control
) -> Generator[float, None, Carrier]:
    """Yield the finished share of the work, and return the same as :func:`carrier_of`, with `kept` vertices, (k,)."""
    require_surface(mesh, name)
    control.check()
    cut = bendable(mesh, int(_NEAR_ENOUGH * count))
    rest = cut.mesh
    control.check()
    outward = orient_outward(rest)
    control.check()
    used, _ = proper_part(outward)
    seeds, blend = np.arange(len(rest.vertices)), None
    if len(used) > _NEAR_ENOUGH * count:
        control.check()
        yield _ORIENTED
        steps = coarsening_steps(outward, outward.vertex_areas, count, kept, control)
        found = yield from shares_within(steps, _ORIENTED, _COARSENED)
        if found is not None and len(found.seeds) < _BEARABLE * count:
            outward, seeds, blend = found.mesh, found.seeds, _with_loose(found.prolongation, rest, found.mesh)
        elif len(used) > _BEARABLE * count:
            raise too_intricate(name, _BEARABLE * count)
    control.check()
    yield _COARSENED
    links = component_links(outward, control).followed_by(thickness_links(outward))
    poisson = PoissonDeformation(outward, links, _ANCHORING)
    return Carrier(name, rest, cut.parents, outward, seeds, blend, poisson)


def coarser(carrier: Carrier, kept: NDArray[np.int64], count: int, control: Control) -> Carrier:
    """Return a carrier of a carrier's mesh with about `count` vertices, or that mesh itself if it cannot be simplified.

    Parameters
    ----------
    carrier : Carrier
        The carrier of a shape.
    kept : (k,) int64
        Vertices of its mesh that must be kept.
    count : int
        Wanted number of vertices.
    control : Control
        Stops the work.
    """
    mesh = carrier.mesh
    if len(mesh.vertices) > _NEAR_ENOUGH * count:
        found = coarsened(mesh, mesh.vertex_areas, count, kept, control=control)
        if found is not None:
            blend = _with_loose(found.prolongation, mesh, found.mesh)
            poisson = PoissonDeformation(found.mesh, Links.none())
            return Carrier(carrier.name, mesh, None, found.mesh, found.seeds, blend, poisson)
    poisson = PoissonDeformation(mesh, Links.none())
    return Carrier(carrier.name, mesh, None, mesh, np.arange(len(mesh.vertices)), None, poisson)


def _with_loose(prolongation: csr_array, fine: TriangleMesh, coarse: TriangleMesh) -> csr_array:
    """Attach vertices that no triangle uses to the nearest vertex of the coarse mesh."""
    loose = np.flatnonzero(np.diff(prolongation.indptr) == 0)
    if not len(loose):
        return prolongation
    nearest = cKDTree(coarse.vertices).query(fine.vertices[loose])[1]
    return csr_array(prolongation + csr_array((np.ones(len(loose)), (loose, nearest)), shape=prolongation.shape))
