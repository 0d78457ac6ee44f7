# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Check the shapes of objects one after the other; large meshes take seconds each."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import bpy

from ....errors import ConvwassError, InputError, ResourceError
from ....geometry.meshes.mesh import TriangleMesh
from ....progress import UNINTERRUPTED, Control, Progress, Request, Work
from ....sentence import Sentence
from ...handles import Handle
from ...objects import MESHED, triangle_mesh
from ...shape_sources import is_plain, shape_source

if TYPE_CHECKING:
    from ....applications.morphs.shape_check import ShapeFindings


@dataclass(frozen=True)
class _Read:
    """What was read of a shape."""

    mesh: TriangleMesh | None = None
    """None if it is flat, or could not be read."""
    error: Sentence | None = None
    """Why it could not."""


class _ShapeRequest(Request[_Read]):
    """A shape to read; the work must not access Blender's data.

    Attributes
    ----------
    obj : Handle
        Its object.
    """

    def __init__(self, obj: Handle) -> None:
        super().__init__()
        self.obj = obj


@dataclass(frozen=True)
class CheckedShape:
    """The result of the check of a shape.

    Attributes
    ----------
    obj : Handle
        Its object.
    findings : ShapeFindings or None
        None if it is flat, or unusable.
    error : Sentence or None
        Why it is unusable.
    """

    obj: Handle
    findings: ShapeFindings | None = None
    error: Sentence | None = None


def face_count(objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> float:
    """Return about how many faces objects and their children have; infinity if some instantiate others."""
    count = 0.0
    for obj in {own for each in objects for own in (each, *each.children_recursive)}:
        evaluated = obj.evaluated_get(depsgraph)
        if evaluated.is_instancer:
            return math.inf
        if evaluated.type == "MESH":
            count += len(evaluated.data.polygons)
    return count


class CheckJob:
    """Checks shapes. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    objects : sequence of bpy.types.Object
        The objects on the list, in a scene.
    grouping : str
        How objects are grouped to shapes; see :func:`.shape_sources.shape_source`.

    Attributes
    ----------
    checked : list of CheckedShape
        The results.
    """

    def __init__(self, objects: Sequence[bpy.types.Object], grouping: str) -> None:
        self._shapes = {Handle.of("objects", obj): obj.name for obj in objects}
        self._grouping = grouping
        self.checked: list[CheckedShape] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Check the shapes; each is read by the caller when its turn comes."""
        for done, (handle, name) in enumerate(self._shapes.items()):
            request = _ShapeRequest(handle)
            yield Progress(done / len(self._shapes), Sentence("Checking {name}", {"name": name}), request)
            self.checked.append(_checked(handle, request.value, control))

    def write(self, report: Progress[_ShapeRequest]) -> None:
        """Read the shape that the work asks for."""
        report.payload.answer(self._read(report.payload.obj.find()))

    def discard(self) -> None:
        """Discard the results."""
        self.checked.clear()

    def _read(self, obj: bpy.types.Object | None) -> _Read:
        from ...flat.flat_objects import flat_objects, is_flat
        from ...joined_shapes import joined_shape

        if obj is None or not obj.users_scene:
            return _Read(error=Sentence("The object has been deleted"))
        depsgraph = bpy.context.evaluated_depsgraph_get()
        try:
            source = shape_source(obj, self._grouping)
            if is_plain(source) and obj.type != "MESH" and is_flat(obj, depsgraph):
                flat_objects([obj], depsgraph)
                return _Read()
            with joined_shape(source, depsgraph) as joined:
                return _Read(triangle_mesh(joined, depsgraph, MESHED))
        except ConvwassError as error:
            return _Read(error=error.sentence)


def _checked(obj: Handle, read: _Read, control: Control) -> CheckedShape:
    """Check a shape that was read; on any thread."""
    from ....applications.morphs.shape_check import check_shape

    if read.mesh is None:
        return CheckedShape(obj, error=read.error)
    try:
        return CheckedShape(obj, check_shape(read.mesh, control))
    except (InputError, ResourceError) as error:
        return CheckedShape(obj, error=error.sentence)
