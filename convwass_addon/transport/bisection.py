# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Displacement interpolation by recursive bisection: every new frame is the midpoint of its two neighbors."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..progress import UNINTERRUPTED, Control, Work, drained, within
from .checks import check_entropy_limit, check_pair, check_solver
from .domain import Domain
from .interpolation import Interpolation, SolvedFrame, check_times
from .propagation import propagation
from .sharpening import entropy, entropy_between

# Default number of halvings, without and with explicit times; explicit times lie between two solved frames. Once
# frames are an eighth apart, costs are close enough to quadratic for unequal weights.
_LEVELS, _LEVELS_BELOW_TIMES = 5, 3
# Frames solved together where each takes few sweeps: as many as hold this many values, but at least four, which make
# the multi-column solves of a mesh efficient.
_VALUES_AT_ONCE, _FEWEST_AT_ONCE = 1 << 17, 4
# Nats by which a bound is raised at frames that do not converge under it. Chosen by eye; docs/performance,
# "Meshes", lists how far bounds had to be raised.
_RELIEF = 1.0
# Frames of this many first halvings are solved again, between nearer ones. Between distant ends of a body there are
# many paths of nearly the same length; the midpoint spreads over all of them, and sharpening it to the bound gives a
# spike with long tails, up to twice as high as its neighbors.
_FAR_HALVINGS = 2


def bisect(
    mu0: ArrayLike,
    mu1: ArrayLike,
    domain: Domain,
    *,
    levels: int | None = None,
    times: ArrayLike | None = None,
    entropy_limit: Literal["between", "max"] | float | None = "max",
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    control: Control = UNINTERRUPTED,
) -> Interpolation:
    """Interpolate by recursive bisection: every new frame is the midpoint of its two neighbors.

    Only equal weights are used, and every hop is half as long as the one before. Mass therefore ends up in the right
    place although the cost of a mesh's kernel becomes linear at long distances.

    Parameters
    ----------
    mu0, mu1 : domain.shape
        Nonnegative densities; each is normalized to mass 1.
    domain : Domain
        Owns the area weights and the heat kernel. Meshes start every frame from coarser ones.
    levels : int, optional
        Solve frames at the multiples of 1 / 2^levels; by default 5, or 3 if `times` are given.
    times : (f,), optional
        Times to return instead, in [0, 1]; each frame is a barycenter of the two solved frames next to it. Frames that
        no requested time needs are not solved.
    entropy_limit : "between", "max", None or float
        Bound on the entropy of every new frame in nats: "between" interpolates the entropies of its two neighbors, as
        if a ball grew from one to the other; "max" takes the larger one; None sets no bound, and the blur of all
        levels adds up. On meshes the first two are raised by one nat where a frame does not converge.
    tolerance, max_iterations, control
        As in :func:`propagate`.

    Returns
    -------
    Interpolation
        In the order of `times`, or of time. `iterations` has those of the slowest frame of every level.

    Raises
    ------
    ValueError
        Invalid distributions or parameters; the message names the argument.
    KernelTooNarrowError
        gamma is too small for any of the numerics to reach from one distribution to the other.

    Notes
    -----
    Peaks closer to each other than the blur of a level are merged, and the bound makes one peak of them. Where two
    paths are equally long, frames may not converge; the result says so.

    Few frames are solved at a time: 24 frames on 500 000 vertices keep the whole process below 2 GB.
    """
    return drained(
        bisection(
            mu0,
            mu1,
            domain,
            levels=levels,
            times=times,
            entropy_limit=entropy_limit,
            tolerance=tolerance,
            max_iterations=max_iterations,
            control=control,
        )
    )


def bisection(
    mu0: ArrayLike,
    mu1: ArrayLike,
    domain: Domain,
    *,
    levels: int | None = None,
    times: ArrayLike | None = None,
    entropy_limit: Literal["between", "max"] | float | None = "max",
    tolerance: float = 1e-2,
    max_iterations: int = 500,
    control: Control = UNINTERRUPTED,
) -> Work[Interpolation]:
    """Like :func:`bisect`, but yields progress after every sweep over some of the frames.

    On meshes with a bound, the frames of the first two halvings are solved again once nearer frames exist on both
    sides of them.

    Parameters and errors are those of :func:`bisect`; errors are raised before the first report.

    Yields
    ------
    Progress
        After every sweep; the fraction is the share of frames that are done, the payload a :class:`.rounds.Round`.

    Returns
    -------
    Interpolation
    """
    ends = check_pair(mu0, mu1, domain)
    if entropy_limit != "between":
        check_entropy_limit(entropy_limit)
    check_solver(tolerance, max_iterations)
    wanted = None if times is None else check_times(times)
    if levels is None:
        levels = _LEVELS if wanted is None else _LEVELS_BELOW_TIMES
    if levels < 1 or levels != int(levels):
        raise ValueError(f"levels must be a positive whole number, got {levels}")
    path = _Path(domain, entropy_limit, tolerance, max_iterations, control)
    path.keep(np.array([0.0, 1.0]), ends)
    halvings, missing = _halvings(int(levels), wanted)
    far = _far(halvings) if domain.has_fast_propagation and entropy_limit is not None else np.empty(0)
    stages = [stage for stage in (*halvings, far, missing) if len(stage)]
    done, total = 0, sum(map(len, stages))
    iterations = []
    for stage in stages:
        if stage is far:
            if path.is_raised:
                # Solving again would raise bounds a second time.
                done += len(stage)
                continue
            path.forget(stage)
        sweeps = []
        for block in path.blocks(stage):
            sweeps.append((yield from within(path.insert(block), done / total, (done + len(block)) / total)))
            done += len(block)
        if stage is far:
            iterations[:_FAR_HALVINGS] = [max(before, *sweeps) for before in iterations[:_FAR_HALVINGS]]
        else:
            iterations.append(max(sweeps))
    return path.interpolation(wanted, tuple(iterations))


