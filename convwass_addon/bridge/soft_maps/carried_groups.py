# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer vertex groups from one object to another."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.transfer import transferred_weights
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..vertex_groups import group_names, read_groups
from .map_transfer import Carried, TransferEnds, chosen_names
from .map_weights import (
    bone_names,
    deforming_groups,
    fitted_weights,
    locked_groups,
    require_group_names,
    staying_weights,
    write_weights,
)


class CarriedGroups:
    """Vertex groups to transfer.

    Parameters
    ----------
    ends : TransferEnds
        The objects to read from and to write to.

    Raises
    ------
    InputError
        The giver has no such groups, or the receiver is not writable.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        known = group_names(ends.giver)
        names = ends.destinations(known)
        nothing = InputError("{object} has no vertex groups to transfer; paint some.", object=ends.giver.name)
        chosen = chosen_names(ends, names, group_names, nothing, locked_groups)
        require_group_names(ends.receiver, list(names.values()))
        self._names, self._kept = chosen.written, chosen.kept
        weights = read_groups(ends.giver, known)
        deforming = deforming_groups(ends.giver, ends.receiver, known, weights)
        self._weights = dict(zip(known, weights, strict=True))
        self._deforming = [name for name in self._names if name in deforming]
        self._total = [name for name in known if name in deforming]
        # Locked groups limit the weights of the others, even if the giver does not have them.
        own = bone_names(ends.receiver) | {names.get(name, name) for name in deforming}
        stays = own & {*self._kept, *locked_groups(ends.receiver, group_names(ends.receiver))}
        self._fixed = staying_weights(ends.receiver, sorted(stays))
        self._result: dict[str, NDArray[np.float64]] = {}

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute all groups."""
        yield Progress(0.0, Sentence("Transferring vertex groups"))
        control.check()
        deforming = self._values(self._deforming)
        total = self._values(self._total).sum(axis=0)
        fitted = fitted_weights(deforming, total, self._fixed, self._ends.request)
        plain = [name for name in self._names if name not in self._deforming]
        self._result = dict(zip(self._deforming, fitted, strict=True)) | dict(
            zip(plain, self._values(plain), strict=True)
        )

    def _values(self, names: Sequence[str]) -> NDArray[np.float64]:
        ends = self._ends
        given = np.array([self._weights[name] for name in names]).reshape(len(names), len(ends.giver_mesh.vertices))
        return transferred_weights(ends.points, ends.giver_mesh, given, None, False)

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the groups."""
        names = list(self._names)
        if names:
            rows = np.stack([self._result[name] for name in names])
            write_weights(receiver, list(self._names.values()), rows, self._ends.points.found)
        return Carried(tuple(self._names.values()), self._kept)
