# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compute a soft map in the background, and store it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import bpy

from ..applications.soft_maps.map_sides import MapSide
from ..applications.soft_maps.surface_maps import SurfaceMap
from ..bridge.handles import Handle
from ..bridge.mesh_checks import other_vertices
from ..bridge.soft_maps.mapped_meshes import map_side
from ..bridge.soft_maps.soft_map_bytes import MappedSide, StoredSoftMap
from ..bridge.soft_maps.soft_map_store import MapState, map_state, mapped_side, store_soft_map
from ..bridge.surfaces import ignored_notices, read_surface
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work
from ..sentence import Sentence
from .background import Job
from .soft_map_targets import StoredWay

Solve = Callable[[MapSide, MapSide, Control], Work[SurfaceMap]]


class _MapJob(Job):
    """Base of jobs that produce a map between two objects. Everything except the steps must run on the main thread."""

    _objects: tuple[Handle, Handle]
    _mapped: tuple[MappedSide, MappedSide]
    found: SurfaceMap | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Compute the map and keep it."""
        self.found = yield from self._work(control)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        raise NotImplementedError

    def discard(self) -> None:
        """Discard the map."""
        self.found = None

    def store(self) -> tuple[bpy.types.Object, bpy.types.Object]:
        """Store the map with its source, and return both objects.

        Raises
        ------
        InputError
            An object was deleted, or its vertices or faces have changed since the start.
        """
        source, target = (handle.find() for handle in self._objects)
        if source is None or target is None:
            raise InputError("An object was deleted, or its creation undone, during the computation; start again.")
        for obj, side in zip((source, target), self._mapped, strict=True):
            require_same_mesh(obj, side)
        store_soft_map(source, target, StoredSoftMap(self.found, *self._mapped))
        return source, target


class SoftMapJob(_MapJob):
    """Computes a soft map.

    Parameters
    ----------
    source, target : bpy.types.Object
        Meshes, possibly identical.
    groups : sequence of str
        Names of vertex groups on both objects to use.
    solve : callable
        ``solve(source, target, control)`` returns the work; it does not access Blender's data.

    Raises
    ------
    InputError
        An object is not a mesh, or has no surface.
    """

    def __init__(
        self,
        source: bpy.types.Object,
        target: bpy.types.Object,
        groups: Sequence[str],
        solve: Solve,
    ) -> None:
        self._solve = solve
        depsgraph = bpy.context.evaluated_depsgraph_get()
        readings = [read_surface(obj, depsgraph) for obj in (source, target)]
        self.remarks = ignored_notices(readings)
        self._objects = (Handle.of("objects", source), Handle.of("objects", target))
        self._sides, mapped = [], []
        for obj, reading in zip((source, target), readings, strict=True):
            self._sides.append(map_side(obj, reading, groups))
            mapped.append(mapped_side(obj, reading.mesh.faces))
        self._mapped = tuple(mapped)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        return self._solve(*self._sides, control)


class RepairJob(_MapJob):
    """Repairs a stored map.

    Parameters
    ----------
    way : StoredWay
        The map.
    mend : callable
        ``mend()`` returns the repaired map; it does not access Blender's data.
    """

    def __init__(self, way: StoredWay, mend: Callable[[], SurfaceMap]) -> None:
        self.before, self._mend = way.stored.found, mend
        self.names = (way.source.name, way.target.name)
        self._objects = (Handle.of("objects", way.source), Handle.of("objects", way.target))
        self._mapped = (way.stored.source, way.stored.target)

    def _work(self, control: Control) -> Work[SurfaceMap]:
        yield Progress(0.0, Sentence("Repairing the map"))
        control.check()
        return self._mend()


def require_same_mesh(obj: bpy.types.Object, side: MappedSide) -> None:
    """Raise InputError if the vertices or faces of an object have changed since the work began."""
    if map_state(obj, side) is MapState.OTHER:
        raise other_vertices(obj)
