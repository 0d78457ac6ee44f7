# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Register one surface to another from the best of several starts, mirrored if necessary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.algebra.rotations import best_turn
from ...geometry.deformation.registration import AS_PLACED, BY_GUESS, BY_PAIRS, TO_THE_END, Registration, Stage
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.normals import vertex_normals
from ...progress import Control

# Chosen by eye; docs/performance, "Soft maps", lists what these and the other constants of soft maps achieve.
# Number of pairs that determine the rotation of one surface relative to the other.
_ENOUGH = 3
# The mirrored source is tried if aligning it by pairs leaves at most this multiple of the unmirrored error.
_WORTH_TRYING = 1.6
# A mirrored start is tried if at least this fraction of the guess's area is inverted, an unmirrored one if at least
# this fraction is not.
_MOSTLY = 0.3
# Mirroring must reduce the energy to this fraction, since shapes are hardly ever as symmetric as they seem.
_MIRRORING = 0.7


@dataclass(frozen=True)
class Overlay:
    """The source registered to the target.

    Attributes
    ----------
    images : ClosestPoints
        The target point for every source vertex, and its distance.
    is_mirrored : bool
        Whether left and right are exchanged.
    """

    images: ClosestPoints
    is_mirrored: bool


@dataclass(frozen=True)
class _Start:
    is_mirrored: bool
    points: NDArray[np.float64]
    stages: tuple[Stage, ...]


def overlaid(
    source: UnitShape, target: UnitShape, pairs: NDArray[np.int64], guess: NDArray[np.int64], control: Control
) -> Overlay:
    """Register the source to the target.

    Parameters
    ----------
    source, target : UnitShape
    pairs : (k, 2) int64
        Corresponding vertices.
    guess : (n0,) int64
        A target vertex for every source vertex, possibly wrong.
    control : Control
        Stops the work.
    """
    shapes = {False: source, True: source.mirrored()}
    best: dict[bool, tuple[float, Registration]] = {}
    for start in _starts(shapes, target, pairs, guess):
        found = Registration(shapes[start.is_mirrored], target, pairs, start.points)
        found.advance(start.stages, control)
        energy = found.energy()
        if start.is_mirrored not in best or energy < best[start.is_mirrored][0]:
            best[start.is_mirrored] = energy, found
    is_mirrored = _is_mirrored(best, control)
    _, found = best[is_mirrored]
    found.advance(TO_THE_END, control)
    return Overlay(found.images(), is_mirrored)


def _is_mirrored(best: dict[bool, tuple[float, Registration]], control: Control) -> bool:
    """Return whether the source should be mirrored; promising cases are refined before the decision."""
    if True not in best or best[False][0] < best[True][0]:
        return False
    for _, found in best.values():
        found.advance(TO_THE_END[:1], control)
    return best[True][1].energy() < _MIRRORING * best[False][1].energy()


def _starts(
    shapes: dict[bool, UnitShape], target: UnitShape, pairs: NDArray[np.int64], guess: NDArray[np.int64]
) -> Iterator[_Start]:
    """Yield the starts that are worth trying."""
    inverted = _inverted_fraction(shapes[False], target, guess)
    mirrored_too = True
    if len(pairs) >= _ENOUGH:
        aligned = {way: _aligned_by_pairs(shape, target, pairs) for way, shape in shapes.items()}
        missed = {way: _alignment_error(points, target, pairs) for way, points in aligned.items()}
        yield _Start(False, aligned[False], BY_PAIRS)
        mirrored_too = missed[True] <= _WORTH_TRYING * missed[False]
        if mirrored_too:
            yield _Start(True, aligned[True], BY_PAIRS)
    else:
        here, there = pairs.T
        offset = (target.vertices[there] - shapes[False].vertices[here]).mean(axis=0) if len(pairs) else np.zeros(3)
        yield _Start(False, shapes[False].vertices + offset, AS_PLACED)
    if inverted < 1.0 - _MOSTLY:
        yield _Start(False, target.vertices[guess], BY_GUESS)
    if inverted > _MOSTLY and mirrored_too:
        yield _Start(True, target.vertices[guess], BY_GUESS)


def _inverted_fraction(source: UnitShape, target: UnitShape, guess: NDArray[np.int64]) -> float:
    """Return the fraction of the guessed images' area that faces inward."""
    images = target.vertices[guess]
    a, b, c = (images[source.mesh.faces[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    facing = vertex_normals(target.vertices, target.mesh.faces)[guess][source.mesh.faces].sum(axis=1)
    # Faces that the guess stretches are the least reliable, so their weight is limited.
    lengths = np.linalg.norm(normals, axis=1)
    weights = np.minimum(lengths, np.median(lengths))
    total = weights.sum()
    inward = np.einsum("md,md->m", normals, facing) < 0
    return float(weights[inward].sum() / total) if total > 0 else 0.0


def _aligned_by_pairs(source: UnitShape, target: UnitShape, pairs: NDArray[np.int64]) -> NDArray[np.float64]:
    """Align the source rigidly such that its pairs are closest to their partners."""
    here, there = source.vertices[pairs[:, 0]], target.vertices[pairs[:, 1]]
    return (source.vertices - here.mean(axis=0)) @ best_turn(here, there).T + there.mean(axis=0)


def _alignment_error(points: NDArray[np.float64], target: UnitShape, pairs: NDArray[np.int64]) -> float:
    return float(np.sqrt(np.square(points[pairs[:, 0]] - target.vertices[pairs[:, 1]]).sum(axis=1).mean()))
