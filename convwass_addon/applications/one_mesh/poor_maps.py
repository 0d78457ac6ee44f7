# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tell why one mesh cannot take the form of another shape."""

from __future__ import annotations

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.solids.mesh_connectivity import mesh_connectivity
from ...progress import Control


def poor_map_error(
    first: TriangleMesh, second: TriangleMesh, names: tuple[str, str], score: float, control: Control
) -> InputError:
    """Return the error for two shapes with a poor map between them.

    Parameters
    ----------
    first, second : TriangleMesh
        The shapes, oriented outward.
    names : (str, str)
        Their names.
    score : float
        Score of the map, 0 to 1.
    control : Control
        Stops the work.
    """
    own, other = (mesh_connectivity(mesh, control) for mesh in (first, second))
    if own is not None and other is not None and own != other:
        return InputError(
            "One mesh cannot take the form of both {first} (pieces: {pieces}, holes: {holes}, hollows: {hollows}) and "
            "{second} (pieces: {pieces_2}, holes: {holes_2}, hollows: {hollows_2}). Set Two Meshes, or choose "
            "another output, such as Player.",
            first=names[0],
            second=names[1],
            pieces=own.pieces,
            holes=own.handles,
            hollows=own.bubbles,
            pieces_2=other.pieces,
            holes_2=other.handles,
            hollows_2=other.bubbles,
        )
    return InputError(
        "{first} and {second} match too poorly ({score:.0%}) for one mesh to take both shapes. "
        "Add guides: corresponding points of both, or set Two Meshes.",
        first=names[0],
        second=names[1],
        score=score,
    )
