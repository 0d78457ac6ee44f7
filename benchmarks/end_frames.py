# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measure what the frame next to a shape has lost of that shape."""

from __future__ import annotations

from dataclasses import dataclass

from convwass_addon.geometry.meshes.mesh import TriangleMesh

from .coherence_measures import steps_between

_SHIFTS = 4


@dataclass(frozen=True)
class EndLoss:
    """Differences between a shape and the frame next to it, other than the motion and the change of volume.

    Attributes
    ----------
    area : float
        Fraction of the shape's area that the frame lacks.
    detail : float
        Mean distance of the two surfaces, in cells.
    """

    area: float
    detail: float

    @classmethod
    def of(cls, shape: TriangleMesh, frame: TriangleMesh, spacing: float) -> EndLoss:
        """Compare a frame with a shape that has been moved by the motion, in cells of size `spacing`.

        The shape is first offset evenly to the frame's volume. For example, a ball that becomes a knot of a quarter of
        its volume shrinks by a third of a cell in one frame of 24, and loses nothing.
        """
        expected = with_volume(shape, frame.volume)
        return cls(1.0 - frame.area / expected.area, steps_between([expected, frame], spacing)[0].mean)


def with_volume(mesh: TriangleMesh, volume: float) -> TriangleMesh:
    """Offset a closed mesh along its normals until it encloses nearly the given volume."""
    for _ in range(_SHIFTS):
        shift = (volume - mesh.volume) / mesh.area
        mesh = TriangleMesh(mesh.vertices + shift * mesh.vertex_normals, mesh.faces)
    return mesh
