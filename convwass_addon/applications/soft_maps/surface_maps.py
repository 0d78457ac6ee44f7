# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Maps between two surfaces: images of all vertices, in both directions, and the distributions behind them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...one_line import one_line
from ...sentence import Sentence


@dataclass(frozen=True)
class PointMap:
    """One point of another mesh for every vertex.

    Attributes
    ----------
    faces : (n,) int32
        The triangle of the other mesh that contains the point; -1 for vertices without image: those of no triangle or
        of an unmatched component.
    barycentric : (n, 3) float32
        Barycentric coordinates in the triangle: nonnegative, of sum 1; zero without a point.
    spread : (n,) float32
        Standard deviation of the distribution that the point is the mean of, in scene units of the other mesh; infinite
        without a point.
    entropy : (n,) float32
        Entropy of the same distribution, in nats: 0 if uniform over the other mesh, negative if concentrated.
    confidence : (n,) float32
        From 0, no point at all, to 1, as concentrated as possible. It shows where to look; it is not a probability.
    """

    faces: NDArray[np.int32]
    barycentric: NDArray[np.float32]
    spread: NDArray[np.float32]
    entropy: NDArray[np.float32]
    confidence: NDArray[np.float32]

    __repr__ = one_line("faces", "barycentric", "confidence")

    def __len__(self) -> int:
        """Return the number of vertices."""
        return len(self.faces)

    @property
    def found(self) -> NDArray[np.bool_]:
        """Mask of the vertices that have a point, (n,)."""
        return self.faces >= 0

    def corners(self, other: TriangleMesh) -> NDArray[np.int64]:
        """Return the vertices of the other mesh's triangle at each point, (n, 3); arbitrary without a point."""
        return other.faces[np.maximum(self.faces, 0)]

    def at(self, other: TriangleMesh, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """Interpolate values at the other mesh's vertices, (m,) or (m, d), at the points; 0 without a point."""
        return np.einsum("nk,nk...->n...", self.barycentric.astype(np.float64), values[self.corners(other)])

    def positions(self, other: TriangleMesh) -> NDArray[np.float64]:
        """Return the points on the other mesh, (n, 3); NaN without a point."""
        points = self.at(other, other.vertices)
        points[~self.found] = np.nan
        return points


@dataclass(frozen=True)
class VertexInterpolation:
    """Every vertex of a mesh as a weighted mean of up to three vertices of a coarser one.

    Attributes
    ----------
    columns : (n, 3) int32
        Vertices of the coarser mesh.
    shares : (n, 3) float32
        Their weights: of sum 1, or 0 for vertices that belong to nothing.
    """

    columns: NDArray[np.int32]
    shares: NDArray[np.float32]

    def applied(self, values: NDArray[np.floating]) -> NDArray[np.float64]:
        """Interpolate values at the coarser vertices, (c,) or (c, d), at all vertices, (n,) or (n, d)."""
        return np.einsum("nk,nk...->n...", self.shares.astype(np.float64), values[self.columns])


@dataclass(frozen=True)
class CoarseRows:
    """The soft map on the coarse meshes, without negligible densities, and the extension to all vertices.

    Attributes
    ----------
    starts : (c + 1,) int64
        Start of each coarse source vertex's row in the two arrays below.
    columns : (e,) int32
        Coarse target vertices.
    values : (e,) float32
        Densities there, such that a row extended to all target vertices has mass 1 with respect to relative areas.
    source : VertexInterpolation
        Source vertices as weighted means of coarse ones.
    target : VertexInterpolation
        Target vertices as weighted means of coarse ones.
    """

    starts: NDArray[np.int64]
    columns: NDArray[np.int32]
    values: NDArray[np.float32]
    source: VertexInterpolation
    target: VertexInterpolation

    def row(self, coarse_vertex: int, count: int) -> NDArray[np.float64]:
        """Return the row of a coarse source vertex, (count,)."""
        own = slice(self.starts[coarse_vertex], self.starts[coarse_vertex + 1])
        row = np.zeros(count)
        row[self.columns[own]] = self.values[own]
        return row


@dataclass(frozen=True)
class SurfaceMap:
    """A map between two meshes, in both directions.

    Attributes
    ----------
    forward : PointMap
        A point on the target for every source vertex.
    backward : PointMap
        A point on the source for every target vertex.
    coarse : CoarseRows
        The distributions behind it.
    record : mapping
        JSON-ready figures of the solve.
    notices : tuple of Sentence
        Warnings for the user.
    """

    forward: PointMap
    backward: PointMap
    coarse: CoarseRows
    record: Mapping[str, object] = field(default_factory=dict)
    notices: tuple[Sentence, ...] = ()

    __repr__ = one_line("forward", "backward", "notices")


def distribution_of(found: SurfaceMap, source_vertex: int) -> NDArray[np.float64]:
    """Return the distribution of one source vertex over the target, as a density at its vertices, (m,).

    Its mass with respect to the target's areas, normalized to sum 1, is 1; it is zero for a vertex without image.

    Raises
    ------
    InputError
        No such vertex.
    """
    if not 0 <= source_vertex < len(found.forward):
        raise InputError(
            "There is no vertex {vertex}; the source has {count} vertices.",
            vertex=source_vertex,
            count=len(found.forward),
        )
    rows = found.coarse
    count = int(rows.target.columns.max(initial=0)) + 1
    count = max(count, int(rows.columns.max(initial=0)) + 1)
    coarse = rows.source
    parts = zip(coarse.columns[source_vertex], coarse.shares[source_vertex], strict=True)
    row = sum((float(share) * rows.row(int(vertex), count) for vertex, share in parts if share > 0), np.zeros(count))
    return rows.target.applied(row)
