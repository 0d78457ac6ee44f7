# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Poses of one mesh by linear blend skinning, as game engines do it: vertices keep their numbers, and joints collapse.

L. Kavan, "Direct Skinning Methods and Deformation Primitives", SIGGRAPH course 2014.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from convwass_addon.geometry.meshes.mesh import TriangleMesh


def skinned(
    rest: TriangleMesh,
    chains: Sequence[NDArray[np.float64]],
    posed: Sequence[NDArray[np.float64]],
    width: float,
) -> TriangleMesh:
    """Return a mesh in another pose.

    Parameters
    ----------
    rest : TriangleMesh
        The mesh in the pose in which it is bound.
    chains, posed : sequence of (k, 3)
        The joints of every chain of bones in this pose and in the other one, root first. Each bone turns the shortest
        way from the orientation of the one before it; the first bone of a chain, from that at rest.
    width : float
        Distance behind the nearest bone at which the weight of a bone is 0.6, scene units.
    """
    begins = np.concatenate([chain[:-1] for chain in chains])
    ends = np.concatenate([chain[1:] for chain in chains])
    away = np.stack([_distances(rest.vertices, *bone) for bone in zip(begins, ends, strict=True)], axis=1)
    weights = np.exp(-0.5 * np.square((away - away.min(axis=1, keepdims=True)) / width))
    weights /= weights.sum(axis=1, keepdims=True)
    turns = [turn for both in zip(chains, posed, strict=True) for turn in _turns(*both)]
    places = np.concatenate([chain[:-1] for chain in posed])
    moved = np.zeros_like(rest.vertices)
    for turn, begin, place, own in zip(turns, begins, places, weights.T, strict=True):
        moved += own[:, None] * (turn.apply(rest.vertices - begin) + place)
    return TriangleMesh(moved, rest.faces)


def _distances(
    points: NDArray[np.float64], begin: NDArray[np.float64], end: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the distances of points, (n, 3), from a bone, (n,)."""
    bone = end - begin
    shares = np.clip((points - begin) @ bone / (bone @ bone), 0.0, 1.0)
    return np.linalg.norm(points - begin - shares[:, None] * bone, axis=1)


def _turns(rest: NDArray[np.float64], posed: NDArray[np.float64]) -> list[Rotation]:
    """Return the rotations of the bones of a chain, (k, 3) joints in both poses."""
    found, turn = [], Rotation.identity()
    for bone, target in zip(np.diff(rest, axis=0), np.diff(posed, axis=0), strict=True):
        turn = _shortest(turn.apply(bone), target) * turn
        found.append(turn)
    return found


def _shortest(one: NDArray[np.float64], other: NDArray[np.float64]) -> Rotation:
    """Return the smallest rotation of one vector to another that is not opposite."""
    axis = np.cross(one, other)
    sine = np.linalg.norm(axis)
    return Rotation.from_rotvec(axis * (np.arctan2(sine, one @ other) / max(sine, np.finfo(np.float64).tiny)))
