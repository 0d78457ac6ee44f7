# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motions of shapes that are much more alike once they are turned: they turn as a whole, and move meanwhile.

A rod that stands and one that lies would else become a ball halfway.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.mutual_alignment import mean_rotation
from ...geometry.algebra.rotation_fields import rotation_matrices, rotation_vectors
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.recognition.revolution import common_revolutions
from ...geometry.solids.alignment import RigidMove, aligned
from ...progress import Control
from ..registrations.limbs import is_compact
from .coherence import way_at
from .motion import Motion, MovedShape, unmoved
from .motion_choice import MotionChoice
from .motion_request import MotionRequest
from .remaining_distance import centered_distance

# Shapes turn if that leaves at most this share of the distance between them. From an upright egg to a lying one, it
# leaves nothing.
_MUCH_CLOSER = 0.5
# By less than this angle, in radians, nothing is turned as a whole.
_SMALLEST = np.radians(5.0)
# Cells of the grid on which distances are compared.
_CELLS = 24


@dataclass(frozen=True)
class TurnedMotion:
    """A motion of turned shapes, which turn back while they move; a :class:`.motion.Motion`.

    With rotations Q_i that turn the shapes, and their weighted mean M, shapes in a blend are turned by M^T from where
    the other motion has them, about the weighted mean of their centers.

    Attributes
    ----------
    motion : Motion
        The motion of the turned shapes.
    rests : tuple of TriangleMesh
        The shapes before they are turned, with the triangles that the motion gives them.
    turns : (k, 3, 3) float64
        The rotations Q_i.
    centers : (k, 3) float64
        The points about which shapes are turned, scene units.
    way : float
        The fraction of the way towards the others that shapes move, 0 to 1.
    """

    motion: Motion
    rests: tuple[TriangleMesh, ...]
    turns: NDArray[np.float64]
    centers: NDArray[np.float64]
    way: float

    @classmethod
    def of(cls, motion: Motion, moves: Sequence[RigidMove], way: float) -> TurnedMotion:
        """Return the motion of shapes for that of the same shapes, each turned about the center of its move."""
        turns, centers = np.stack([move.rotation for move in moves]), np.stack([move.center for move in moves])
        rests = []
        for index, (turn, center) in enumerate(zip(turns, centers, strict=True)):
            rest = unmoved(motion, len(moves), index).rest
            rests.append(TriangleMesh((rest.vertices - center) @ turn + center, rest.faces))
        return cls(motion, tuple(rests), turns, centers, way)

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every shape in a blend; see :meth:`.motion.Motion.moved`."""
        shares = np.asarray(weights, np.float64)
        mean = mean_rotation(self.turns, shares)
        between = shares @ self.centers
        return [
            None if shape is None else self._turned_back(index, shape, mean, between, shares[index])
            for index, shape in enumerate(self.motion.moved(weights))
        ]

    def _turned_back(
        self, index: int, shape: MovedShape, mean: NDArray[np.float64], between: NDArray[np.float64], share: float
    ) -> MovedShape:
        rest, turn = self.rests[index], self.turns[index]
        if share == 1.0:
            return MovedShape(rest, rest.vertices, shape.parents)
        # The rotation of the shape in the blend from its own orientation.
        whole = self.way * rotation_vectors((mean.T @ turn)[None])
        center = (1.0 - self.way) * self.centers[index] + self.way * between
        back = rotation_matrices(whole)[0] @ turn.T
        return MovedShape(rest, (shape.vertices - center) @ back.T + center, shape.parents)


@dataclass(frozen=True)
class Turning:
    """Rotations that bring shapes much closer to each other.

    Attributes
    ----------
    request : MotionRequest
        The request for the turned shapes.
    moves : tuple of RigidMove
        The rotation of each shape.
    left : float
        Largest share of the distance between two shapes that is left once they are turned.
    """

    request: MotionRequest
    moves: tuple[RigidMove, ...]
    left: float

    @classmethod
    def of(cls, request: MotionRequest, control: Control) -> Turning | None:
        """Return how to turn shapes, or None if one has limbs, which move by themselves, or if turning helps little.

        All are aligned with the first one.
        """
        if not all(is_compact(shape) or common_revolutions([shape]) is not None for shape in request.shapes):
            return None
        moves = aligned(request.shapes, "PRINCIPAL_AXES", "PLACED")
        # Shapes turn in their places.
        moves = tuple(replace(move, target=move.center) for move in moves)
        if np.linalg.norm(rotation_vectors(np.stack([move.rotation for move in moves])), axis=1).max() < _SMALLEST:
            return None
        shapes = [move.moved(shape) for shape, move in zip(request.shapes, moves, strict=True)]
        left = max(_share_left(request.shapes, shapes, pair, control) for pair in request.pairs)
        return cls(replace(request, shapes=shapes), moves, left) if left <= _MUCH_CLOSER else None

    def applied(self, found: MotionChoice) -> MotionChoice:
        """Return the choice for shapes for that of the turned shapes."""
        if found.motion is None:
            return found
        motion = TurnedMotion.of(found.motion, self.moves, way_at(self.request.coherence))
        left = None if found.left is None else self.left * found.left
        between = np.stack([motion.turns[one].T @ motion.turns[other] for one, other in self.request.pairs])
        angle = float(np.degrees(np.linalg.norm(rotation_vectors(between), axis=1).max()))
        return replace(found, motion=motion, left=left, turned=angle)


def _share_left(
    shapes: Sequence[TriangleMesh], turned: Sequence[TriangleMesh], pair: tuple[int, int], control: Control
) -> float:
    """Return the distance of two turned shapes over that of the shapes; 0 for equal shapes."""
    before, after = (centered_distance([own[index] for index in pair], _CELLS, control) for own in (shapes, turned))
    return after / before if before > 0.0 else 0.0
