# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion by warps: solids of any form approach each other by smooth elastic steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.meshes.centroid import centroid
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.remeshing.subdivision import Subdivision, with_short_edges
from ...geometry.solids.orientation import orient_outward
from ...geometry.solids.thicken import solid_or_shell_occupancy
from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ..morphs.volumes import Lattice
from ..workers import both_ways, side_by_side
from .coherence import check_coherence, excess_at, way_at
from .motion import MovedShape
from .warp_registration import MeetingFlows, meeting_flows
from .warped_shape import Course, WarpedShape

# Blur, in cells, that determines the margin of the warp's grid.
_SIGMA = 1.5
# Cells along the longest side of a shape when its volume is measured.
_COARSE = 32
# Longest edge of a moved mesh, in cells.
_LONGEST_EDGE = 0.7
# Subdivision stops at this number of vertices; larger meshes are moved as they are.
_MOST_VERTICES = 200_000
# How closely the path approaches the meeting positions at the coherence at which the motion is complete.
_DETOUR = 0.5
# Fraction of the work that the registration takes.
_REGISTERED = 0.9


@dataclass(frozen=True)
class WarpEffort:
    """Accuracy of a warp.

    Attributes
    ----------
    cells : int
        Cells of its grid along the longest side, at most.
    rounds : int
        Number of steps that compose it.
    filled : int
        Number of cells that the largest solid fills, at most; a ball needs fewer cells along its side than a horse.
    """

    cells: int = 48
    rounds: int = 16
    filled: int = 6000


USUAL_EFFORT = WarpEffort()
"""A higher effort gains little."""


@dataclass(frozen=True)
class WarpMotion:
    """A warp between shapes; see :class:`.motion.Motion`.

    For weights w, shape i moves towards the others by a blend of its courses: parts rotate between their positions at
    rest and at the end of each course (:class:`...geometry.solid_blend.SolidBlend`). A detour leads through the
    positions where shapes meet, by (w_i + w_j) sin^2(pi w_j / (w_i + w_j)) times its fraction for each other shape j.
    For two shapes that is sin^2(pi t). All this takes place at equal volume, because warps preserve volume; sizes are
    interpolated.

    Attributes
    ----------
    rests : tuple of Subdivision
        The inputs, oriented outward, with long edges divided.
    shapes : tuple of WarpedShape
        The shapes in cells.
    lattice : Lattice
        The grid, on which all shapes have the same volume.
    sizes : (k,) float64
        By how much longer the shapes are in the scene than at that volume.
    coherence : float
        From 0, where shapes are only moved to a common position, to 1, where they move most like one body.
    pairs : frozenset of (int, int)
        The pairs of shapes with a warp between them, smaller index first.
    """

    rests: tuple[Subdivision, ...]
    shapes: tuple[WarpedShape, ...]
    lattice: Lattice
    sizes: NDArray[np.float64]
    coherence: float
    pairs: frozenset[tuple[int, int]]

    def moved(self, weights: Sequence[float]) -> list[MovedShape | None]:
        """Return every input in the blend with these weights, which sum to one; None for inputs without weight.

        Raises
        ------
        ValueError
            There is no warp between two shapes with weight.
        """
        active = [i for i, weight in enumerate(weights) if weight > 0]
        missing = [pair for pair in combinations(active, 2) if pair not in self.pairs]
        if missing:
            raise ValueError(f"no warp was made between the shapes {missing[0][0]} and {missing[0][1]}")
        return [self._moved(i, weights) if weights[i] > 0 else None for i in range(len(self.rests))]

    def with_coherence(self, coherence: float) -> WarpMotion:
        """Return the same motion with another coherence, without recomputation.

        Raises
        ------
        InputError
            The coherence is not between 0 and 1.
        """
        check_coherence(coherence)
        return replace(self, coherence=coherence)

    def _moved(self, index: int, weights: Sequence[float]) -> MovedShape:
        rest, parents = self.rests[index].mesh, self.rests[index].parents
        if weights[index] == 1.0:
            return MovedShape(rest, rest.vertices, parents)
        shares = np.asarray(weights, np.float64)
        middle = shares @ self.lattice.centers
        way = way_at(self.coherence)
        size = (1.0 - way) * self.sizes[index] + way * (shares @ self.sizes)
        offsets = self._cells(index, weights) * self.lattice.spacing + self.lattice.origin
        return MovedShape(rest, size * offsets + middle, parents)

    def _cells(self, index: int, weights: Sequence[float]) -> NDArray[np.float64]:
        """Return the vertices of a shape in the blend with these weights, (n, 3) in cells, at the common volume."""
        detour = _DETOUR + (1.0 - _DETOUR) * excess_at(self.coherence)
        return self.shapes[index].at(weights, index, way_at(self.coherence), detour)


