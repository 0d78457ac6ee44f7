# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Center lines of tubes: solids such as snakes, ropes and springs, whose sections across the line are single loops."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ...progress import UNINTERRUPTED, Control
from ..arrays.chunks import chunks
from ..arrays.components import component_labels
from ..arrays.label_sums import label_sums
from ..meshes.edges import mesh_edges, used_part
from ..meshes.mesh import TriangleMesh
from ..meshes.surface_graph import edge_distances
from ..plane.polylines import along_polyline, arc_lengths
from ..remeshing.subdivision import Subdivision, with_short_edges

# A tube is at least so many times as long as wide.
_LEAST_LENGTH = 6.0
# Longest edge, relative to the width, and most vertices of a tube with edges of that length.
_EDGES, _MOST_VERTICES = 0.4, 200_000
# Least share of the area of a slice that is in one piece.
_WHOLE = 0.95
# Most rounds in which slices are made perpendicular to the line, how far places of vertices still move in the last one,
# in slices, and the share of the vertices for which that holds: a few next to bends jump back and forth forever.
_ROUNDS, _SETTLED, _MOST = 16, 0.01, 0.999
# Points of the line in a slice, and how many slices a vertex may move in a round.
_POINTS, _NEAR = 8, 1.5
# Vertices are about equally far if their distances differ by less than this share.
_TIE = 1e-9
# Vertices that are projected at once.
_CHUNK = 20_000
# Bounds of the volume relative to that of round slices.
_VOLUMES = (0.5, 1.25)


@dataclass(frozen=True)
class SlicedTube:
    """A tube, cut into slices across its center line.

    Attributes
    ----------
    divided : Subdivision
        The tube, with edges so short that it can bend.
    points : (n, 3) float64
        Points of its center line at equal distances.
    places : (v,) float64
        The point that is closest to each vertex, from 0 to n - 1, between points a fraction.
    radii : (n,) float64
        Root mean square distance of the surface from these points.
    """

    divided: Subdivision
    points: NDArray[np.float64]
    places: NDArray[np.float64]
    radii: NDArray[np.float64]


def sliced_tube(mesh: TriangleMesh, control: Control = UNINTERRUPTED) -> SlicedTube | None:
    """Return a mesh as a tube, None if it is none: if it branches, is closed to a ring, or is not long and narrow.

    Lengths along the surface from one end to the other one cut it into slices that are as thick as it is wide. The
    line through their centers tells where they are perpendicular to it, which gives better centers.

    Parameters
    ----------
    mesh : TriangleMesh
        Closed, oriented outward. Vertices without triangles are left out.
    control : Control
        Stops the work.
    """
    used, faces = used_part(mesh.faces, len(mesh.vertices))
    mesh = TriangleMesh(mesh.vertices[used], faces)
    lengths = edge_distances(mesh, 0)
    if not np.isfinite(lengths).all():
        return None
    # The first one of those that are farthest, which does not depend on rounding.
    tip = int((lengths >= (1.0 - _TIE) * lengths.max()).argmax())
    length = float(edge_distances(mesh, tip).max())
    width = mesh.area / (np.pi * length)
    if length < _LEAST_LENGTH * width:
        return None
    divided = with_short_edges(mesh, _EDGES * width, _MOST_VERTICES)
    fine = divided.mesh
    lengths = edge_distances(fine, tip)
    count = int(length / width)
    # With fewer vertices, some slices are empty.
    if count > len(fine.vertices):
        return None
    places = lengths * (count / lengths.max())
    if not _is_one_piece_everywhere(fine, places, count):
        return None
    for _ in range(_ROUNDS):
        control.check()
        line = _line(_centers(fine, places, count))
        before, places = places, 0.5 + _projected(fine.vertices, line, (places - 0.5) * _POINTS) / _POINTS
        if np.quantile(np.abs(places - before), _MOST) < _SETTLED:
            break
    # Once more with ends that reach beyond the middles of the first and the last slice.
    line = np.concatenate([_mirrored(line), line, _mirrored(line[::-1])[::-1]])
    return _checked(divided, line, _projected(fine.vertices, line, (places + 0.5) * _POINTS), mesh.volume)


def _is_one_piece_everywhere(mesh: TriangleMesh, places: NDArray[np.float64], count: int) -> bool:
    """Return whether nearly all of every slice is connected, and no slice is empty."""
    slices, areas = np.clip(places.astype(np.int64), 0, count - 1), mesh.vertex_areas
    ends = mesh_edges(mesh.faces)
    inside = ends[slices[ends[:, 0]] == slices[ends[:, 1]]]
    labels = component_labels(*inside.T, len(slices))
    pieces = np.bincount(labels, areas)
    owners = np.zeros(len(pieces), np.int64)
    owners[labels] = slices
    largest = np.zeros(count)
    np.maximum.at(largest, owners, pieces)
    return bool((largest > 0.0).all() and (largest >= _WHOLE * np.bincount(slices, areas, count)).all())


