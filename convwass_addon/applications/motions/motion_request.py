# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Everything that the motion of a morph depends on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from ...geometry.meshes.mesh import TriangleMesh
from ..registrations.corresponding_vertices import vertices_correspond
from .guides import Guide


@dataclass(frozen=True)
class MotionRequest:
    """The shapes that are to move into each other, and how.

    Attributes
    ----------
    shapes, names
        The inputs, oriented outward, and their names for messages.
    pairs : sequence of (int, int)
        Pairs of inputs that occur together in a blend, smaller index first.
    kind : str
        "automatic", "guided", "warp" or "transport".
    coherence : float
        0 to 1; there is no motion at 0.
    guides : sequence of mappings from int to int
        See :func:`.guided_motion.guided_motion`.
    bends : bool
        Whether a warp would bend plane faces, as far as that is known.
    """

    shapes: Sequence[TriangleMesh]
    names: Sequence[str]
    pairs: Sequence[tuple[int, int]]
    kind: str
    coherence: float
    guides: Sequence[Guide] = ()
    bends: bool = False

    @property
    def is_free(self) -> bool:
        """Whether the motion is chosen by the shapes alone."""
        return self.kind == "automatic" and not self.guides

    @cached_property
    def vertices_correspond(self) -> bool:
        """Whether the vertices of all pairs of shapes correspond by their numbers, and no guides say otherwise."""
        pairs = ((self.shapes[one], self.shapes[other]) for one, other in self.pairs)
        return not self.guides and all(vertices_correspond(*pair) for pair in pairs)

    def digest(self) -> bytes:
        """Return a hash of everything that is asked for, equal for equal requests."""
        sizes = [[len(shape.vertices), len(shape.faces)] for shape in self.shapes]
        entries = [sorted(guide.items()) for guide in self.guides]
        about = [list(self.names), list(self.pairs), self.kind, self.coherence, entries, sizes]
        hashed = hashlib.sha256(json.dumps(about).encode())
        for shape in self.shapes:
            hashed.update(shape.vertices.astype("<f8").tobytes())
            hashed.update(shape.faces.astype("<i8").tobytes())
        return hashed.digest()
