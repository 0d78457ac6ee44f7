# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer data from one object to another along a map: read first, computed in the background, written at the end.

Nothing is written before everything has been computed and checked.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Protocol

import bpy

from ...applications.soft_maps.surface_maps import PointMap
from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control, Work, as_part
from ...sentence import Sentence
from ..files.blend_files import listed_names
from .soft_map_requests import TransferRequest


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
    request : TransferRequest
        How; on one mesh, names with a side, such as Arm.L, always change sides.
    """

    giver: bpy.types.Object
    receiver: bpy.types.Object
    points: PointMap
    giver_mesh: TriangleMesh
    receiver_mesh: TriangleMesh
    names: tuple[str, ...]
    request: TransferRequest

    @property
    def is_backward(self) -> bool:
        """Return whether data goes from the target of the map to its source; on one mesh, from right to left."""
        return self.request.direction == "BACKWARD"

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
        return flipped if self.request.flip_names else {name: name for name in chosen}


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
        yield from as_part(part.steps(control), place, len(parts))
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


@dataclass(frozen=True)
class ChosenNames:
    """Names of what is written, those on the receiver by those on the giver, and names that the receiver keeps."""

    written: dict[str, str]
    kept: tuple[str, ...]


def chosen_names(
    ends: TransferEnds,
    names: dict[str, str],
    known: Callable[[bpy.types.Object], list[str]],
    nothing: InputError,
    locked: Callable[[bpy.types.Object, Sequence[str]], list[str]] | None = None,
) -> ChosenNames:
    """Choose what to write among data of one kind, of which there must be some.

    Parameters
    ----------
    ends : TransferEnds
        The objects.
    names : dict of str to str
        The names on the receiver of what is to be transferred, by those on the giver.
    known : callable
        Returns the names of all data of the kind that an object has.
    nothing : InputError
        The error if the giver has no such data.
    locked : callable, optional
        Returns which of some names an object has locked.

    Raises
    ------
    InputError
        There is no such data, none of the requested name, or none that can be mirrored.
    """
    if not names:
        raise _refusal(ends, known(ends.giver), nothing)
    there = set(locked(ends.receiver, list(names.values()))) if locked else set()
    if ends.request.existing == "KEEP":
        there.update(known(ends.receiver))
    kept = tuple(name for name in names.values() if name in there)
    return ChosenNames({name: own for name, own in names.items() if own not in there}, kept)


def _refusal(ends: TransferEnds, known: Sequence[str], nothing: InputError) -> InputError:
    """Return the error for a transfer of nothing, given all data of one kind that the giver has."""
    if not known:
        return nothing
    if not any(name in known for name in ends.names or known):
        return InputError(
            "{object} has no {names} to transfer; it has: {known}.",
            object=ends.giver.name,
            names=", ".join(ends.names),
            known=listed_names(known),
        )
    return InputError(
        "{object} has nothing to mirror among {known}; names need the side that is mirrored, such as {example}.",
        object=ends.giver.name,
        known=listed_names(ends.names or known),
        example="Arm.R" if ends.is_backward else "Arm.L",
    )
