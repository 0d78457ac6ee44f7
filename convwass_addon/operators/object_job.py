# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work on one object."""

from __future__ import annotations

import bpy

from ..bridge.handles import Handle
from ..errors import ConvwassError
from .background import Job


class ObjectJob(Job):
    """Work on an object that may be edited, renamed or deleted in the meantime.

    Parameters
    ----------
    obj : bpy.types.Object
        The object.
    gone : ConvwassError
        The error to raise if the object was deleted.
    """

    def __init__(self, obj: bpy.types.Object, gone: ConvwassError) -> None:
        self._target, self._gone = Handle.of("objects", obj), gone

    def target(self) -> bpy.types.Object:
        """Return the object; raises the given error if it was deleted or its creation undone."""
        return self._target.living(self._gone)

    @property
    def is_edited(self) -> bool:
        """Whether the object is in Edit Mode."""
        obj = self._target.find()
        return obj is not None and obj.data.is_editmode
