# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Pairs of corresponding vertices by name: of vertex groups, and of Empties on both surfaces."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from fnmatch import fnmatchcase

import bpy

from ..surface_marks import empty_marks, group_marks
from ..vertex_groups import group_names


@dataclass(frozen=True)
class MapPair:
    """A vertex of the source and a vertex of the target.

    Attributes
    ----------
    name : str
        Name of the pair in the user interface.
    source, target : int
        Indices of the vertices.
    """

    name: str
    source: int
    target: int


@dataclass(frozen=True)
class FoundPairs:
    """Pairs, and names without a pair.

    Attributes
    ----------
    pairs : tuple of MapPair
        In the order of the source's names.
    left_out : tuple of str
        Matching names that are ambiguous, empty, or on one side only.
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
    """Create a pair for all vertex groups of the same name, at the center of each.

    Parameters
    ----------
    source, target : bpy.types.Object
        Meshes. Of a mesh and itself groups are paired with those of the other side: "Hand.L" with "Hand.R".
    depsgraph : bpy.types.Depsgraph
        Dependency graph of the scene.
    pattern : str
        Patterns of names, with ``*`` and ``?`` as in file names.
    largest : float
        Maximum fraction of the vertices in a group; larger groups are weights of bones, not marks.

    Raises
    ------
    InputError
        Not a mesh, or a mesh without a surface.
    """
    partners = {name: _partner(name, source is target) for name in group_names(source) if fnmatchcase(name, pattern)}
    in_both = [name for name, other in partners.items() if other and other in target.vertex_groups]
    if not in_both:
        return FoundPairs((), tuple(partners))
    first = group_marks(source, in_both, depsgraph, largest)
    second = group_marks(target, [partners[name] for name in in_both], depsgraph, largest)
    return _paired({name: first.get(name) for name in in_both}, {name: second.get(partners[name]) for name in in_both})


def pairs_from_empties(
    source: bpy.types.Object,
    target: bpy.types.Object,
    depsgraph: bpy.types.Depsgraph,
    empties: Iterable[bpy.types.Object],
) -> FoundPairs:
    """Create a pair for all Empties of the same name, ignoring suffixes such as .001, from the nearest vertices.

    An Empty belongs to the object that it is parented to, also by way of others, or else to that whose surface is
    nearer.

    Parameters
    ----------
    source, target : bpy.types.Object
        Meshes. Of a mesh and itself Empties are paired with those of the other side: "Hand.L" with "Hand.R".
    depsgraph : bpy.types.Depsgraph
        Dependency graph of the scene.
    empties : iterable of bpy.types.Object
        Other objects are ignored.

    Raises
    ------
    InputError
        Not a mesh, or a mesh without a surface.
    """
    vertices = empty_marks((source, target), depsgraph, empties)
    if source is not target:
        return _paired(vertices[source], vertices[target])
    own = vertices[source]
    return _paired(own, {name: own.get(_partner(name, True)) for name in own})


def _partner(name: str, is_mirrored: bool) -> str:
    """Return the name to look for on the other side; empty if a mirrored name has no side, or is the second one."""
    if not is_mirrored:
        return name
    flipped = bpy.utils.flip_name(name)
    return flipped if name < flipped else ""


def _paired(first: Mapping[str, int | None], second: Mapping[str, int | None]) -> FoundPairs:
    """Pair vertices by name; None marks vertices to be ignored."""
    names = list(dict.fromkeys([*first, *second]))
    made = {name for name in names if first.get(name) is not None and second.get(name) is not None}
    pairs = tuple(MapPair(name, first[name], second[name]) for name in names if name in made)
    return FoundPairs(pairs, tuple(name for name in names if name not in made))
