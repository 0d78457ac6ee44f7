# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Extend the rows of a soft map between coarse meshes to images of all vertices."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import block_diag, csr_array

from ...geometry.algebra.quotients import quotients
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control
from ...sentence import Sentence
from ...transport import SoftMap
from ..workers import both_ways
from .coarse_sides import CoarseSide
from .map_pieces import PieceMatch, faces_of
from .map_sides import MapSide
from .settled_maps import settled
from .surface_maps import CoarseRows, PointMap, SurfaceMap, VertexInterpolation

# Densities below this fraction of a row's largest are not stored.
_NEXT_TO_NOTHING = 1e-3
DOUBTFUL = 0.3
"""Points with less confidence should be checked."""

# Largest fraction of a surface's area that may be doubtful without a warning.
_MUCH = 0.3
# Spread of a point, or error of the round trip, for which the confidence is 0.6, relative to the size of the surface
# (the square root of its area).
_VAGUE = 0.08


class Parts:
    """Accumulates the contributions of matched components to a map.

    Parameters
    ----------
    source, target : MapSide
        The whole meshes.
    sharpness : float
        Sharpness of the maps, 0 to 1. Wide rows only indicate doubt as far as the kernel's blur was removed.
    """

    def __init__(self, source: MapSide, target: MapSide, sharpness: float) -> None:
        self.source, self.target = source, target
        self._sharpness = sharpness
        self.notices: list[Sentence] = []
        self._records: list[dict[str, object]] = []
        self._rows: list[csr_array] = []
        sizes = [len(side.mesh.vertices) for side in (source, target)]
        self._points = [_no_points(size) for size in sizes]
        self._interpolations = [
            VertexInterpolation(np.zeros((size, 3), np.int32), np.zeros((size, 3), np.float32)) for size in sizes
        ]
        self._counts = [0, 0]

    @property
    def forward(self) -> PointMap:
        """The points on the target that are known so far."""
        return self._points[0]

    def add(
        self,
        match: PieceMatch,
        source: CoarseSide,
        target: CoarseSide,
        solved: SoftMap,
        back: NDArray[np.float32],
        pairs: NDArray[np.int64],
        is_mirrored: bool,
        notices: tuple[Sentence, ...],
        control: Control = UNINTERRUPTED,
    ) -> None:
        """Add the map between two matched components.

        Parameters
        ----------
        match : PieceMatch
            Vertices of the components.
        source, target : CoarseSide
            The coarse meshes.
        solved : SoftMap
            Map from the coarse source to the coarse target.
        back : (n1, n0)
            Densities of the inverse direction, or proportional to them.
        pairs : (k, 2) int64
            Corresponding coarse vertices.
        is_mirrored : bool
            Whether the map reverses orientation, as between mirror images.
        notices : tuple of Sentence
            Warnings for the user.
        control : Control
            Stops the work when cancelled.
        """
        sides, vertices = (source, target), (match.source, match.target)
        rows = unit_rows(solved.densities, target.masses)
        rows_of = (rows, unit_rows(back, source.masses))

        def extended(way: int) -> PointMap:
            whole = (self.target, self.source)[way]
            both = pairs[:, ::-1] if way else pairs
            own, other = sides[way], sides[1 - way]
            return _extended(rows_of[way], own, other, both, whole, vertices[1 - way], is_mirrored, control)

        for way, found in enumerate(both_ways(extended)):
            control.check()
            _place(self._points[way], found, vertices[way])
            interpolation = sides[way].interpolation
            self._interpolations[way].columns[vertices[way]] = interpolation.columns + self._counts[way]
            self._interpolations[way].shares[vertices[way]] = interpolation.shares
            self._counts[way] += len(sides[way].vertices)
        for way in range(2):
            control.check()
            self._compute_confidence(way, vertices[way], sides[way], sides[1 - way])
        kept = np.where(rows < _NEXT_TO_NOTHING * rows.max(axis=1, keepdims=True), 0.0, rows)
        # As densities on an area of which they only cover a fraction.
        self._rows.append(csr_array(unit_rows(kept, target.masses) / self._share(match.target)))
        self.notices.extend(notices)
        self._records.append(
            {
                "source_vertices": len(source.vertices),
                "target_vertices": len(target.vertices),
                "sweeps": solved.iterations,
                "change": float(solved.changes[-1]),
                "converged": bool(solved.converged),
                "numerics": solved.numerics,
            }
        )

    def _compute_confidence(self, way: int, vertices: NDArray[np.int64], own: CoarseSide, other: CoarseSide) -> None:
        """Compute confidence from the spread of the points, and from the error of the round trip."""
        here, there = (self.source, self.target)[way], (self.target, self.source)[way]
        points, back = self._points[way], self._points[1 - way]
        home = back.at(here.mesh, here.mesh.vertices)
        missed = np.linalg.norm(points.at(there.mesh, home) - here.mesh.vertices, axis=1)[vertices]
        # Rows that keep their blur are wide even where points are accurate; then only the round trip counts.
        wide = self._sharpness * _excess_lengths(points.spread[vertices], other.side.mesh)
        lost = np.square(missed) / own.side.mesh.area
        points.confidence[vertices] = np.exp(-0.5 * (wide + lost) / _VAGUE**2)

    def _share(self, vertices: NDArray[np.int64]) -> float:
        """Return the fraction of the target's area around some of its vertices."""
        areas = self.target.mesh.vertex_areas
        return float(areas[vertices].sum() / areas.sum())

    def joined(self, record: Mapping[str, object]) -> SurfaceMap:
        """Return the map of all matched components."""
        if not record.get("pairs"):
            self.notices.append(
                Sentence("Without pairs left and right cannot be told apart; mark two or three, off the middle.")
            )
        forward, backward = self._points
        rows = csr_array(block_diag(self._rows, format="csr"))
        coarse = CoarseRows(
            rows.indptr.astype(np.int64),
            rows.indices.astype(np.int32),
            rows.data.astype(np.float32),
            *self._interpolations,
        )
        for side, points in ((self.source, forward), (self.target, backward)):
            self.notices.extend(_warnings(side, points))
        return SurfaceMap(forward, backward, coarse, {**record, "parts": self._records}, tuple(self.notices))


