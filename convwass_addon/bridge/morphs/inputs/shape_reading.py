# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read the inputs of a morph from the scene: meshes in world space, parts, guides, and alignment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
import numpy as np

from ....applications.morphs.morph_inputs import MorphInputs
from ....applications.morphs.morph_settings import MorphSettings
from ....applications.morphs.part_labels import FaceLabels, matching_of
from ....errors import InputError
from ....geometry.meshes.mesh import TriangleMesh
from ....geometry.solids.alignment import RigidMove, aligned_meshes
from ...flat.planes import plane_of
from ...joined_shapes import current_shapes, joined_shape
from ...objects import MESHED, labeled_mesh, triangle_mesh
from ...shape_sources import OBJECTS, ShapeSource, is_plain, shape_sources
from .morph_guides import guides_of_entries, guides_of_shapes


@dataclass(frozen=True)
class ReadShapes:
    """The inputs of a morph as arrays.

    Attributes
    ----------
    inputs : MorphInputs
        In world space, aligned as requested.
    moves : tuple of RigidMove or None
        The transforms that align the meshes; None if there are none.
    """

    inputs: MorphInputs
    moves: tuple[RigidMove, ...] | None


def read_shapes(
    inputs: Sequence[bpy.types.Object],
    depsgraph: bpy.types.Depsgraph,
    settings: MorphSettings,
    options: Mapping[str, object],
) -> ReadShapes:
    """Read the inputs.

    Parameters
    ----------
    inputs : sequence of bpy.types.Object
        In order; for shapes of several objects, their root objects.
    depsgraph : bpy.types.Depsgraph
        Used to evaluate the modifiers of the inputs.
    settings : MorphSettings
        Settings of parts and guides.
    options : mapping
        `grouping`, as for :func:`.shape_sources.shape_source`, `alignment` and `scaling`, as for
        :func:`.alignment.aligned`, and `guides`.

    Raises
    ------
    InputError
        An input has no faces, no size, or is not a mesh; or several objects or instances form a flat shape; or the
        requested parts have no match.
    """
    sources = shape_sources(inputs, options.get("grouping", OBJECTS))
    names = [source.name for source in sources]
    with current_shapes(sources, depsgraph):
        meshes, labels = _read_meshes(sources, depsgraph, settings.parts)
        # Checked before anything is created.
        matching = matching_of(labels, names)
        if settings.thickness <= 0:
            _refuse_flat_groups(sources, meshes)
        entries = guides_of_entries(options.get("guides", ())) if settings.heeds_guides else []
        guides = guides_of_shapes(entries, inputs, meshes, depsgraph)
    alignment, scaling = (options.get(name, "PLACED") for name in ("alignment", "scaling"))
    laid = aligned_meshes(meshes, alignment, scaling, names)
    return ReadShapes(MorphInputs(laid.meshes, names, matching, guides), laid.moves)


def _read_meshes(
    sources: Sequence[ShapeSource], depsgraph: bpy.types.Depsgraph, parts: str
) -> tuple[list[TriangleMesh], list[FaceLabels] | None]:
    """Return the meshes of shapes in world space, and their parts of a kind; None if that is "none"."""
    meshes, labels = [], []
    for source in sources:
        with joined_shape(source, depsgraph) as obj:
            if parts == "none":
                meshes.append(triangle_mesh(obj, depsgraph, MESHED))
            else:
                read = labeled_mesh(obj, depsgraph, parts)
                meshes.append(read.mesh)
                labels.append(read.labels)
    return meshes, None if parts == "none" else labels


def _refuse_flat_groups(sources: Sequence[ShapeSource], meshes: Sequence[TriangleMesh]) -> None:
    """Raise InputError if several objects, or instances, form a shape that is flat; only single objects can be."""
    for source, mesh in zip(sources, meshes, strict=True):
        if not is_plain(source) and plane_of(mesh.vertices, np.eye(4)) is not None:
            raise InputError(
                "{name} is flat, but not a single object of its own. Make its instances real, convert it to meshes or "
                "curves and join these; or set Thickness to make it solid.",
                name=source.name,
            )