def warp_motion(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    coherence: float,
    control: Control,
    effort: WarpEffort = USUAL_EFFORT,
) -> Work[WarpMotion]:
    """Compute the warps between pairs of shapes.

    Parameters
    ----------
    shapes : sequence of TriangleMesh
        In scene space; they may be open, fragmented or flat.
    names : sequence of str
        Names of the shapes, for messages.
    pairs : sequence of (int, int)
        Pairs of shapes that are blended with each other, smaller index first.
    coherence : float
        0 to 1; see :class:`WarpMotion`.
    control : Control
        Stops the work.
    effort : WarpEffort
        Accuracy of the warps.

    Raises
    ------
    InputError
        A shape without faces, or a coherence not between 0 and 1.
    """
    check_coherence(coherence)
    for shape, name in zip(shapes, names, strict=True):
        if not len(shape.faces):
            raise InputError("'{name}' has no faces, so there is nothing to move. Use a mesh with faces.", name=name)
    outward = [orient_outward(shape) for shape in shapes]
    sizes = _sizes(outward)
    lattice = _lattice([_scaled(shape, 1.0 / size) for shape, size in zip(outward, sizes, strict=True)], effort)

    def prepared(k: int) -> tuple[Subdivision, NDArray[np.float64], WarpedShape]:
        rest = with_short_edges(outward[k], _LONGEST_EDGE * sizes[k] * lattice.spacing, _MOST_VERTICES)
        points = ((rest.mesh.vertices - lattice.centers[k]) / sizes[k] - lattice.origin) / lattice.spacing
        solid = _filled(points[rest.mesh.faces], lattice)
        return rest, solid, WarpedShape(points, solid)

    rests, solids, warped = zip(*side_by_side(prepared, len(outward)), strict=True)
    courses: list[dict[int, Course]] = [{} for _ in shapes]
    for number, (i, j) in enumerate(pairs):
        begin, end = number / len(pairs), (number + _REGISTERED) / len(pairs)
        flows = yield from within(meeting_flows(solids[i], solids[j], effort.rounds, control), begin, end)
        yield Progress(end, Sentence("Moving the shapes"))
        courses[i][j], courses[j][i] = _courses((warped[i], warped[j]), flows, control)
    side_by_side(lambda k: warped[k].take(courses[k]), len(warped))
    return WarpMotion(rests, warped, lattice, sizes, coherence, frozenset(pairs))


def _courses(warped: tuple[WarpedShape, WarpedShape], flows: MeetingFlows, control: Control) -> tuple[Course, Course]:
    """Return the courses of two shapes to each other."""
    ways = flows.first, flows.second
    return both_ways(lambda k: warped[k].course(ways[k], ways[1 - k], control))


def _sizes(shapes: Sequence[TriangleMesh]) -> NDArray[np.float64]:
    """Return the cube roots of the volumes of solids, (k,), over their geometric mean."""
    logs = np.log([_volume(shape) for shape in shapes]) / 3.0
    return np.exp(logs - logs.mean())


def _volume(shape: TriangleMesh) -> float:
    """Return the volume of a shape, which may be open or a thin sheet."""
    alone = Lattice.around([shape], _COARSE, _SIGMA)
    return float(_filled(alone.to_cells(shape, 0), alone).sum()) * alone.spacing**3


def _scaled(shape: TriangleMesh, factor: float) -> TriangleMesh:
    """Scale a shape about its center."""
    center = centroid(shape)
    return TriangleMesh(center + factor * (shape.vertices - center), shape.faces)


def _lattice(outward: Sequence[TriangleMesh], effort: WarpEffort) -> Lattice:
    """Return the grid of a warp between some shapes."""
    fine = Lattice.around(outward, effort.cells, _SIGMA)
    filled = max(abs(shape.volume) for shape in outward) / fine.spacing**3
    if filled <= effort.filled:
        return fine
    return Lattice.around(outward, round(effort.cells * np.cbrt(effort.filled / filled)), _SIGMA)


def _filled(corners: NDArray[np.float64], lattice: Lattice) -> NDArray[np.float64]:
    """Return the filled fractions of the cells; surfaces that enclose nothing are thickened.

    Moved shapes may leave the grid, which fits the shapes at rest; points beyond it are moved to its boundary.
    """
    corners = np.clip(corners, 1.0, np.array(lattice.shape) - 1.0)
    return solid_or_shell_occupancy(corners, lattice.shape).astype(np.float64)
