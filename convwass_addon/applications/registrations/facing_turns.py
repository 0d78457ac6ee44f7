# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Turns about the vertical axis after which shapes may face the same way, and bodies that registrations turn over."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotations import nearest_rotation
from ...geometry.deformation.upright_turns import upright_turn
from ...geometry.meshes.mesh import TriangleMesh, is_level
from .carriers import Carrier
from .laid_meshes import Laid
from .mirrored_sides import MirroredSides

# A body is turned over if its vertical axis turns by more than this angle. By eye, a car may stand up to become a robot
# (60 degrees), a robot lie down to become a butterfly (90), and this dive to become a chick (105), but a fish makes a
# somersault to become a butterfly (120).
_OVER = np.radians(110.0)
# A body tumbles if it turns by more than the first angle, and its vertical axis by more than the second. They are 141
# to 180 and 68 to 143 degrees from a car to an hourglass, a teapot to a lamp, a robot to an airplane, and a hand to a
# chair, which tumble, but both are 81 to 91 from a horse to a bird, an arrow to scissors, and a bowl to a fish.
_TUMBLING, _TILTED = np.radians(125.0), np.radians(60.0)


def symmetric_turn(first: TriangleMesh, second: TriangleMesh) -> NDArray[np.float64] | None:
    """Return the turn, (3, 3), that brings a shape clearly closer to another, if there is one.

    Symmetric shapes with a common mirror plane are not turned out of it.
    """
    turn = upright_turn(first, second)
    if turn is None or MirroredSides.of(first, second) is None:
        return turn
    return None if MirroredSides.of(turned_mesh(first, turn), second) is None else turn


def turned_mesh(mesh: TriangleMesh, turn: NDArray[np.float64]) -> TriangleMesh:
    """Return a mesh turned about the origin."""
    return TriangleMesh(mesh.vertices @ turn.T, mesh.faces)


def turned_carrier(shape: Carrier, turn: NDArray[np.float64]) -> Carrier:
    """Return a shape turned about its center."""
    center = shape.mesh.area_center
    return shape.posed((shape.rest.vertices - center) @ turn.T + center)


def is_turned_over(shape: TriangleMesh, laid: Laid) -> bool:
    """Return whether a registration turns a shape, as far as it is trusted, so that up becomes down."""
    return bool(_turn_of(shape, laid)[2, 2] < np.cos(_OVER))


def tumbles(shape: TriangleMesh, laid: Laid) -> bool:
    """Return whether a registration turns a shape, as far as it is trusted, far around and not upright."""
    turn = _turn_of(shape, laid)
    return bool(np.trace(turn) < 1.0 + 2.0 * np.cos(_TUMBLING) and turn[2, 2] < np.cos(_TILTED))


def _turn_of(shape: TriangleMesh, laid: Laid) -> NDArray[np.float64]:
    """Return the rotation, (3, 3), that is nearest to a registration as far as it is trusted.

    Flat shapes stay in their plane, but the parts of one may move such that the nearest rotation turns it over; they
    have none.
    """
    if is_level(shape.vertices) and is_level(laid.points):
        return np.eye(3)
    weights = shape.vertex_areas * laid.trust
    weights = weights / max(weights.sum(), np.finfo(float).tiny)
    here, there = (points - weights @ points for points in (shape.vertices, laid.points))
    return nearest_rotation((weights * there.T) @ here)
