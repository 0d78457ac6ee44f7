# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tubes by how their center lines bend, and surfaces that follow them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotation_fields import rotation_matrices, rotation_vectors
from ...geometry.plane.polylines import along_polyline
from ...geometry.recognition.center_lines import SlicedTube
from ...geometry.remeshing.subdivision import Subdivision

# Straight pieces of a center line.
_PIECES = 240
# Works that differ by less than this factor are about the same, and the weight of the frames in the middle beside
# turns, in square radians.
_ABOUT, _STRAIGHT = 1.03, 0.01
# Work of a radius that differs by a factor of e, in radians of bending per length of the line.
_RADIUS_WORK = 1.0
# A line that winds so much that its course is shorter, such as a spiral (0.06), leads nowhere; a spring of four turns
# has 0.16.
_LEAST_COURSE = 0.1


@dataclass(frozen=True)
class Tube:
    """A tube as straight pieces of equal lengths, and its surface relative to them.

    Attributes
    ----------
    turns : (k - 1, 3) float64
        Rotation vectors from each piece to the next one in the frame of the first of both, in radians.
    middle : (3, 3) float64
        Frame of the piece in the middle, as columns: along the line, and two directions across it. Frames do not twist
        about the line.
    length : float
        Length of the center line.
    radii : (k,) float64
        Radii of the pieces.
    center : (3,) float64
        Mean of the centers of the pieces.
    divided : Subdivision
        The surface in scene space, with edges so short that it can bend.
    places : (n,) float64
        Where along the line its vertices are, from 0 to k.
    offsets : (n, 3) float64
        Differences of the vertices from there in the frame there, in radii.
    """

    turns: NDArray[np.float64]
    middle: NDArray[np.float64]
    length: float
    radii: NDArray[np.float64]
    center: NDArray[np.float64]
    divided: Subdivision
    places: NDArray[np.float64]
    offsets: NDArray[np.float64]

    @classmethod
    def of(cls, sliced: SlicedTube) -> Tube:
        """Return a tube with frames that do not twist."""
        old = np.arange(len(sliced.points))
        even = np.linspace(0.0, old[-1], _PIECES + 1)
        nodes = along_polyline(even, old, sliced.points)
        along = np.diff(nodes, axis=0)
        lengths = np.linalg.norm(along, axis=1)
        frames = _untwisted(along / lengths[:, None])
        turns = rotation_vectors(np.swapaxes(frames[:-1], 1, 2) @ frames[1:])
        # Chords of bends are shorter than others; all pieces get the same length.
        radii = np.interp(0.5 * (even[1:] + even[:-1]), old, sliced.radii)
        center = (0.5 * (nodes[1:] + nodes[:-1])).mean(axis=0)
        places, vertices = sliced.places * (_PIECES / old[-1]), sliced.divided.mesh.vertices
        found = cls(turns, frames[_PIECES // 2], float(lengths.sum()), radii, center, sliced.divided, places, vertices)
        points, own, sizes = found._at(places)
        return replace(found, offsets=np.einsum("nji,nj->ni", own, vertices - points) / sizes[:, None])

    @cached_property
    def frames(self) -> NDArray[np.float64]:
        """Frames of all pieces, (k, 3, 3)."""
        steps = rotation_matrices(self.turns)
        found = np.empty((len(self.radii), 3, 3))
        half = len(found) // 2
        found[half] = self.middle
        for piece in range(half, len(found) - 1):
            found[piece + 1] = found[piece] @ steps[piece]
        for piece in range(half, 0, -1):
            found[piece - 1] = found[piece] @ steps[piece - 1].T
        return found

    @cached_property
    def line(self) -> NDArray[np.float64]:
        """Ends of all pieces, (k + 1, 3)."""
        steps = self.frames[:, :, 0] * (self.length / len(self.radii))
        nodes = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        return nodes + self.center - 0.5 * (nodes[1:] + nodes[:-1]).mean(axis=0)

    @property
    def course(self) -> NDArray[np.float64]:
        """Where the line leads on average, (3,): for a straight one, its unit direction, and less for one that winds.

        It is the slope of the straight line that fits it best, over arc length.
        """
        shares = np.linspace(-0.5, 0.5, len(self.line))
        return shares @ self.line / (shares @ shares * self.length)

    @property
    def leads_somewhere(self) -> bool:
        """Whether the line has a clear direction."""
        return bool(np.linalg.norm(self.course) >= _LEAST_COURSE)

    def pointing(self, course: NDArray[np.float64]) -> Tube:
        """Return the tube rotated so that its course has the direction of another one."""
        return replace(self, middle=_smallest_turn(self.course, course) @ self.middle)

    def _at(self, places: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return points on the line, (n, 3), frames, (n, 3, 3), and radii, (n,), at places."""
        frames, count = self.frames, len(self.radii)
        points = along_polyline(places, np.arange(count + 1), self.line)
        # Frames are those of the middles of pieces.
        between = np.clip(places - 0.5, 0.0, count - 1.0)
        piece = np.minimum(between.astype(np.int64), count - 2)
        share = between - piece
        turned = frames[piece] @ rotation_matrices(share[:, None] * self.turns[piece])
        return points, turned, np.interp(between, np.arange(count), self.radii)

    def followed(self, other: Tube) -> NDArray[np.float64]:
        """Return the vertices, (n, 3), that lie around another line as these do around this one."""
        points, frames, radii = other._at(self.places)
        return points + np.einsum("nij,nj->ni", frames, radii[:, None] * self.offsets)

    def reversed(self) -> Tube:
        """Return the same tube from its other end."""
        flip = np.array([-1.0, 1.0, -1.0])
        frames = self.frames[::-1] * flip
        turns = rotation_vectors(np.swapaxes(frames[:-1], 1, 2) @ frames[1:])
        return replace(
            self,
            turns=turns,
            middle=frames[len(frames) // 2],
            radii=self.radii[::-1],
            places=len(self.radii) - self.places,
            offsets=self.offsets * flip,
        )

    def rolled(self, angle: float) -> Tube:
        """Return the same tube with frames that are rolled about the line by an angle in radians."""
        roll = rotation_matrices(np.array([[angle, 0.0, 0.0]]))[0]
        return replace(self, turns=self.turns @ roll, middle=self.middle @ roll, offsets=self.offsets @ roll)

    def bend_to(self, other: Tube) -> float:
        """Return the sum of all angles, in radians, by which the line bends to become another one."""
        return float(np.linalg.norm(self.turns - other.turns, axis=1).sum())

    def work_to(self, other: Tube) -> float:
        """Return the work of becoming another tube: by bending, and by growing thicker and thinner."""
        ratios = np.log(self.radii / other.radii)
        return self.bend_to(other) + _RADIUS_WORK * float(np.abs(ratios - ratios.mean()).mean())


def matched_tube(one: Tube, other: Tube) -> Tube:
    """Return the second tube from the end, and with the roll, from which the first one has the least work."""
    ways = [way.rolled(_best_roll(one, way)) for way in (other, other.reversed())]
    works = [one.work_to(way) for way in ways]
    # Of ways with about the same work, the one that moves the line least.
    near = [way for way, work in zip(ways, works, strict=True) if work <= _ABOUT * min(works)]
    return min(near, key=lambda way: np.square(way.line - one.line).sum())


def _best_roll(one: Tube, other: Tube) -> float:
    """Return the angle in radians by which the frames of the second tube roll to bend as those of the first one.

    It minimizes the squared difference of the turns plus, for what is straight, a little of that of the frames in the
    middle; both are sinusoids of the angle.
    """
    (_, ours, theirs), (_, own, others) = one.turns.T, other.turns.T
    middle = _STRAIGHT * other.middle.T @ one.middle
    cosine = ours @ own + theirs @ others + middle[1, 1] + middle[2, 2]
    sine = ours @ others - theirs @ own + middle[2, 1] - middle[1, 2]
    return float(np.arctan2(sine, cosine))


def _untwisted(directions: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return frames, (k, 3, 3), whose first columns are given directions, without twist about these.

    Each is the one before, turned by the smallest rotation between both directions.
    """
    found = np.empty((len(directions), 3, 3))
    across = np.eye(3)[np.abs(directions[0]).argmin()]
    second = np.cross(directions[0], across)
    second /= np.linalg.norm(second)
    found[0] = np.stack([directions[0], second, np.cross(directions[0], second)], axis=1)
    for piece in range(len(directions) - 1):
        found[piece + 1] = _smallest_turn(directions[piece], directions[piece + 1]) @ found[piece]
    return found


def _smallest_turn(direction: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest rotation, (3, 3), from one direction to another; none if they are parallel."""
    axis = np.cross(direction, other)
    sine = np.linalg.norm(axis)
    angle = np.arctan2(sine, direction @ other)
    return rotation_matrices((axis * (angle / sine if sine > 0.0 else 0.0))[None])[0]
