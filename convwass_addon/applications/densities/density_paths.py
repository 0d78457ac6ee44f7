# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Move densities along a surface: from one to another, through several at key times, or blended by weights.

Solomon et al. 2015, section 6.1 and Fig. 6.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work, within
from ...sentence import Sentence
from ...transport import Surface, barycenter, interpolate
from ...transport.sharpening import entropy, entropy_between
from ..blend_weights import normalized_weights
from ..workers import one_blas_thread
from .density_frames import DensityFrames, comparable, joined_frames, record
from .density_legs import Leg
from .density_memory import check_frames_memory
from .density_preparing import preparing_levels
from .density_settings import DensitySettings
from .density_solving import reachable


def interpolation_steps(
    first: ArrayLike,
    second: ArrayLike,
    surface: Surface,
    settings: DensitySettings,
    names: tuple[str, str] = ("A", "B"),
    control: Control = UNINTERRUPTED,
) -> Work[DensityFrames]:
    """Move one density to another in ``settings.steps`` steps, at equally spaced times from 0 to 1.

    Parameters, progress, results and errors are those of :func:`path_steps`.
    """
    return path_steps([first, second], names, surface, settings, control=control)


def path_steps(
    weights: Sequence[ArrayLike],
    names: Sequence[str],
    surface: Surface,
    settings: DensitySettings,
    key_times: ArrayLike | None = None,
    control: Control = UNINTERRUPTED,
) -> Work[DensityFrames]:
    """Move a density through several others, ``settings.steps`` steps from each to the next.

    Parameters
    ----------
    weights : sequence of (n,)
        Painted weights, or densities, in the order of the path.
    names : sequence of str
        Names of the densities for messages.
    surface : Surface
        The surface of the densities, with its kernel.
    settings : DensitySettings
        Only steps, bound, tolerance and iterations are used here; blur and substeps went into the surface.
    key_times : (k,), optional
        Ascending times at which the densities are reached; by default evenly spaced from 0 to 1.
    control : Control
        Stops the work when cancelled.

    Yields
    ------
    Progress
        The payloads are the frames of every finished leg of the path, as :class:`DensityFrames`.

    Returns
    -------
    DensityFrames
        All frames, including the given densities.

    Raises
    ------
    InputError, ResourceError
        Before the first frame: invalid densities, times or settings.
    """
    densities = comparable(weights, names, surface, settings)
    times = _key_times(key_times, len(densities))
    legs = len(densities) - 1
    check_frames_memory(surface, legs * settings.steps + 1)
    yield from preparing_levels(surface)
    parts = []
    for leg in range(legs):
        way = Leg(densities[leg : leg + 2], (names[leg], names[leg + 1]), surface, settings, control)
        frames = yield from within(way.work(times[leg], times[leg + 1]), leg / legs, (leg + 1) / legs)
        # Skip the first frame, which is the last one of the previous leg.
        parts.append(frames.without_first() if leg else frames)
        done = Sentence("Reached {name}", {"name": names[leg + 1]})
        yield Progress((leg + 1) / legs, done, parts[-1])
    return joined_frames(parts)


def blend_steps(
    weights: Sequence[ArrayLike],
    names: Sequence[str],
    shares: Sequence[float],
    surface: Surface,
    settings: DensitySettings,
    control: Control = UNINTERRUPTED,
) -> Work[DensityFrames]:
    """Blend several densities: their barycenter with the weights `shares`, as one frame at time 0.

    With a bound, ``settings.blend_sharpness`` of the kernel's blur is removed as well, which keeps peaks apart. If one
    density has all the weight, the blend equals it.

    Parameters
    ----------
    weights, names, surface, settings, control
        As for :func:`path_steps`.
    shares : sequence of float
        One per density, nonnegative, not all zero.

    Yields
    ------
    Progress
        Before and after the solve.

    Returns
    -------
    DensityFrames
        The blend.

    Raises
    ------
    InputError, ResourceError
        Before the work starts: invalid densities, shares or settings.
    """
    alphas = normalized_weights(shares, len(names))
    densities = comparable(weights, names, surface, settings)
    check_frames_memory(surface, 1, edges=len(densities))
    yield from preparing_levels(surface)
    message = Sentence("Blending {names}", {"names": ", ".join(names)})
    yield Progress(0.0, message)
    active = np.flatnonzero(alphas)
    bound = settings.entropy_limit
    if bound == "between":
        entropies = [entropy(density, surface.weights) for density in densities]
        bound = float(entropy_between(entropies, alphas, surface.dimension))
    options = {
        "sharpness": 0.0 if bound is None else settings.blend_sharpness,
        "entropy_limit": bound,
        "tolerance": settings.tolerance,
        "max_iterations": settings.max_iterations,
        "control": control,
    }
    with one_blas_thread(), reachable(surface, names):
        if len(active) <= 2:
            figures, density = _between_two(densities[active], alphas[active], surface, options)
        else:
            figures, density = _among_several(densities, alphas, surface, options)
    figures["weights"] = [{"name": name, "weight": float(share)} for name, share in zip(names, alphas, strict=True)]
    yield Progress(1.0, message)
    return DensityFrames(np.zeros(1), density[None], [figures], surface)


def _between_two(
    densities: NDArray[np.float64], alphas: NDArray[np.float64], surface: Surface, options: Mapping[str, object]
) -> tuple[dict[str, object], NDArray[np.float64]]:
    """Return the record and the density of a blend of one or two densities.

    For two, the weights can be corrected for the linear cost of long distances: at 1.6 rad apart on a sphere, a blend
    of 3 to 1 is misplaced by 0.03 rad instead of 0.17.
    """
    times = alphas[1:] if len(alphas) == 2 else [0.0]
    found = interpolate(densities[0], densities[-1], times, surface, **options)
    solved = found.marginal_errors[0], found.converged[0], found.iterations[0], found.numerics
    return record(0.0, found.entropies[0], None, *solved), found.densities[0]


def _among_several(
    densities: NDArray[np.float64], alphas: NDArray[np.float64], surface: Surface, options: Mapping[str, object]
) -> tuple[dict[str, object], NDArray[np.float64]]:
    """Return the record and the density of a blend of more than two densities."""
    found = barycenter(densities, alphas, surface, **options)
    error = max(found.marginal_error, found.debias_error)
    solved = error, found.converged, sum(found.iterations), found.numerics
    return record(0.0, found.entropy, None, *solved), found.density


def _key_times(key_times: ArrayLike | None, count: int) -> NDArray[np.float64]:
    """Return the time at which every density is reached."""
    if key_times is None:
        return np.linspace(0.0, 1.0, count)
    times = np.asarray(key_times, dtype=np.float64)
    if times.shape != (count,):
        raise InputError("There are {groups} groups and {times} key times.", groups=count, times=times.size)
    if not np.isfinite(times).all() or (np.diff(times) <= 0).any():
        raise InputError("Key times must be numbers, each later than the one before.")
    return times
