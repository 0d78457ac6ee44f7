# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Computing a soft map beside the user's work: reads both objects, hands arrays over, stores what comes back."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy

from ..applications.soft_maps.map_sides import MapSide
from ..applications.soft_maps.surface_maps import SurfaceMap
from ..bridge.handles import Handle
from ..bridge.mesh_checks import other_vertices
from ..bridge.soft_maps.soft_map_bytes import MappedSide, StoredSoftMap
from ..bridge.soft_maps.soft_map_store import MapState, map_state, mapped_side, store_soft_map
from ..bridge.surfaces import read_surface
from ..bridge.vertex_groups import group_names, read_groups
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from .soft_map_targets import StoredWay

Solve = Callable[[MapSide, MapSide, Control], Work[SurfaceMap]]


class _MapJob:
    """Work that ends with a map between two objects. Everything but its steps belongs on the main thread."""

    _objects: tuple[Handle, Handle]
    _mapped: tuple[MappedSide, MappedSide]
    _found: SurfaceMap | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Do the work, and keep the map."""
        self._found = yield from self._work(control)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        raise NotImplementedError

    def write(self, report: Progress[object]) -> None:
        """Leave the file as it is until the end."""

    def discard(self) -> None:
        """Forget it."""
        self._found = None

    @property
    def found(self) -> SurfaceMap:
        """The map, once it is there."""
        return self._found

    def store(self) -> tuple[bpy.types.Object, bpy.types.Object]:
        """Store the map with its source, and return both objects.

        Raises
        ------
        InputError
            An object is gone, or has other vertices or faces than when the work began.
        """
        source, target = (handle.find() for handle in self._objects)
        if source is None or target is None:
            raise InputError("An object was deleted, or undone, while its soft map was computed; start again.")
        for obj, side in zip((source, target), self._mapped, strict=True):
            require_same_mesh(obj, side)
        store_soft_map(source, target, StoredSoftMap(self._found, *self._mapped))
        return source, target


class SoftMapJob(_MapJob):
    """One soft map that is being computed.

    Parameters
    ----------
    context : bpy.types.Context
        For the objects as modifiers leave them.
    source, target : bpy.types.Object
        Meshes; they may be the same one.
    groups : sequence of str
        Names of vertex groups that both have and that take part.
    solve : callable
        ``solve(source, target, control)`` returns the work; it touches nothing of Blender.

    Raises
    ------
    InputError
        No meshes, or ones without a surface.
    """

    def __init__(
        self,
        context: bpy.types.Context,
        source: bpy.types.Object,
        target: bpy.types.Object,
        groups: Sequence[str],
        solve: Solve,
    ) -> None:
        self._solve = solve
        depsgraph = context.evaluated_depsgraph_get()
        readings = [read_surface(obj, depsgraph) for obj in (source, target)]
        self.ignored = tuple(dict.fromkeys(name for reading in readings for name in reading.ignored))
        self._objects = (Handle.of("objects", source), Handle.of("objects", target))
        self._sides, mapped = [], []
        for obj, reading in zip((source, target), readings, strict=True):
            weights = dict(zip(groups, read_groups(obj, groups), strict=True)) if groups else {}
            self._sides.append(MapSide(reading.mesh, obj.name, weights))
            mapped.append(mapped_side(obj, reading.mesh.faces))
        self._mapped = tuple(mapped)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        return self._solve(*self._sides, control)


class RepairJob(_MapJob):
    """A stored map that is being mended.

    Parameters
    ----------
    way : StoredWay
        The map.
    mend : callable
        ``mend(control)`` returns the work; it touches nothing of Blender.
    """

    def __init__(self, way: StoredWay, mend: Callable[[Control], Work[SurfaceMap]]) -> None:
        self.before, self._mend = way.stored.found, mend
        self.names = (way.source.name, way.target.name)
        self._objects = (Handle.of("objects", way.source), Handle.of("objects", way.target))
        self._mapped = (way.stored.source, way.stored.target)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        return self._mend(control)


def require_same_mesh(obj: bpy.types.Object, side: MappedSide) -> None:
    """Refuse an object that has other vertices or faces than when the work on it began; raises InputError."""
    if map_state(obj, side) is MapState.OTHER:
        raise other_vertices(obj)


def equal_groups(source: bpy.types.Object, target: bpy.types.Object) -> list[str]:
    """Return the names of vertex groups that both objects have."""
    return [name for name in group_names(source) if name in target.vertex_groups]
