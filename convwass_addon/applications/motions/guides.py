# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides: corresponding points of several shapes, chosen by the user."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ..soft_maps.map_pairs import checked_pairs
from ..soft_maps.map_sides import MapSide

Guide = Mapping[int, int]
"""Points that belong together: for some of the shapes, by their numbers, a vertex of each."""


def check_guides(guides: Sequence[Guide], shapes: Sequence[TriangleMesh], names: Sequence[str]) -> None:
    """Check guides.

    Raises
    ------
    InputError
        A guide on fewer than two shapes, or on a shape that does not exist; invalid vertices, vertices that no face
        uses, or a vertex in several guides.
    """
    for guide in guides:
        unknown = [shape for shape in guide if not 0 <= shape < len(shapes)]
        if unknown:
            raise InputError(
                "A guide names shape {shape}, but there are {count} shapes.", shape=unknown[0], count=len(shapes)
            )
        if len(guide) < 2:
            raise InputError(
                "A guide connects points of at least two shapes; mark the same point on another shape, too."
            )
    for shape, (mesh, name) in enumerate(zip(shapes, names, strict=True)):
        vertices = [guide[shape] for guide in guides if shape in guide]
        # Paired with itself, so that messages about one shape appear once.
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
    """Return the vertices of one shape that are in guides, (k,)."""
    return np.array(sorted(guide[shape] for guide in guides if shape in guide), np.int64)


def guide_pairs(guides: Sequence[Guide], one: int, other: int) -> NDArray[np.int64]:
    """Return the pairs of vertices of two shapes, (k, 2), that are in the same guide."""
    found = [(guide[one], guide[other]) for guide in guides if one in guide and other in guide]
    return np.array(sorted(found), np.int64).reshape(-1, 2)
