# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read outlines and images from the barycenters of flat shapes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from ...geometry.contours import LevelOutline, outline_at_level, outline_enclosing
from ...geometry.flat_mending import FlatConnectivity, FlatMending, mended_outline
from ...transport import Barycenter
from ..morphs.blending import part_figures, solved_figures
from ..morphs.health import wall_share
from ..morphs.layouts import Blend
from ..morphs.merging import merged_parts, typical_density
from ..morphs.morph_problem import MorphFrame
from .flat_frames import FlatDensity, FlatFrame
from .flat_origins import FlatOrigins
from .flat_regions import colored_regions

if TYPE_CHECKING:
    from .flat_problem import FlatProblem

# Cells over which a density is averaged before its outline is read, as those of solids are.
_READING_BLUR = 0.7


def own_outline(occupancy: NDArray[np.floating], area: float) -> LevelOutline:
    """Outline of a shape as it can be read from its occupancy, in the way that blends are read."""
    return outline_enclosing(gaussian_filter(occupancy, _READING_BLUR), area)


def flat_input_frame(problem: FlatProblem, frame: MorphFrame) -> FlatFrame:
    """Frame of an input as it is: its density where densities are asked for."""
    lattice, record = problem.lattice, {**frame.record, "cell": problem.lattice.spacing}
    record["area"] = record.pop("volume")
    if problem.settings.output == "outlines":
        return FlatFrame(frame.blend, None, record)
    occupancy = problem.occupancy(frame.blend.source)
    own = own_outline(occupancy, problem.silhouettes[frame.blend.source])
    return FlatFrame(
        frame.blend, lattice.to_scene(own.outline, frame.blend.weights), record, _image(problem, frame.blend, occupancy)
    )


def flat_frame(problem: FlatProblem, blend: Blend, solved: Sequence[Barycenter], sigmas: Sequence[float]) -> FlatFrame:
    """Read a blend from the barycenters of its parts.

    Parameters
    ----------
    problem : FlatProblem
        The shapes and the settings.
    blend : Blend
        Which one; no input as it is.
    solved : sequence of Barycenter
        One per part.
    sigmas : sequence of float
        The blur of each in cells.
    """
    lattice, shares = problem.lattice, problem.blend_volumes(blend)
    merged = merged_parts([part.density for part in solved], shares)
    shapes = [problem.connectivity[index] for index in np.flatnonzero(blend.weights)]
    interpolated = merged.volume * problem.fullness(blend)
    area = max(interpolated, _filled(merged.density)) if problem.settings.output == "outlines" else interpolated
    mending = _read(merged.density, area, shapes, problem)
    outline = lattice.to_scene(mending.drawn.outline, blend.weights)
    record = {
        "weights": blend.weights,
        **solved_figures(solved),
        "sigma": max(sigmas),
        "wall": wall_share(merged.density),
        "cells": lattice.shape,
        "cell": lattice.spacing,
        "level": mending.drawn.level,
        "area": outline.area,
        "area_wanted": area * lattice.spacing**2,
        "area_interpolated": interpolated * lattice.spacing**2,
        **mending.record(),
        **part_figures(problem, shares, merged),
    }
    density = None
    if problem.settings.output == "densities":
        cells = sum(part.density * (share / part.density.size) for part, share in zip(solved, shares, strict=True))
        density = _image(problem, blend, cells)
    origins = FlatOrigins.of(problem, blend, solved, sigmas, shares) if problem.settings.carry else None
    regions = colored_regions(problem, blend, mending, origins) if problem.layers and origins is not None else ()
    return FlatFrame(blend, outline, record, density, origins, regions)


def _filled(density: NDArray[np.float64]) -> float:
    """Area in cells of what is at least half as dense as is typical of the blend.

    Its root is never less than that interpolated between the roots of the inputs' areas (Brunn and Minkowski, McCann
    1997), and it is more where the maps stretch: a bar that becomes a bar across is a square halfway, larger than both.
    A level for less would have to cut through what is evenly filled, along noise.
    """
    half = 0.5 * typical_density([density])
    above = density - half
    # Cells that the edge passes through count in part.
    return float(np.clip(above / half + 0.5, 0.0, 1.0).sum())


def _image(problem: FlatProblem, blend: Blend, cells: NDArray[np.floating]) -> FlatDensity:
    corner = problem.lattice.corner(blend.weights)
    return FlatDensity(cells.astype(np.float32), problem.lattice.spacing, (float(corner[0]), float(corner[1])))


def _read(
    density: NDArray[np.float64], area: float, shapes: Sequence[FlatConnectivity], problem: FlatProblem
) -> FlatMending:
    settings = problem.settings
    if settings.level == "half-max":
        return FlatMending(outline_at_level(density, float(density.max()) / 2), density)
    prepared = gaussian_filter(density / density.max(), _READING_BLUR)
    if not settings.mend:
        return FlatMending(outline_enclosing(prepared, area), prepared)
    most = shapes[0]
    for other in shapes[1:]:
        most = most.or_more(other)
    return mended_outline(prepared, area, most)
