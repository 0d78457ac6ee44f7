# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Soft maps from one mesh to another, from a few pairs of vertices (Solomon et al. 2015, section 7).

Matched components are solved on coarse meshes of about a thousand vertices and extended to all vertices from there.
"""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.mirror_planes import MirrorPlanes
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ...transport import SoftMap, Surface
from ...transport.soft_map_levels import SoftMapSweeps, soft_map_between, symmetric_soft_map
from ..usable_meshes import require_surface
from ..workers import both_ways, one_blas_thread
from .coarse_sides import CoarseSide, coarse_side
from .compatibility import comparison
from .guessed_pairs import guessed_pairs
from .map_extension import Parts
from .map_pairs import checked_pairs, pair_notices
from .map_pieces import PieceMatch, matched_pieces, part_of
from .map_sides import MapSide
from .soft_map_settings import SoftMapSettings
from .surface_maps import SurfaceMap

# Least number of coarse vertices of small components.
_FEWEST_VERTICES = 60
# Fractions of the work at which coarsening, comparing and solving end; the rest is the extension to all vertices.
_COARSE, _TOLD_APART, _SOLVED = 0.25, 0.5, 0.85


def soft_map_steps(
    source: MapSide,
    target: MapSide,
    pairs: ArrayLike,
    settings: SoftMapSettings | None = None,
    control: Control = UNINTERRUPTED,
    mirrors: MirrorPlanes | None = None,
) -> Work[SurfaceMap]:
    """Compute the soft map between two meshes.

    Parameters
    ----------
    source, target : MapSide
        Of any topology, open or closed, with any number of connected components.
    pairs : (k, 2) int
        Corresponding vertices of the source and the target; possibly none, but this is rarely enough.
    settings : SoftMapSettings, optional
        Settings of the solve.
    control : Control
        Stops the work when cancelled.
    mirrors : (MirrorPlane, MirrorPlane), optional
        Planes in which the meshes are nearly symmetric, so that the map keeps left and right. Settings that solve both
        ways ignore them.

    Yields
    ------
    Progress
        Before every stage of the work.

    Returns
    -------
    SurfaceMap

    Raises
    ------
    InputError
        Invalid meshes or pairs.
    """
    settings = settings or SoftMapSettings()
    begun = time.perf_counter()
    yield Progress(0.0, Sentence("Reading the meshes"))
    for side in (source, target):
        _check_side(side)
        control.check()
    couples_of = checked_pairs(pairs, source, target)
    matches = matched_pieces(source, target, couples_of)
    if not matches:
        raise InputError(
            "No piece of {source} looks like any of {target}; mark a pair on each.",
            source=source.name,
            target=target.name,
        )
    sizes = np.array([len(match.source) + len(match.target) for match in matches], float)
    ends = np.concatenate([[0.0], np.cumsum(sizes) / sizes.sum()])
    parts = Parts(source, target, settings.sharpness)
    for number, match in enumerate(matches):
        low, width = ends[number], ends[number + 1] - ends[number]
        if not len(match.pairs):
            match = replace(match, pairs=guessed_pairs(source, target, match, parts.forward), is_guessed=True)
        yield from within(_matched(source, target, match, settings, control, parts, mirrors), low, low + width)
    record = {"settings": settings.as_dict(), "pairs": len(couples_of), "seconds": time.perf_counter() - begun}
    yield Progress(1.0, Sentence("The map is there"))
    return parts.joined(record)


def _check_side(side: MapSide) -> None:
    require_surface(side.mesh, side.name)
    for name, weights in side.groups.items():
        if np.shape(weights) != (len(side.mesh.vertices),) or not np.isfinite(weights).all():
            raise InputError("The group {name} must have one number for every vertex.", name=name)


def _matched(
    source: MapSide,
    target: MapSide,
    match: PieceMatch,
    settings: SoftMapSettings,
    control: Control,
    parts: Parts,
    mirrors: MirrorPlanes | None,
) -> Work[None]:
    """Solve the map between two matched components and add it to the whole map."""
    yield Progress(0.0, Sentence("Simplifying the meshes"))

    def simplified(k: int) -> tuple[CoarseSide, NDArray[np.int64]]:
        side, vertices = (source, target)[k], (match.source, match.target)[k]
        part = part_of(side, vertices)
        kept = np.searchsorted(vertices, match.pairs[:, k])
        coarse = coarse_side(part, _vertex_count(side, part, settings), kept, control)
        return coarse, coarse.places(kept)

    with one_blas_thread():
        sides, places = zip(*both_ways(simplified), strict=True)
    control.check()
    pairs = np.stack(places, axis=1)
    yield Progress(_COARSE, Sentence("Comparing the shapes"))
    with one_blas_thread():
        compared = comparison(sides[0].side, sides[1].side, pairs, settings, control)
    yield Progress(_TOLD_APART, Sentence("Solving the map"))
    with one_blas_thread():
        rows, back = _solved(sides[0], sides[1], compared.costs, pairs, settings, control, mirrors)
    yield Progress(_SOLVED, Sentence("Taking the map to all vertices"))
    judged = pairs[:0] if match.is_guessed else pairs
    notices = tuple(pair_notices(judged, sides[0].side.mesh, sides[1].side.mesh, match.pairs))
    with one_blas_thread():
        parts.add(match, *sides, rows, back, pairs, compared.overlay.is_mirrored, notices, control)


def _vertex_count(side: MapSide, part: MapSide, settings: SoftMapSettings) -> int:
    """Return the number of coarse vertices of part of a mesh, in proportion to its area."""
    share = part.mesh.area / side.mesh.area
    return max(_FEWEST_VERTICES, round(settings.vertices * share))


def _solved(
    source: CoarseSide,
    target: CoarseSide,
    costs: NDArray[np.float32],
    pairs: NDArray[np.int64],
    settings: SoftMapSettings,
    control: Control,
    mirrors: MirrorPlanes | None,
) -> tuple[SoftMap, NDArray[np.float32]]:
    """Return the map of two coarse meshes, and the densities of the inverse direction, (n1, n0)."""
    here, there = (Surface(side.side.mesh.vertices, side.side.mesh.faces) for side in (source, target))
    sweeps = SoftMapSweeps(
        tau=settings.tau, sharpness=settings.sharpness, gamma_scale=settings.gamma_scale, fine=settings.sweeps
    )
    if settings.symmetric:
        both = symmetric_soft_map(costs, here, there, pairs=pairs, sweeps=sweeps, control=control)
        return both.forward, both.backward.densities
    found = soft_map_between(costs, here, there, pairs=pairs, mirrors=mirrors, sweeps=sweeps, control=control)
    return found, found.densities.T
