# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Detect when the inputs of a live morph are edited or deleted."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import bpy

from ..element_values import element_values
from ..handles import Handle, found, found_or_none
from ..morphs.changes import signature
from ..shape_sources import ShapeSource
from ..visibility import objects_in_scenes


class InputWatch:
    """Watches the objects of some shapes while it is registered.

    Parameters
    ----------
    sources : sequence of ShapeSource
        The shapes to watch.
    """

    def __init__(self, sources: Sequence[ShapeSource]) -> None:
        objects = [obj for source in sources for obj in {source.root: None, **dict.fromkeys(source.parts)}]
        self._names = [obj.name for obj in objects]
        self._objects = [Handle.of("objects", obj) for obj in objects]
        self._roots = [Handle.of("objects", source.root) for source in sources]
        self._updated = False
        self._known: list[tuple[object, ...]] = []
        self.note()

    def register(self) -> None:
        """Register the handlers."""
        bpy.app.handlers.depsgraph_update_post.append(self._listen)

    def unregister(self) -> None:
        """Remove the handlers."""
        if self._listen in bpy.app.handlers.depsgraph_update_post:
            bpy.app.handlers.depsgraph_update_post.remove(self._listen)

    @property
    def roots(self) -> list[bpy.types.Object]:
        """Existing root objects of the shapes."""
        return found(self._roots)

    @property
    def lost(self) -> list[str]:
        """Names of deleted objects."""
        in_scenes = objects_in_scenes()
        # None is in no scene, either.
        there = zip(self._names, found_or_none(self._objects), strict=True)
        return [name for name, obj in there if obj not in in_scenes]

    def note(self) -> None:
        """Store the current state of the objects."""
        self._known, self._updated = [_state(obj) for obj in found(self._objects)], False

    @property
    def may_have_changed(self) -> bool:
        """Return whether an object may have changed since its state was stored."""
        return self._updated or [_state(obj) for obj in found(self._objects)] != self._known

    def _listen(self, _scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        if self._updated:
            return
        changed = {update.id.original.session_uid for update in depsgraph.updates if update.is_updated_geometry}
        self._updated = bool(changed) and any(
            obj.session_uid in changed or (obj.data is not None and obj.data.session_uid in changed)
            for obj in found(self._objects)
        )


def _state(obj: bpy.types.Object) -> tuple[object, ...]:
    """Return a state that changes if an object is edited; Blender does not report changes of hidden objects."""
    points = 0
    # In Edit Mode the mesh keeps its old state; leaving it changes the points.
    if obj.type == "MESH" and not obj.data.is_editmode:
        places = element_values(obj.data.attributes["position"].data, "vector", 3)
        points = zlib.crc32(places.tobytes())
    return (*signature(ShapeSource(obj.name, obj, (obj,))), points)