def _warnings(side: MapSide, points: PointMap) -> Iterator[Sentence]:
    """Warn about vertices without image, and about areas of low confidence."""
    areas = side.mesh.vertex_areas
    lost = ~points.found & (areas > 0)
    if lost.any():
        values = {"count": int(lost.sum()), "name": side.name}
        yield Sentence("{count} vertices of {name} have no counterpart: mark a pair on each of their pieces.", values)
    share = float(areas[points.found & (points.confidence < DOUBTFUL)].sum() / areas.sum())
    if share > _MUCH:
        yield Sentence(
            "{share:.0%} of {name} is mapped with little confidence: look at it, and mark more pairs there.",
            {"share": share, "name": side.name},
        )


def unit_rows(densities: NDArray[np.floating], masses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normalize rows, (n0, n1), to mass 1 with respect to areas, (n1,); zero rows become uniform."""
    rows = np.asarray(densities, dtype=np.float64)
    return quotients(rows, (rows * masses).sum(axis=1, keepdims=True), 1.0)


def _no_points(count: int) -> PointMap:
    return PointMap(
        np.full(count, -1, np.int32),
        np.zeros((count, 3), np.float32),
        np.full(count, np.inf, np.float32),
        np.zeros(count, np.float32),
        np.zeros(count, np.float32),
    )


def _place(points: PointMap, found: PointMap, vertices: NDArray[np.int64]) -> None:
    for name in ("faces", "barycentric", "spread", "entropy"):
        getattr(points, name)[vertices] = getattr(found, name)


def _extended(
    rows: NDArray[np.float64],
    own: CoarseSide,
    other: CoarseSide,
    pairs: NDArray[np.int64],
    whole: MapSide,
    vertices: NDArray[np.int64],
    is_mirrored: bool,
    control: Control,
) -> PointMap:
    """Return images on part of a whole mesh, given by its vertices, for all vertices of a coarse mesh's fine one."""
    shares = rows * other.masses
    images, normals = shares @ other.centers, shares @ other.normals
    spread = np.sqrt(
        np.maximum(
            shares @ np.square(other.centers - images.mean(axis=0)).sum(axis=1)
            - np.square(images - images.mean(axis=0)).sum(axis=1),
            0.0,
        )
    )
    entropy = -(shares * np.log(np.maximum(rows, 1e-30))).sum(axis=1)
    images = settled(own.side.mesh, other.side.mesh, images, pairs, is_mirrored, control)
    # Pairs are exact.
    images[pairs[:, 0]] = other.side.mesh.vertices[pairs[:, 1]]
    faces = faces_of(whole.mesh, vertices)
    part = replace(whole.mesh, faces=whole.mesh.faces[faces])
    control.check()
    finder = FacingPointFinder(part)
    found = finder.find(own.interpolation.applied(images), own.interpolation.applied(normals), control)
    return PointMap(
        faces[found.triangles].astype(np.int32),
        found.shares.astype(np.float32),
        own.interpolation.applied(spread).astype(np.float32),
        own.interpolation.applied(entropy).astype(np.float32),
        np.zeros(len(own.interpolation.columns), np.float32),
    )


def _excess_lengths(lengths: NDArray[np.floating], mesh: TriangleMesh) -> NDArray[np.float64]:
    """Return squared lengths minus the squared edge length of a coarse mesh, relative to its area."""
    edges = np.linalg.norm(mesh.corners - np.roll(mesh.corners, 1, axis=1), axis=2).mean()
    return np.maximum(np.square(lengths, dtype=np.float64) - edges**2, 0.0) / mesh.area
