# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Let a mesh follow the surfaces of a morph, from moment to moment.

Its vertices move with the matter of the morph, and then along their normals onto the next surface. Where a hole of the
surface closes, or two of its parts join, the mesh keeps its walls, which lie inside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.surface_covering import covering
from ...geometry.deformation.surface_projection import drawn_along_normals
from ...geometry.meshes.facing_points import FacingPointFinder
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import Control, Progress, Work
from ...sentence import Sentence


@dataclass(frozen=True)
class Moment:
    """The surface of a morph at one time.

    Attributes
    ----------
    time : float
        From 0 to 1.
    surface : TriangleMesh
        Closed, oriented outward.
    velocity : (n, 3) float64 or None
        Change of its vertices per unit of time; None if it is not known.
    """

    time: float
    surface: TriangleMesh
    velocity: NDArray[np.float64] | None = None


def turned_around(moments: Sequence[Moment]) -> list[Moment]:
    """Return the moments of the same morph from its end to its beginning."""
    return [
        Moment(1.0 - own.time, own.surface, None if own.velocity is None else -own.velocity)
        for own in reversed(moments)
    ]


def followed(
    mesh: TriangleMesh, moments: Sequence[Moment], message: Sentence, control: Control
) -> Work[list[NDArray[np.float64]]]:
    """Return the vertices, (n, 3), of a mesh at every moment.

    Parameters
    ----------
    mesh : TriangleMesh
        Has the form of the first moment, and stays there.
    moments : sequence of Moment
        In the order of time, close to each other.
    message : Sentence
        Reported with the progress.
    control : Control
        Stops the work.
    """
    places = [mesh.vertices]
    for number, (before, after) in enumerate(pairwise(moments)):
        yield Progress(number / (len(moments) - 1), message)
        control.check()
        moved = _carried(TriangleMesh(places[-1], mesh.faces), before, after, control)
        places.append(drawn_along_normals(moved, after.surface, control))
    last = TriangleMesh(places[-1], mesh.faces)
    places[-1] = covering(last, moments[-1].surface, control)
    return places


def _carried(mesh: TriangleMesh, before: Moment, after: Moment, control: Control) -> TriangleMesh:
    """Move a mesh with the matter of the surface that it lies on, at the mean velocity of two moments."""
    duration = after.time - before.time
    begin = _velocities(mesh, before, control)
    if begin is None:
        return mesh
    moved = TriangleMesh(mesh.vertices + duration * begin, mesh.faces)
    end = _velocities(moved, after, control)
    if end is None:
        return moved
    return TriangleMesh(mesh.vertices + 0.5 * duration * (begin + end), mesh.faces)


def _velocities(mesh: TriangleMesh, moment: Moment, control: Control) -> NDArray[np.float64] | None:
    """Return the velocities of the points of a surface that are closest to the vertices of a mesh, (n, 3)."""
    if moment.velocity is None:
        return None
    normals = mesh.vertex_normals
    found = FacingPointFinder(moment.surface).find(mesh.vertices, normals, control)
    return found.interpolated(moment.velocity[moment.surface.faces])
