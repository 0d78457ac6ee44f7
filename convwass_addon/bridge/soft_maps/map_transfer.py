# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer data from one object to another along a map: read first, computed in the background, written at the end.

Nothing is written before everything has been computed and checked.
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
from ..blend_files import listed_names


@dataclass(frozen=True)
class TransferEnds:
    """Two objects and what is transferred from one to the other: to the target of their map, or back to its source.

    Attributes
    ----------
    giver, receiver : bpy.types.Object
        Mesh objects to read from and to write to; the same object twice for a map of a mesh to its mirror image.
    points : PointMap
        A point on the giver for every vertex of the receiver.
    giver_mesh, receiver_mesh : TriangleMesh
        Both meshes in world space, without modifiers and shape keys, with the triangles of the map.
    names : tuple of str
        Names to transfer, of each kind; empty for all.
    keep : bool
        Whether existing data of the receiver is kept; locked groups and keys are always kept.
    flip : bool
        Whether names with a side, such as Arm.L, change sides; always true for a map of a mesh to itself.
    is_backward : bool
        For a map of a mesh to itself: from right to left.
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
        """Return whether data is transferred to the mirror image on the same mesh."""
        return self.giver == self.receiver

    def destinations(self, known: Sequence[str]) -> dict[str, str]:
        """Return the names under which data of the giver is written."""
        chosen = [name for name in known if not self.names or name in self.names]
        flipped = {name: bpy.utils.flip_name(name) for name in chosen}
        if self.is_mirror:
            # Left sorts before right in all naming schemes.
            return {
                name: other
                for name, other in flipped.items()
                if (self.names and other != name) or (name > other if self.is_backward else name < other)
            }
        return flipped if self.flip else {name: name for name in chosen}


@dataclass(frozen=True)
class Carried:
    """Written and kept data.

    Attributes
    ----------
    written, kept : tuple of str
        Names on the receiver.
    notices : tuple of Sentence
        Messages for the user.
    """

    written: tuple[str, ...]
    kept: tuple[str, ...] = ()
    notices: tuple[Sentence, ...] = ()


class CarriedPart(Protocol):
    """One kind of data to transfer."""

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the result without accessing Blender's data."""

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the result."""


def all_carried(parts: Collection[CarriedPart], control: Control = UNINTERRUPTED) -> Work[None]:
    """Compute all parts in order."""
    for place, part in enumerate(parts):
        yield from within(part.steps(control), place / len(parts), (place + 1) / len(parts))
        control.check()


def require_names(giver: bpy.types.Object, known: Sequence[str], names: Sequence[str]) -> None:
    """Check that names belong to some of the data to be transferred.

    Parameters
    ----------
    giver : bpy.types.Object
        The object to read from.
    known : sequence of str
        The data that it has, of all kinds to be transferred.
    names : sequence of str
        The names to check.

    Raises
    ------
    InputError
        A name is unknown. Without any data, nothing is checked: that has messages of its own.
    """
    unknown = [name for name in names if name not in known]
    if known and unknown:
        raise InputError(
            "{object} has no {names} to transfer; it has: {known}.",
            object=giver.name,
            names=unknown[0],
            known=listed_names(known),
        )


def require_any(
    ends: TransferEnds, known: Sequence[str], names: Mapping[str, str] | Sequence[str], nothing: InputError
) -> None:
    """Check that something is transferred.

    Parameters
    ----------
    ends : TransferEnds
        The objects.
    known : sequence of str
        All data of one kind that the giver has.
    names : mapping or sequence of str
        The names to transfer among them.
    nothing : InputError
        The error if the giver has no such data.

    Raises
    ------
    InputError
        There is no such data, none of the requested name, or none that can be mirrored.
    """
    if names:
        return
    if not known:
        raise nothing
    if not any(name in known for name in ends.names or known):
        raise InputError(
            "{object} has no {names} to transfer; it has: {known}.",
            object=ends.giver.name,
            names=", ".join(ends.names),
            known=listed_names(known),
        )
    raise InputError(
        "{object} has nothing to mirror among {known}; names need the side that is mirrored, such as {example}.",
        object=ends.giver.name,
        known=listed_names(ends.names or known),
        example="Arm.R" if ends.is_backward else "Arm.L",
    )


def kept_names(
    ends: TransferEnds,
    names: Mapping[str, str],
    locked: Callable[[bpy.types.Object, Sequence[str]], list[str]],
    known: Callable[[bpy.types.Object], list[str]],
) -> tuple[str, ...]:
    """Return the names on the receiver that must not be written."""
    wanted = list(names.values())
    there = set(locked(ends.receiver, wanted)) | (set(known(ends.receiver)) if ends.keep else set())
    return tuple(name for name in wanted if name in there)
