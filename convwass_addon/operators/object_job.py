# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all long work on one object has in common: the object is found again when the work is done."""

from __future__ import annotations

import bpy

from ..bridge.handles import Handle
from ..errors import ConvwassError


class ObjectJob:
    """Work on one object, which goes on being edited, renamed or deleted meanwhile.

    Parameters
    ----------
    obj : bpy.types.Object
        Which.
    gone : ConvwassError
        What is raised where it is no more.
    """

    def __init__(self, obj: bpy.types.Object, gone: ConvwassError) -> None:
        self._target, self._gone = Handle.of("objects", obj), gone

    def target(self) -> bpy.types.Object:
        """Return the object; raises the error that was given where it was deleted, or undone."""
        obj = self._target.find()
        if obj is None:
            raise self._gone
        return obj

    @property
    def is_edited(self) -> bool:
        """Whether the object is in Edit Mode."""
        obj = self._target.find()
        return obj is not None and obj.data.is_editmode
