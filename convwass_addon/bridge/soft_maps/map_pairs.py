# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of vertices that belong together, from names: of vertex groups, and of Empties that stand on both surfaces."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

import bpy
import numpy as np
from numpy.typing import NDArray

from ...geometry.mesh import TriangleMesh
from ..surfaces import surface_mesh
from ..vertex_groups import group_names, read_groups

# What Blender appends to names that are taken.
_SUFFIX = re.compile(r"\.\d{3,}$")


@dataclass(frozen=True)
class MapPair:
    """A vertex of the source and one of the target.

    Attributes
    ----------
    name : str
        What the user calls them.
    source, target : int
        Their numbers.
    """

    name: str
    source: int
    target: int


@dataclass(frozen=True)
class FoundPairs:
    """Pairs, and what has made none.

    Attributes
    ----------
    pairs : tuple of MapPair
        In the order of the source's names.
    left_out : tuple of str
        Names that fit but are ambiguous, empty, or there on one side only.
    """

    pairs: tuple[MapPair, ...]
    left_out: tuple[str, ...] = ()


def pairs_from_groups(
    source: bpy.types.Object,
    target: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    pattern: str = "*",
    largest: float = 0.05,
) -> FoundPairs:
    """Make a pair of every two vertex groups of the same name, in the middle of each.

    Parameters
    ----------
    source, target : bpy.types.Object
        Meshes. Of a mesh and itself groups are paired with those of the other side: "Hand.L" with "Hand.R".
    depsgraph : bpy.types.Depsgraph
        Of the scene.
    pattern : str
        Names that count, with ``*`` and ``?`` as in file names.
    largest : float
        Share of the vertices that a group may have; larger ones are no marks, but weights of bones.

    Raises
    ------
    InputError
        Not a mesh, or one without a surface.
    """
    partners = {name: _partner(name, source is target) for name in group_names(source) if fnmatchcase(name, pattern)}
    in_both = [name for name, other in partners.items() if other and other in target.vertex_groups]
    if not in_both:
        return FoundPairs((), tuple(partners))
    first = _middles(source, in_both, depsgraph, largest)
    second = _middles(target, [partners[name] for name in in_both], depsgraph, largest)
    return _paired({name: first.get(name) for name in in_both}, {name: second.get(partners[name]) for name in in_both})


def pairs_from_empties(
    source: bpy.types.Object,
    target: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    empties: Iterable[bpy.types.Object],
) -> FoundPairs:
    """Make a pair of every two Empties of the same name, but for suffixes such as .001, of the vertices next to them.

    An Empty belongs to the object that it is parented to, also by way of others, or else to that whose surface is
    nearer.

    Parameters
    ----------
    source, target : bpy.types.Object
        Meshes. Of a mesh and itself Empties are paired with those of the other side: "Hand.L" with "Hand.R".
    depsgraph : bpy.types.Depsgraph
        Of the scene.
    empties : iterable of bpy.types.Object
        Other objects among them are left out.

    Raises
    ------
    InputError
        Not a mesh, or one without a surface.
    """
    meshes = {obj: surface_mesh(obj, depsgraph) for obj in dict.fromkeys((source, target))}
    vertices: dict[bpy.types.Object, dict[str, int | None]] = {obj: {} for obj in meshes}
    for empty in (obj for obj in empties if obj.type == "EMPTY"):
        place = np.array(empty.evaluated_get(depsgraph).matrix_world.translation, dtype=np.float64)
        nearest = {obj: _nearest(mesh, place) for obj, mesh in meshes.items()}
        distances = {obj: np.linalg.norm(meshes[obj].vertices[vertex] - place) for obj, vertex in nearest.items()}
        owner = _ancestor(empty, meshes) or min(distances, key=distances.get)
        name = _SUFFIX.sub("", empty.name)
        # Two of a name on one surface say nothing.
        vertices[owner][name] = None if name in vertices[owner] else nearest[owner]
    if source is not target:
        return _paired(vertices[source], vertices[target])
    own = vertices[source]
    return _paired(own, {name: own.get(_partner(name, True)) for name in own})


def _partner(name: str, is_mirrored: bool) -> str:
    """Return the name to look for on the other side; empty where a mirrored name has no sides, or is the second."""
    if not is_mirrored:
        return name
    flipped = bpy.utils.flip_name(name)
    return flipped if name < flipped else ""


def _paired(first: Mapping[str, int | None], second: Mapping[str, int | None]) -> FoundPairs:
    """Pair vertices by their names; None stands for those that say nothing."""
    names = list(dict.fromkeys([*first, *second]))
    made = {name for name in names if first.get(name) is not None and second.get(name) is not None}
    pairs = tuple(MapPair(name, first[name], second[name]) for name in names if name in made)
    return FoundPairs(pairs, tuple(name for name in names if name not in made))


def _middles(
    obj: bpy.types.Object, names: list[str], depsgraph: bpy.types.Depsgraph, largest: float
) -> dict[str, int | None]:
    """Return the vertex of each group that is nearest to the middle of its weights; None for empty and large ones."""
    mesh = surface_mesh(obj, depsgraph)
    used = np.zeros(len(mesh.vertices), bool)
    used[mesh.faces] = True
    found: dict[str, int | None] = {}
    for name, weights in zip(names, read_groups(obj, names), strict=True):
        own = np.flatnonzero((weights > 0) & used)
        # A handful of vertices is a mark on meshes of any size.
        found[name] = _middle(mesh, own, weights) if 0 < len(own) <= max(largest * used.sum(), 4) else None
    return found


def _middle(mesh: TriangleMesh, own: NDArray[np.int64], weights: NDArray[np.float64]) -> int:
    points = mesh.vertices[own]
    center = np.average(points, axis=0, weights=weights[own])
    return int(own[np.linalg.norm(points - center, axis=1).argmin()])


def _nearest(mesh: TriangleMesh, place: NDArray[np.float64]) -> int:
    used = np.unique(mesh.faces)
    return int(used[np.linalg.norm(mesh.vertices[used] - place, axis=1).argmin()])


def _ancestor(obj: bpy.types.Object, wanted: Mapping[bpy.types.Object, object]) -> bpy.types.Object | None:
    """Return the first of the wanted objects that an object is parented to, also by way of others."""
    parent = obj.parent
    while parent is not None and parent not in wanted:
        parent = parent.parent
    return parent
