# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Points of several shapes that a user says belong together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ..soft_maps.map_pairs import checked_pairs
from ..soft_maps.map_sides import MapSide

Guide = Mapping[int, int]
"""Points that belong together: for some of the shapes, by their numbers, a vertex of each."""


def check_guides(guides: Sequence[Guide], shapes: Sequence[TriangleMesh], names: Sequence[str]) -> None:
    """Refuse guides that cannot be used.

    Raises
    ------
    InputError
        A guide that names fewer than two shapes or shapes that do not exist; numbers that are no vertices, vertices
        that no face uses, or a vertex in several guides.
    """
    for guide in guides:
        unknown = [shape for shape in guide if not 0 <= shape < len(shapes)]
        if unknown:
            raise InputError(
                "A guide names shape {shape}, but there are {count} shapes.", shape=unknown[0], count=len(shapes)
            )
        if len(guide) < 2:
            raise InputError("A guide joins points of at least two shapes; mark the same point on another shape, too.")
    for shape, (mesh, name) in enumerate(zip(shapes, names, strict=True)):
        vertices = [guide[shape] for guide in guides if shape in guide]
        # Paired with themselves, to have what is said about one shape said once.
        side = MapSide(mesh, name)
        if len(set(vertices)) < len(vertices):
            twice = next(vertex for vertex in vertices if vertices.count(vertex) > 1)
            raise InputError(
                "Vertex {vertex} of {name} is in {count} pairs; keep one of them.",
                vertex=twice,
                name=name,
                count=vertices.count(twice),
            )
        checked_pairs([(vertex, vertex) for vertex in vertices], side, side)


def guide_vertices(guides: Sequence[Guide], shape: int) -> NDArray[np.int64]:
    """Return the vertices of one shape that guides name, (k,)."""
    return np.array(sorted(guide[shape] for guide in guides if shape in guide), np.int64)


def guide_pairs(guides: Sequence[Guide], one: int, other: int) -> NDArray[np.int64]:
    """Return the pairs of vertices, (k, 2), that guides make of two shapes."""
    found = [(guide[one], guide[other]) for guide in guides if one in guide and other in guide]
    return np.array(sorted(found), np.int64).reshape(-1, 2)
