# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A tube bent to a U, whose two legs are near through the air and far along the surface."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh

LEG, BEND, RADIUS = 2.0, 0.25, 0.15
"""Length of the legs, radius of the bend, and radius of the tube: the gap between the legs is 0.2 wide."""


def middle_line(along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points on the U's center line and its directions, (n, 2) each, at lengths along it."""
    arc = np.pi * BEND
    angle = np.clip((along - LEG) / BEND, 0.0, np.pi)
    points = np.stack([-BEND * np.cos(angle), -BEND * np.sin(angle)], axis=1)
    points[:, 1] += np.maximum(LEG - along, 0.0) + np.maximum(along - LEG - arc, 0.0)
    return points, np.stack([np.sin(angle), -np.cos(angle)], axis=1)


def total_length() -> float:
    """Length of the center line."""
    return 2.0 * LEG + np.pi * BEND


def rings(count: int) -> np.ndarray:
    """Lengths along the center line of the rings of vertices."""
    return np.linspace(0.0, total_length(), count)


def bent_tube(count: int, sides: int) -> TriangleMesh:
    """`count` rings of `sides` vertices, one after the other, closed with a vertex at each end."""
    points, directions = middle_line(rings(count))
    across = np.stack([directions[:, 1], -directions[:, 0]], axis=1)
    turn = np.arange(sides) * 2 * np.pi / sides
    flat = points[:, None] + RADIUS * np.cos(turn)[None, :, None] * across[:, None]
    height = np.broadcast_to(RADIUS * np.sin(turn), (count, sides))
    vertices = np.concatenate([flat, height[..., None]], axis=2).reshape(-1, 3)
    ends = np.concatenate([points[[0, -1]] + RADIUS * np.array([[-1.0], [1.0]]) * directions[[0, -1]], [[0], [0]]], 1)
    i, j = (axis.ravel() for axis in np.meshgrid(np.arange(count - 1), np.arange(sides), indexing="ij"))
    a, b = i * sides + j, i * sides + (j + 1) % sides
    wall = np.concatenate([np.stack([a, b, a + sides], 1), np.stack([b, b + sides, a + sides], 1)])
    k = np.arange(sides)
    first, last = np.full(sides, count * sides), np.full(sides, count * sides + 1)
    top = (count - 1) * sides
    caps = [np.stack([first, (k + 1) % sides, k], 1), np.stack([last, top + k, top + (k + 1) % sides], 1)]
    return TriangleMesh.from_arrays(np.concatenate([vertices, ends]), np.concatenate([wall, *caps]))
