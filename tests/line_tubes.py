# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tubes around lines."""

from __future__ import annotations

import numpy as np

from convwass_addon.geometry.meshes.mesh import TriangleMesh


def tube(line, radius=0.1, around=12) -> TriangleMesh:
    """A closed tube around the points of a line, (n, 3), with radii, (n,), and flat ends."""
    line = np.asarray(line, np.float64)
    count, radii = len(line), np.broadcast_to(radius, len(line))
    along = np.gradient(line, axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    angles = 2.0 * np.pi * np.arange(around) / around
    across, rings = np.cross(along[0], (0.36, 0.48, 0.8)), []
    for point, direction, own in zip(line, along, radii, strict=True):
        across = across - (across @ direction) * direction
        across /= np.linalg.norm(across)
        ring = np.outer(np.cos(angles), across) + np.outer(np.sin(angles), np.cross(direction, across))
        rings.append(point + own * ring)
    corners = np.arange(count * around).reshape(count, around)
    here, there = corners[:-1], corners[1:]
    sides = [(here, np.roll(here, -1, 1), np.roll(there, -1, 1)), (here, np.roll(there, -1, 1), there)]
    caps = [
        (np.full(around, count * around), np.roll(corners[0], -1), corners[0]),
        (np.full(around, count * around + 1), corners[-1], np.roll(corners[-1], -1)),
    ]
    faces = [np.stack([own.ravel() for own in triangles], axis=1) for triangles in (*sides, *caps)]
    return TriangleMesh(np.concatenate([*rings, line[:1], line[-1:]]), np.concatenate(faces))


def straight(length=4.0, count=40):
    """Points along z."""
    return np.linspace(0.0, length, count)[:, None] * np.array([0.0, 0.0, 1.0])


def helix(radius, pitch, turns, count=160):
    """Points of a helix about z."""
    angles = np.linspace(0.0, 2.0 * np.pi * turns, count)
    return np.stack([radius * np.cos(angles), radius * np.sin(angles), pitch / (2.0 * np.pi) * angles], axis=1)
