# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolation along surfaces, one case per process: ``python -m benchmarks.surface_cases CASE OPTIONS``.

The case prints one line of JSON. It does not need Blender.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from convwass_addon.transport import Surface, bisect

from .meshes import blob
from .processes import peak_megabytes, run_case

# Radius of the caps, and distance between their centers, in radians.
_RADIUS, _APART = 0.3, 1.6


def interpolation(count: int, steps: int, bounded: bool) -> dict[str, object]:
    """Move a cap along a bumpy shape with this many vertices; returns CPU seconds by stage."""
    vertices, faces = blob(count)
    marks = [time.process_time()]
    surface = Surface(vertices, faces)
    marks.append(time.process_time())
    levels = ladder(surface)
    marks.append(time.process_time())
    ends = caps(surface)
    times = np.arange(1, steps + 1) / (steps + 1)
    found = bisect(*ends, surface, times=times, entropy_limit="between" if bounded else None)
    marks.append(time.process_time())
    setup, coarser, solve = np.diff(marks)
    return {
        "vertices": [level.shape[0] for level in levels],
        "setup": setup,
        "coarser": coarser,
        "solve": solve,
        "sweeps": found.iterations,
        "error": float(found.marginal_errors.max()),
        "converged": bool(found.converged.all()),
        "peak": peak_megabytes(),
    }


def ladder(surface: Surface) -> list[Surface]:
    """Return the surface and all coarser ones."""
    coarser = surface.coarser()
    return [surface] if coarser is None else [surface, *ladder(coarser)]


def caps(surface: Surface) -> NDArray[np.float64]:
    """Return two caps with soft rims on a surface around the origin, (2, n)."""
    return np.stack([_cap(surface, angle) for angle in (0.0, _APART)])


def _cap(surface: Surface, angle: float) -> NDArray[np.float64]:
    directions = surface.positions / np.linalg.norm(surface.positions, axis=1, keepdims=True)
    away = np.arccos(np.clip(directions @ (np.cos(angle), np.sin(angle), 0.0), -1.0, 1.0))
    return 1.0 / (1.0 + np.exp(np.minimum((away - _RADIUS) / (0.1 * _RADIUS), 50.0)))


if __name__ == "__main__":
    run_case(interpolation)