def _halvings(levels: int, wanted: NDArray[np.float64] | None) -> tuple[list[NDArray[np.float64]], NDArray[np.float64]]:
    """Return the times of frames to solve, one array per halving, and the requested times between them, solved last.

    Skips the times that no requested time needs.
    """
    known = np.array([0.0, 1.0])
    stages = []
    for _ in range(levels):
        low, high = known[:-1], known[1:]
        middles = 0.5 * (low + high)
        if wanted is not None:
            first, beyond = np.searchsorted(np.unique(wanted), [low, high])
            first += np.isin(low, wanted)
            middles = middles[beyond > first]
        if len(middles):
            stages.append(middles)
        known = np.union1d(known, middles)
    return stages, np.empty(0) if wanted is None else np.setdiff1d(wanted, known)


def _far(halvings: list[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the times of the first halvings that now lie midway between nearer frames than they were solved from."""
    known = np.concatenate([[0.0, 1.0], *halvings])
    found = []
    for halving, times in enumerate(halvings[:_FAR_HALVINGS], start=1):
        for time in times.tolist():
            before, after = time - known[known < time].max(), known[known > time].min() - time
            if before == after < 0.5**halving:
                found.append(time)
    return np.array(found)


@dataclass
class _Path:
    """Frames by time, and the method that solves more of them."""

    domain: Domain
    entropy_limit: Literal["between", "max"] | float | None
    tolerance: float
    max_iterations: int
    control: Control
    frames: dict[float, SolvedFrame] = field(default_factory=dict)

    def keep(self, times: NDArray[np.float64], densities: NDArray[np.float64]) -> None:
        """Store frames that are known exactly."""
        for time, density in zip(times.tolist(), densities, strict=True):
            self.frames[time] = SolvedFrame(density, entropy(density, self.domain.weights))

    def forget(self, times: NDArray[np.float64]) -> None:
        """Drop the frames at times that are to be solved again."""
        for time in times.tolist():
            del self.frames[time]

    @property
    def is_raised(self) -> bool:
        """Whether any frame's bound was raised."""
        return any(frame.raised for frame in self.frames.values())

    def blocks(self, times: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Split times into blocks of frames to solve together."""
        size = len(times)
        if self.domain.has_fast_propagation:
            size = max(_FEWEST_AT_ONCE, _VALUES_AT_ONCE // int(np.prod(self.domain.shape)))
        return [times[start : start + size] for start in range(0, len(times), size)]

    def insert(self, times: NDArray[np.float64]) -> Work[int]:
        """Solve frames between their neighbors in time, as one propagation on a graph of separate components.

        Frames at `times` become vertices count, count + 1, ... after the known ones. Returns the number of sweeps.
        """
        known = np.array(sorted(self.frames))
        right = np.searchsorted(known, times)
        if self.domain.has_fast_propagation:
            # Other frames would only take memory.
            near = np.union1d(right - 1, right)
            known, right = known[near], np.searchsorted(near, right)
        share = (times - known[right - 1]) / (known[right] - known[right - 1])
        new = len(known) + np.arange(len(times))
        edges = np.concatenate([np.stack([right - 1, new], 1), np.stack([new, right], 1)])
        frames = [self.frames[time] for time in known.tolist()]
        # The raise of a neighbor's bound is interpolated in time, so that frames do not flicker.
        raises = np.array([frame.raised for frame in frames])
        inherited = (1.0 - share) * raises[right - 1] + share * raises[right]
        limits, relief = self.entropy_limit, 0.0
        if isinstance(limits, str):
            bases = np.array([frame.entropy for frame in frames]) - raises
            low, high = bases[right - 1], bases[right]
            own = np.maximum(low, high)
            if limits == "between":
                own = entropy_between([low, high], [1.0 - share, share], self.domain.dimension)
            limits = np.concatenate([bases, own + inherited])
            relief = _RELIEF if self.domain.has_fast_propagation else 0.0
        solved = yield from propagation(
            edges,
            np.concatenate([1.0 - share, share]),
            {vertex: frame.density for vertex, frame in enumerate(frames)},
            self.domain,
            entropy_limit=limits,
            relief=relief,
            tolerance=self.tolerance,
            max_iterations=self.max_iterations,
            control=self.control,
        )
        if relief:
            inherited += (solved.entropy_limits - limits)[new]
        for vertex, (time, frame) in enumerate(zip(known.tolist(), frames, strict=True)):
            self.frames[time] = replace(
                frame, density=solved.densities[vertex], entropy=float(solved.entropies[vertex])
            )
        for vertex, time, raised in zip(new.tolist(), times.tolist(), inherited.tolist(), strict=True):
            self.frames[time] = SolvedFrame(
                density=solved.densities[vertex],
                entropy=float(solved.entropies[vertex]),
                error=float(solved.marginal_errors[vertex]),
                converged=bool(solved.converged[vertex]),
                raised=raised,
                numerics=solved.numerics,
            )
        return solved.iterations

    def interpolation(self, wanted: NDArray[np.float64] | None, iterations: tuple[int, ...]) -> Interpolation:
        """Return the frames at the requested times, or all of them in order of time."""
        times = np.array(sorted(self.frames)) if wanted is None else wanted
        frames = [self.frames[time] for time in times.tolist()]
        numerics = [frame.numerics for frame in self.frames.values()]
        return Interpolation.of(times, frames, iterations, numerics, self.domain.weights)
