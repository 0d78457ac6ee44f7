# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transfer color attributes and UV maps from one object to another."""

from __future__ import annotations

from collections.abc import Callable

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.soft_maps.transfer import transferred_corner_values, transferred_values
from ...applications.soft_maps.transfer_uvs import TransferredUvs, transferred_uvs
from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..color_attributes import color_kind, color_names, is_per_corner, read_colors, require_color_name, write_colors
from ..uv_maps import mark_seams, read_uvs, require_uv_names, uv_names, write_uvs
from .map_corners import triangle_loops, triangle_polygons
from .map_transfer import Carried, ChosenNames, TransferEnds, chosen_names


class CarriedColors:
    """Color attributes to transfer.

    Parameters
    ----------
    ends : TransferEnds
        The objects to read from and to write to.

    Raises
    ------
    InputError
        The giver has none, or the name is used for something else on the receiver.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        giver = ends.giver
        nothing = InputError("{object} has no color attributes to transfer.", object=giver.name)
        chosen = _chosen_layers(ends, color_names, nothing)
        self._kept = chosen.kept
        self._kinds = {name: color_kind(giver, name) for name in chosen.written}
        self._colors = {name: read_colors(giver, name) for name in chosen.written}
        for name in chosen.written:
            require_color_name(ends.receiver, name)
        corners = [name for name in chosen.written if is_per_corner(giver, name)]
        if corners:
            loops = triangle_loops(giver, ends.giver_mesh.faces)
            self._colors |= {name: self._colors[name][loops] for name in corners}
        self._result: dict[str, NDArray[np.float64]] = {}

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the attributes one by one."""
        yield Progress(0.0, Sentence("Transferring color attributes"))
        points, mesh = self._ends.points, self._ends.giver_mesh
        for name, colors in self._colors.items():
            control.check()
            is_corner = colors.ndim == 3
            self._result[name] = (
                transferred_corner_values(points, colors) if is_corner else transferred_values(points, mesh, colors)
            )
            # Opaque black.
            self._result[name][~points.found] = (0.0, 0.0, 0.0, 1.0)

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the attributes."""
        for name, colors in self._result.items():
            write_colors(receiver, name, colors, self._kinds[name])
        return Carried(tuple(self._result), self._kept)


class CarriedUvs:
    """UV maps to transfer.

    Parameters
    ----------
    ends : TransferEnds
        The objects to read from and to write to.

    Raises
    ------
    InputError
        The giver has none, or the receiver cannot have more.
    """

    def __init__(self, ends: TransferEnds) -> None:
        self._ends = ends
        giver, receiver = ends.giver, ends.receiver
        nothing = InputError("{object} has no UV maps to transfer; unwrap it first.", object=giver.name)
        chosen = _chosen_layers(ends, uv_names, nothing)
        self._kept = chosen.kept
        require_uv_names(receiver, list(chosen.written))
        loops = triangle_loops(giver, ends.giver_mesh.faces)
        self._given = {name: read_uvs(giver, name)[loops] for name in chosen.written}
        self._loops, self._polygons = triangle_loops(receiver, ends.receiver_mesh.faces), triangle_polygons(receiver)
        self._result: dict[str, TransferredUvs] = {}

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the maps one by one."""
        ends = self._ends
        for done, (name, given) in enumerate(self._given.items()):
            yield Progress(done / len(self._given), Sentence("Transferring UV map {name}", {"name": name}))
            control.check()
            self._result[name] = transferred_uvs(
                ends.points, ends.giver_mesh, given, ends.receiver_mesh, self._polygons
            )

    def write(self, receiver: bpy.types.Object) -> Carried:
        """Write the maps, and mark their seams."""
        for name, found in self._result.items():
            write_uvs(receiver, name, self._loops.ravel(), found.uvs.reshape(-1, 2))
            mark_seams(receiver, found.seams)
        notices = tuple(notice for found in self._result.values() for notice in found.notices)
        return Carried(tuple(self._result), self._kept, notices)


def _chosen_layers(
    ends: TransferEnds, known: Callable[[bpy.types.Object], list[str]], nothing: InputError
) -> ChosenNames:
    """Choose layers of the giver, which keep their names; raises `nothing` if there are none."""
    names = {name: name for name in known(ends.giver) if not ends.names or name in ends.names}
    return chosen_names(ends, names, known, nothing)
