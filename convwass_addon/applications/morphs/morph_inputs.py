# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The inputs of a morph."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...geometry.meshes.mesh import TriangleMesh
from ..motions.guides import Guide
from .animation import Animation
from .part_labels import FaceLabels, Matching, matching_of


@dataclass(frozen=True)
class MorphInputs:
    """The shapes that a morph blends, and what is known of how they correspond.

    Attributes
    ----------
    shapes : sequence of TriangleMesh
        In a common space; they may be open, self-intersecting, disconnected or inside-out.
    names : sequence of str
        Names of the shapes, for messages.
    matching : Matching
        Parts that travel together.
    guides : sequence of mappings from int to int
        Points that correspond: each maps indices of shapes to one of their vertices. They guide the motion.
    animation : Animation or None
        The inputs of a path at all of its frames, with the vertices in the order of `shapes`: every blend uses them as
        they are at its frame. Motions are determined for `shapes`. If the triangles of an input change from frame to
        frame, there is no motion.
    """

    shapes: Sequence[TriangleMesh]
    names: Sequence[str]
    matching: Matching
    guides: Sequence[Guide] = ()
    animation: Animation | None = None

    @classmethod
    def of(
        cls,
        shapes: Sequence[TriangleMesh],
        names: Sequence[str],
        labels: Sequence[FaceLabels] | None = None,
        guides: Sequence[Guide] = (),
        animation: Animation | None = None,
    ) -> MorphInputs:
        """Return inputs whose parts of the same name travel together; without labels, each shape is one part.

        Raises
        ------
        InputError
            There are labels, but no part name is on all shapes.
        """
        return cls(shapes, names, matching_of(labels, names), guides, animation)
