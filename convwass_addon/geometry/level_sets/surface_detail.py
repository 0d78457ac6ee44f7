# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Add the detail of shapes to a surface between them that was extracted at a coarse resolution.

For every shape i, each vertex v of the surface has a point y_i on the coarsely extracted surface of the shape, with
sum_i w_i y_i = v. The detail lost by the coarse extraction is d_i = p_i - y_i, where p_i is the closest point of the
shape itself with a similar normal, searched again along the normal of the surface where it is on an oblique face. Where
the coarse surface does not reach a thin rim, p_i is on the rim (:mod:`.missed_rims`). The detailed surface has the
vertices v + sum_i w_i c_i d_i. The trust c_i is 1 unless the shape is far away, faces away, or is inside its own solid
there. With full trust these are sum_i w_i p_i: the surface becomes the shape as its weight goes to one.

Edges are halved where a shape bends between their ends. Where an edge crosses a crease, its midpoint is moved to the
crease (like the vertices in L. Kobbelt, M. Botsch, U. Schwanecke and H.-P. Seidel, "Feature sensitive surface
extraction from volume data", SIGGRAPH 2001), so that creases become edges of the detailed surface.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from ..arrays.steps import linear_step
from ..meshes.closest_points import ClosestPoints
from ..meshes.edge_means import EdgeMeans
from ..meshes.edges import edge_ends, edge_use, faces_touching
from ..meshes.facing_points import FacingShape
from ..meshes.mesh import TriangleMesh
from ..meshes.normals import mean_directions, triangle_normals, unit_vectors
from ..meshes.tangent_planes import meeting_points
from ..remeshing.angle_smoothing import with_wider_angles
from ..remeshing.edge_flips import with_flipped_edges
from ..remeshing.subdivision import with_edges_halved
from .fold_damping import without_folds
from .missed_rims import FARTHEST, MissedRims, missed_rims
from .volume_correction import with_volume

# Edges are halved where they deviate from a shape by more than the first number of cells, unless they are shorter than
# the second, and for at most this many rounds.
_DEVIATION, _SHORTEST, _ROUNDS = 0.03, 0.25, 2
_MOST_TRIANGLES = 3.0
# Offsets are fully trusted up to the first length in cells, and not at all from the second on.
_TRUSTED, _FARTHEST = 1.25, 2.5
# Points of a shape are on the surface of its solid up to the first filled fraction around them, and inside from the
# second on.
_SURFACE, _INSIDE = 0.9, 0.985
# Points are searched again along the normal if its cosine to the normal of the triangle found is below this.
_OBLIQUE = 0.92
# Points are relaxed where triangles on a shape are rotated beyond this cosine, in this many rounds.
_TURNED, _RELAXATIONS = 0.3, 4
# A triangle lower than this fraction of its longest side has no direction: its corners lie along a crease.
_LOW = 0.1
# Rounds in which trust is smoothed towards points without trust.
_FADING = 2
# Blends have sharp rims where shapes with more than the second weight have them, and soft ones up to the first weight;
# chosen by eye on a fish and a butterfly.
_SOFT, _SHARP = 0.5, 0.9
# Edges of narrow triangles are flipped, and then their vertices moved, if the surface moves by at most this many cells.
_FLAT, _SMOOTH = 0.03, 0.01
# Triangles that are processed together: their arrays fit into the cache of a processor.
_AT_ONCE = 1 << 12


@dataclass(frozen=True)
class DetailSource:
    """A shape whose detail is added.

    Attributes
    ----------
    shape : FacingShape
        In the space of the surface.
    weight : float
        Its weight in the surface.
    starts : (n, 3) float64
        The points on its coarsely extracted surface that belong to the vertices of the surface.
    certainty : (n,) float64
        Confidence in these points, from 0 to 1, which limits the trust in offsets.
    filled : callable
        Takes points, (p, 3), and returns the filled fraction of the space around each, (p,).
    reliability : (v,) float64 or None
        How reliable the shape's detail is at its vertices, from 0 to 1; None if it is reliable everywhere.
    """

    shape: FacingShape
    weight: float
    starts: NDArray[np.float64]
    certainty: NDArray[np.float64]
    filled: Callable[[NDArray[np.float64]], NDArray[np.floating]]
    reliability: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class DetailedSurface:
    """A surface with the detail of the shapes that it interpolates.

    Attributes
    ----------
    mesh : TriangleMesh
        It has more triangles where there is detail.
    places : list of ClosestPoints
        For every shape, the points on it that belong to the vertices of the mesh.
    origins : list of (n, 3) float64
        These points, as far as they are trusted; otherwise the starts of the vertices.
    triangles : list of (m,) int64
        For every shape, the triangles on which the triangles of the mesh lie.
    """

    mesh: TriangleMesh
    places: list[ClosestPoints]
    origins: list[NDArray[np.float64]]
    triangles: list[NDArray[np.int64]]


def with_detail(
    surface: TriangleMesh,
    sources: Sequence[DetailSource],
    cell: float,
    amount: float,
    volume: float,
    control: Control = UNINTERRUPTED,
    face_size: float = 1.0,
) -> DetailedSurface:
    """Add the detail of shapes to a surface.

    Parameters
    ----------
    surface : TriangleMesh
        Closed and oriented outward, in any space.
    sources : sequence of DetailSource
        The shapes, with weights of sum one.
    cell : float
        The resolution at which the surface was extracted, a length in that space.
    amount : float
        Fraction of the detail to add, from 0 to 1.
    volume : float
        Volume that the detailed surface should enclose.
    control : Control
        Cancels the work.
    face_size : float
        Edge length of the surface in cells: edges that are twice as long may deviate four times as much.
    """
    normals = _even_normals(surface)
    laid = _Laid(surface, normals, [_Carried.found(source, normals, control) for source in sources]).to_rims(cell)
    most = int(_MOST_TRIANGLES * len(surface.faces))
    for _ in range(_ROUNDS):
        control.check()
        finer = laid.refined(cell, face_size, most)
        if finer is None:
            break
        laid = finer
    control.check()
    means = EdgeMeans.of(laid.mesh)
    laid = laid.relaxed(means)
    details = [own.details(own.faded_trust(laid.normals, cell, means)) for own in laid.carried]
    wanted = sum(amount * own.source.weight * detail for own, detail in zip(laid.carried, details, strict=True))
    offsets = without_folds(laid.mesh, laid.normals, wanted, means)
    detailed = with_volume(TriangleMesh(laid.mesh.vertices + offsets, laid.mesh.faces), laid.normals, volume, cell)
    even = with_wider_angles(with_flipped_edges(detailed, _FLAT * cell), _SMOOTH * cell)
    moves = even.vertices - detailed.vertices
    carried = [own.moved(moves) for own in laid.carried]
    origins = [own.starts + detail + moves for own, detail in zip(laid.carried, details, strict=True)]
    places = [own.places for own in carried]
    triangles = [own.triangles_under(even.faces) for own in carried]
    return DetailedSurface(even, places, origins, triangles)


@dataclass(frozen=True)
class _Carried:
    """The points of one shape that belong to the vertices of a surface."""

    source: DetailSource
    facing: NDArray[np.float64]
    """Normals of the shape's triangles, (m, 3)."""
    starts: NDArray[np.float64]
    certainty: NDArray[np.float64]
    places: ClosestPoints
    points: NDArray[np.float64]
    on_rim: NDArray[np.bool_]
    """Whether points are on rims that the coarse surface does not reach, (n,)."""

    @classmethod
    def found(cls, source: DetailSource, normals: NDArray[np.float64], control: Control) -> _Carried:
        """Find the points for the vertices of a surface with these normals, (n, 3)."""
        finder, corners, starts = source.shape.finder, source.shape.mesh.corners, source.starts
        places, facing = finder.find(starts, normals, control), triangle_normals(corners)
        points = places.interpolated(corners)
        # Below a crease, the closest points of neighbors are far apart on either side of it, but along the normals, the
        # crease itself is next.
        oblique = np.flatnonzero(np.einsum("nd,nd->n", facing.take(places.triangles, axis=0), normals) < _OBLIQUE)
        along, begin = normals[oblique], starts[oblique]
        ahead = np.einsum("nd,nd->n", points[oblique] - begin, along)
        found = finder.find(begin + ahead[:, None] * along, along, control)
        points[oblique] = found.interpolated(corners)
        nowhere = np.zeros(len(points), bool)
        return cls(source, facing, starts, source.certainty, places.replaced(oblique, found), points, nowhere)

    def missed_rims(self, normals: NDArray[np.float64], cell: float) -> MissedRims:
        """Return the rims of the shape that its coarse surface, with normals (n, 3), does not reach."""
        return missed_rims(self.source.shape.mesh, self.starts, normals, cell, self.source.filled)

    def to_rims(self, rims: MissedRims, sharpness: NDArray[np.float64]) -> _Carried:
        """Move the points of vertices next to rims towards these, by a fraction for every vertex, (n,)."""
        chosen = sharpness[rims.vertices] > 0.0
        rows, share = rims.vertices[chosen], sharpness[rims.vertices[chosen], None]
        wanted = (1.0 - share) * self.points[rows] + share * rims.points[chosen]
        found = self.source.shape.finder.find_closest(wanted)
        points, on_rim = self.points.copy(), self.on_rim.copy()
        points[rows], on_rim[rows] = found.interpolated(self.source.shape.mesh.corners), True
        return replace(self, places=self.places.replaced(rows, found), points=points, on_rim=on_rim)

    @cached_property
    def normals(self) -> NDArray[np.float64]:
        return self.facing.take(self.places.triangles, axis=0)

    def deviations(self, ends: NDArray[np.int64]) -> NDArray[np.float64]:
        """Estimate the distances of the shape from the midpoints of edges, (e, 2), that connect points of it."""
        first, second = ends.T
        edges = self.points.take(second, axis=0) - self.points.take(first, axis=0)
        heights = [np.abs(np.einsum("nd,nd->n", edges, self.normals.take(end, axis=0))) for end in (first, second)]
        # On an arc of curvature k, the ends of a chord of length l are k l^2 / 2 off each other's tangents, and the
        # chord is k l^2 / 8 off the arc.
        return np.minimum(*heights) / 4.0

    def with_middles(self, ends: NDArray[np.int64]) -> _Carried:
        """Add the midpoints of some edges, (s, 2), on the crease if an edge crosses one."""
        first, second = ends.T
        normals = self.normals
        wanted = meeting_points(self.points[first], normals[first], self.points[second], normals[second])
        on_rim = self.on_rim[first] & self.on_rim[second]
        wanted[on_rim] = 0.5 * (self.points[first] + self.points[second])[on_rim]
        found = self.source.shape.finder.find_closest(wanted)
        return replace(
            self,
            starts=np.concatenate([self.starts, 0.5 * (self.starts[first] + self.starts[second])]),
            certainty=np.concatenate([self.certainty, self.certainty[ends].mean(axis=1)]),
            places=self.places.followed_by(found),
            points=np.concatenate([self.points, found.interpolated(self.source.shape.mesh.corners)]),
            on_rim=np.concatenate([self.on_rim, on_rim]),
        )

    def triangles_under(self, faces: NDArray[np.int64]) -> NDArray[np.int64]:
        """Return the shape's triangle under each face, (m, 3): at the corner whose plane is closest to the others."""
        found = np.empty(len(faces), np.int64)
        for part in chunks(len(faces), _AT_ONCE):
            found[part] = self._triangles_under(faces[part])
        return found

    def _triangles_under(self, faces: NDArray[np.int64]) -> NDArray[np.int64]:
        points, normals = (np.moveaxis(values.take(faces, axis=0), 1, 0) for values in (self.points, self.normals))
        sides = [points[(corner + 1) % 3] - points[corner] for corner in range(3)]
        heights = np.empty((3, len(faces)))
        for corner, normal in enumerate(normals):
            one, other = (np.einsum("md,md->m", side, normal) for side in (sides[corner], sides[corner - 1]))
            np.maximum(np.abs(one), np.abs(other), out=heights[corner])
        nearest = heights.argmin(axis=0)
        return self.places.triangles[faces[np.arange(len(faces)), nearest]]

    def moved(self, moves: NDArray[np.float64]) -> _Carried:
        """Return the points for vertices displaced by `moves`, (n, 3)."""
        rows = np.flatnonzero(moves.any(axis=1))
        found = self.source.shape.finder.find_closest(self.points[rows] + moves[rows])
        points = self.points.copy()
        points[rows] = found.interpolated(self.source.shape.mesh.corners)
        return replace(self, places=self.places.replaced(rows, found), points=points)

    def details(self, trust: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the offsets of the shape from its coarse surface, (n, 3), times their trust."""
        return trust[:, None] * (self.points - self.starts)

    def trust(self, normals: NDArray[np.float64], cell: float) -> NDArray[np.float64]:
        """Return the trust in offsets, (n,), from 0 to 1."""
        offsets = self.points - self.starts
        distances = np.sqrt(np.einsum("nd,nd->n", offsets, offsets)) / cell
        agreement = np.einsum("nd,nd->n", self.normals, normals)
        outside = (_INSIDE - self.source.filled(self.points)) / (_INSIDE - _SURFACE)
        near = (_FARTHEST - distances) / (_FARTHEST - _TRUSTED)
        # At a sharp rim, one of both sides is found, and neither faces away from the shape.
        agreement[self.on_rim], near[self.on_rim] = 1.0, FARTHEST + 1.0 - distances[self.on_rim]
        known = self.certainty * np.prod([np.clip(part, 0.0, 1.0) for part in (near, 2.0 * agreement, outside)], axis=0)
        if self.source.reliability is None:
            return known
        corners = self.source.shape.mesh.faces.take(self.places.triangles, axis=0)
        return known * np.einsum("nc,nc->n", self.places.shares, self.source.reliability.take(corners))

    def faded_trust(self, normals: NDArray[np.float64], cell: float, means: EdgeMeans) -> NDArray[np.float64]:
        """Return the trust in offsets, smoothed towards points without trust, except on rims, (n,)."""
        trust = self.trust(normals, cell)
        return np.where(self.on_rim, trust, means.spread_minimum(trust, _FADING))

    def relaxed(self, faces: NDArray[np.int64], facing: NDArray[np.float64], means: EdgeMeans) -> _Carried:
        """Move points of flipped or upright triangles to the mean of their neighbors, projected onto the shape.

        Parameters
        ----------
        faces : (m, 3) int64
            Triangles of the surface.
        facing : (m, 3) float64
            Normals of the surface.
        means : EdgeMeans
            Means over the edges of the surface.
        """
        places, points = self.places, self.points.copy()
        # Only triangles around moved vertices change.
        rows = np.arange(len(faces))
        for _ in range(_RELAXATIONS):
            corners = points.take(faces.take(rows, axis=0), axis=0)
            agreement = np.einsum("md,md->m", triangle_normals(corners), facing.take(rows, axis=0))
            away = np.flatnonzero(agreement < _TURNED)
            turned = rows[away[~_are_low(corners[away])]]
            if not len(turned):
                break
            near = np.zeros(len(points), bool)
            near[faces[turned]] = True
            chosen = means.with_neighbors(near) & ~self.on_rim
            moved = np.flatnonzero(chosen)
            found = self.source.shape.finder.find_closest(means.mean_points_at(points, moved))
            places = places.replaced(moved, found)
            points[moved] = found.interpolated(self.source.shape.mesh.corners)
            rows = faces_touching(faces, chosen)
        return replace(self, places=places, points=points)


@dataclass(frozen=True)
class _Laid:
    """A surface, and the points of all shapes that belong to its vertices."""

    mesh: TriangleMesh
    normals: NDArray[np.float64]
    carried: list[_Carried]

    def to_rims(self, cell: float) -> _Laid:
        """Move points to rims that the surface does not reach, where shapes of enough weight have them."""
        found = [own.missed_rims(self.normals, cell) for own in self.carried]
        weights = np.zeros(len(self.normals))
        for own, rims in zip(self.carried, found, strict=True):
            weights[rims.vertices] += own.source.weight
        sharpness = linear_step(weights, _SOFT, _SHARP)
        carried = [own.to_rims(rims, sharpness) for own, rims in zip(self.carried, found, strict=True)]
        return replace(self, carried=carried)

    def relaxed(self, means: EdgeMeans) -> _Laid:
        """Relax the points on all shapes."""
        facing = mean_directions(self.normals, self.mesh.faces)
        return replace(self, carried=[own.relaxed(self.mesh.faces, facing, means) for own in self.carried])

    def refined(self, cell: float, face_size: float, most: int) -> _Laid | None:
        """Halve edges between whose ends a shape bends; None if there are none, or too many triangles."""
        use = edge_use(self.mesh.faces)
        ends = edge_ends(self.mesh.faces, use)
        deviations = np.zeros(len(ends))
        longest = np.zeros(len(ends))
        for own in self.carried:
            edges = own.points.take(ends[:, 1], axis=0) - own.points.take(ends[:, 0], axis=0)
            longest = np.maximum(longest, np.sqrt(np.einsum("nd,nd->n", edges, edges)))
            trust = own.trust(self.normals, cell)
            trusted = np.minimum(trust.take(ends[:, 0]), trust.take(ends[:, 1]))
            deviations += own.source.weight * trusted * own.deviations(ends)
        deviations[longest < _SHORTEST * face_size * cell] = 0.0
        # A halved edge adds two triangles.
        room = max((most - len(self.mesh.faces)) // 2, 0)
        chosen = deviations > _DEVIATION * face_size**2 * cell
        if np.count_nonzero(chosen) > room:
            chosen[np.argsort(-deviations, kind="stable")[room:]] = False
        if not chosen.any():
            return None
        halved = with_edges_halved(self.mesh, use, chosen)
        normals = mean_directions(self.normals, halved.ends)
        carried = [own.with_middles(halved.ends) for own in self.carried]
        return _Laid(halved.mesh, np.concatenate([self.normals, normals]), carried)


def _even_normals(mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return vertex normals, averaged with those of the neighbors."""
    normals, means = mesh.vertex_normals, EdgeMeans.of(mesh)
    return unit_vectors(normals + means.mean_points(normals))


def _are_low(corners: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which triangles, (m, 3, 3), are much lower than their longest side."""
    sides = np.roll(corners, -1, axis=1) - corners
    twice_areas = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return twice_areas <= _LOW * np.square(sides).sum(axis=2).max(axis=1)
