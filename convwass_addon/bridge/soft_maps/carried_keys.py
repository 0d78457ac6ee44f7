# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer shape keys from one object to another."""

from __future__ import annotations

from collections.abc import Sequence

import bpy

from ...applications.soft_maps.transfer_shapes import ShapeCarrier
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from .map_shape_keys import KeyOffsets, key_names, locked_keys, read_keys, write_keys
from .map_transfer import Carried, TransferEnds, chosen_names


class CarriedKeys:
    """Shape keys to transfer.

    Parameters
    ----------
    ends : TransferEnds
        The objects to read from and to write to.

    Raises
    ------
    InputError
        The giver has no such keys.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        names = ends.destinations(key_names(ends.giver))
        nothing = InputError("{object} has no shape keys to transfer besides its basis.", object=ends.giver.name)
        chosen = chosen_names(ends, names, key_names, nothing, locked_keys)
        self._names, self._kept = chosen.written, chosen.kept
        self._keys = read_keys(ends.giver, list(self._names))
        self._result: list[KeyOffsets] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the keys one by one."""
        ends, total = self._ends, len(self._keys)
        yield Progress(0.0, Sentence("Comparing the shapes"))
        carrier = ShapeCarrier.of(ends.points, ends.giver_mesh, ends.receiver_mesh) if self._keys else None
        for place, key in enumerate(self._keys, start=1):
            message = Sentence("Transferring shape key {done} of {total}", {"done": place, "total": total})
            yield Progress((place - 1) / total, message)
            control.check()
            offsets = carrier.carried(key.offsets)
            base = self._names.get(key.relative_to, key.relative_to)
            self._result.append(KeyOffsets(self._names[key.name], base, offsets, key.slider))

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the keys."""
        if self._result:
            write_keys(receiver, _bases_first(self._result))
        return Carried(tuple(self._names.values()), self._kept)


def _bases_first(keys: Sequence[KeyOffsets]) -> list[KeyOffsets]:
    """Return keys ordered so that every key follows the key it is relative to."""
    left, done = list(keys), []
    while left:
        names = {key.name for key in left}
        ready = [key for key in left if key.relative_to not in names] or left
        done += ready
        names -= {key.name for key in ready}
        left = [key for key in left if key.name in names]
    return done
