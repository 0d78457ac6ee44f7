# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The order in which to repeat bakes of which some use what others have made, such as a player, as a shape."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import bpy

from ...errors import ConvwassError
from ..shape_sources import instanced_parts, shows_collection
from .changes import changed_inputs
from .results import bake_of
from .stored import refusing_damage
from .stored_parts import stored_parts

Bake = bpy.types.Collection | bpy.types.Object


def in_order(bakes: Sequence[Bake]) -> list[Bake]:
    """Return bakes such that each comes after those that have made its shapes."""
    ordered: dict[Bake, None] = {}
    begun: set[Bake] = set()

    def add(bake: Bake) -> None:
        if bake in begun:
            return
        begun.add(bake)
        for source in _sources(bake):
            add(source)
        ordered[bake] = None

    for bake in bakes:
        add(bake)
    wanted = set(bakes)
    return [bake for bake in ordered if bake in wanted]


def outdated(ordered: Sequence[Bake]) -> list[Bake]:
    """Return which bakes, given `in_order`, have changed shapes, or shapes that will change with other bakes."""
    found: dict[Bake, None] = {}
    for bake in ordered:
        if changed_inputs(bake) or any(source in found for source in _sources(bake)):
            found[bake] = None
    return list(found)


def _sources(bake: Bake) -> list[Bake]:
    """Return the bakes that have made shapes of a bake; none if its shapes are unknown."""
    try:
        with refusing_damage(bake.name):
            made = map(bake_of, _seen(stored_parts(bake)))
            return [source for source in dict.fromkeys(made) if source not in (None, bake)]
    except ConvwassError:
        # Reported where the bake is repeated.
        return []


def _seen(parts: Iterable[bpy.types.Object]) -> Iterator[bpy.types.Object]:
    """Yield the objects of shapes, and those that instances of collections show."""
    for part in parts:
        yield part
        if shows_collection(part):
            yield from _seen(instanced_parts(part))