def _centers(mesh: TriangleMesh, places: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """Return the centers of slices, (count, 3).

    Vertices weigh less in a slice the farther they are from its middle, down to nothing at the middles of its
    neighbors. With slices that end abruptly, a line that should be straight would wind.
    """
    near = np.clip(places - 0.5, 0.0, count - 1.0)
    own = np.minimum(near.astype(np.int64), count - 2)
    beyond = mesh.vertex_areas * (near - own)
    rows = np.concatenate([own, own + 1])
    weights = np.concatenate([mesh.vertex_areas - beyond, beyond])
    sums = label_sums(rows, weights[:, None] * np.tile(mesh.vertices, (2, 1)), count)
    # A slice that has lost its vertices puts the line far away, and the volume tells that this is no tube.
    return sums / np.maximum(np.bincount(rows, weights, count), np.finfo(np.float64).tiny)[:, None]


def _line(centers: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points at equal distances on the smooth line through centers, (n, 3)."""
    steps = np.linalg.norm(np.diff(centers, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(np.maximum(steps, 1e-12 * steps.max()))])
    spline = CubicSpline(along, centers)
    fine = spline(np.linspace(0.0, along[-1], 8 * _POINTS * len(centers)))
    arcs = arc_lengths(fine)
    even = np.linspace(0.0, arcs[-1], _POINTS * (len(centers) - 1) + 1)
    return along_polyline(even, arcs, fine)


def _mirrored(line: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return points of a slice before the first one of a line, (n, 3), where it continues with the same curvature.

    A circle is its own mirror image in a plane across it.
    """
    tangent = -3.0 * line[0] + 4.0 * line[1] - line[2]
    tangent /= np.linalg.norm(tangent)
    after = line[_POINTS:0:-1]
    return after - 2.0 * ((after - line[0]) @ tangent)[:, None] * tangent


def _projected(
    vertices: NDArray[np.float64], line: NDArray[np.float64], places: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the places, between the points of a line, of those closest to vertices, near where they were."""
    found = np.empty(len(vertices))
    near = np.arange(-int(_NEAR * _POINTS), int(_NEAR * _POINTS) + 1)
    for own in chunks(len(vertices), _CHUNK):
        middle = np.rint(places[own]).astype(np.int64)
        rows = np.clip(middle[:, None] + near, 0, len(line) - 1)
        away = sum(np.square(vertices[own, axis, None] - line[:, axis].take(rows)) for axis in range(3))
        best = np.take_along_axis(rows, away.argmin(axis=1)[:, None], axis=1)[:, 0]
        found[own] = _between(vertices[own], line, best)
    return found


def _between(
    vertices: NDArray[np.float64], line: NDArray[np.float64], points: NDArray[np.int64]
) -> NDArray[np.float64]:
    """Return the places of vertices between the points of a line that are next to the closest ones."""
    before, after = line[np.maximum(points - 1, 0)], line[np.minimum(points + 1, len(line) - 1)]
    along = after - before
    offset = ((vertices - line[points]) * along).sum(axis=1) / np.square(along).sum(axis=1)
    inner = np.where((points == 0) | (points == len(line) - 1), 1.0, 2.0)
    return np.clip(points + inner * np.clip(offset, -0.5, 0.5), 0.0, len(line) - 1.0)


def _checked(
    divided: Subdivision, line: NDArray[np.float64], places: NDArray[np.float64], volume: float
) -> SlicedTube | None:
    """Return the tube if its slices across the line are in one piece, and as wide everywhere as its volume tells."""
    mesh, count = divided.mesh, (len(line) - 1) // _POINTS
    nodes = np.rint(places).astype(np.int64)
    # The first and the last part of the line reach beyond the mesh, and caps are around them.
    parts = np.minimum(nodes // _POINTS, count - 1)
    squares = mesh.vertex_areas * np.square(mesh.vertices - line[nodes]).sum(axis=1)
    sums = np.maximum(np.bincount(parts, mesh.vertex_areas, count), np.finfo(np.float64).tiny)
    means = (np.bincount(parts, squares, count) / sums)[1:-1]
    ends = float(places.min()), float(places.max())
    even = np.linspace(*ends, len(line))
    radii = np.sqrt(np.interp(even / _POINTS - 1.5, np.arange(len(means)), means))
    points = along_polyline(even, np.arange(len(line)), line)
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    round_volume = np.pi * float(np.square(radii).mean()) * length
    if not _VOLUMES[0] < volume / round_volume < _VOLUMES[1]:
        return None
    places = (places - ends[0]) * ((len(line) - 1) / (ends[1] - ends[0]))
    # A teapot whose handle ends freely is in one piece at every length from the handle, over the body, to the spout.
    if not _is_one_piece_everywhere(mesh, places / _POINTS, count):
        return None
    return SlicedTube(divided, points, places, radii)
