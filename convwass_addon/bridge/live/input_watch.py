# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Notice that the inputs of a live morph are edited or deleted."""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import bpy
import numpy as np

from ..handles import Handle
from ..morphs.changes import signature


class InputWatch:
    """Watches some objects while it is registered.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        Which.
    """

    def __init__(self, inputs: Sequence[bpy.types.Object]) -> None:
        self.names = [obj.name for obj in inputs]
        self._objects = [Handle.of("objects", obj) for obj in inputs]
        self._updated = False
        self._known: list[tuple[object, ...]] = []
        self.note()

    def register(self) -> None:
        """Begin to listen to Blender."""
        bpy.app.handlers.depsgraph_update_post.append(self._listen)

    def unregister(self) -> None:
        """Listen no more."""
        if self._listen in bpy.app.handlers.depsgraph_update_post:
            bpy.app.handlers.depsgraph_update_post.remove(self._listen)

    @property
    def inputs(self) -> list[bpy.types.Object] | None:
        """The objects; None where one of them is gone."""
        found = [handle.find() for handle in self._objects]
        return None if any(obj is None or not obj.users_scene for obj in found) else found

    @property
    def lost(self) -> list[str]:
        """Names of those that are gone."""
        found = [handle.find() for handle in self._objects]
        return [name for name, obj in zip(self.names, found, strict=True) if obj is None or not obj.users_scene]

    def note(self) -> None:
        """Take the objects as they are now for known."""
        self._known, self._updated = [_state(obj) for obj in self.inputs or ()], False

    @property
    def may_have_changed(self) -> bool:
        """Whether an object may be another one than was noted."""
        inputs = self.inputs
        return inputs is not None and (self._updated or [_state(obj) for obj in inputs] != self._known)

    def _listen(self, _scene: bpy.types.Scene, depsgraph: bpy.types.Depsgraph) -> None:
        changed = {update.id.original.session_uid for update in depsgraph.updates if update.is_updated_geometry}
        for obj in self.inputs or ():
            if obj.session_uid in changed or (obj.data is not None and obj.data.session_uid in changed):
                self._updated = True


def _state(obj: bpy.types.Object) -> tuple[object, ...]:
    """Return what changes where an object is edited; Blender tells nothing about objects that are hidden."""
    points = 0
    if obj.type == "MESH":
        places = np.empty(3 * len(obj.data.vertices), np.float32)
        obj.data.attributes["position"].data.foreach_get("vector", places)
        points = zlib.crc32(places.tobytes())
    return (*signature(obj), points)
