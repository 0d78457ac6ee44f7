# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What is carried from one object to another along a map: read at first, computed beside, written at the end.

Nothing is written before all of it has been computed, and all that could be refused has been.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import bpy

from ...applications.soft_maps.surface_maps import PointMap
from ...errors import InputError
from ...geometry.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Work, within
from ...sentence import Sentence


@dataclass(frozen=True)
class TransferEnds:
    """From where to where something is carried, and what of it.

    Attributes
    ----------
    giver, receiver : bpy.types.Object
        Mesh objects; of a map of a mesh to its mirror image one and the same.
    points : PointMap
        A point of the giver for every vertex of the receiver.
    giver_mesh, receiver_mesh : TriangleMesh
        Both without modifiers and shape keys, world space, with the triangles that the map counts.
    names : tuple of str
        What is carried, of each kind; empty for all.
    keep : bool
        Whether what the receiver has already stays; locked groups and keys always do.
    flip : bool
        Whether names with a side, such as Arm.L, get the other one. Of a mesh to itself they always do.
    is_backward : bool
        Of a mesh to itself: from right to left.
    """

    giver: bpy.types.Object
    receiver: bpy.types.Object
    points: PointMap
    giver_mesh: TriangleMesh
    receiver_mesh: TriangleMesh
    names: tuple[str, ...] = ()
    keep: bool = False
    flip: bool = False
    is_backward: bool = False

    @property
    def is_mirror(self) -> bool:
        """Whether something is carried to the mirror image on the same mesh."""
        return self.giver == self.receiver

    def destinations(self, known: Sequence[str]) -> dict[str, str]:
        """Return, for the names of the giver that are carried, those under which they are written."""
        chosen = [name for name in known if not self.names or name in self.names]
        flipped = {name: bpy.utils.flip_name(name) for name in chosen}
        if self.is_mirror:
            # Left comes before right in every way of writing it.
            return {
                name: other
                for name, other in flipped.items()
                if (self.names and other != name) or (name > other if self.is_backward else name < other)
            }
        return flipped if self.flip else {name: name for name in chosen}


@dataclass(frozen=True)
class Carried:
    """What has been written, and what has stayed as it was.

    Attributes
    ----------
    written, kept : tuple of str
        Names at the receiver.
    notices : tuple of Sentence
        What the user should know.
    """

    written: tuple[str, ...]
    kept: tuple[str, ...] = ()
    notices: tuple[Sentence, ...] = ()


class CarriedPart(Protocol):
    """One kind of what is carried from one object to the other."""

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute it, and touch nothing of Blender."""

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write what has been computed."""


def all_carried(parts: Collection[CarriedPart], control: Control = UNINTERRUPTED) -> Work[None]:
    """Compute all parts, one after the other."""
    for place, part in enumerate(parts):
        yield from within(part.steps(control), place / len(parts), (place + 1) / len(parts))
        control.check()


def require_any(names: Mapping[str, str] | Sequence[str], error: InputError) -> None:
    """Raise an error where there is nothing to carry."""
    if not names:
        raise error


def kept_names(
    ends: TransferEnds,
    names: Mapping[str, str],
    locked: Callable[[bpy.types.Object, Sequence[str]], list[str]],
    known: Callable[[bpy.types.Object], list[str]],
) -> tuple[str, ...]:
    """Return the names at the receiver that are not to be written."""
    wanted = list(names.values())
    there = set(locked(ends.receiver, wanted)) | (set(known(ends.receiver)) if ends.keep else set())
    return tuple(name for name in wanted if name in there)
