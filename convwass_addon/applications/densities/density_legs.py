# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One leg of a density path: from one density on a surface to another, at any number of times."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...progress import Control, Progress, Work, within
from ...sentence import Sentence
from ...transport import Interpolation, Surface, bisection, interpolate
from ..workers import one_blas_thread
from .density_frames import DensityFrames, joined_frames, record
from .density_settings import DensitySettings
from .density_solving import reachable, solving

# Number of frames without a bound that are solved between progress reports.
_FRAMES_AT_ONCE = 12


@dataclass(frozen=True)
class Leg:
    """The interpolation between two densities.

    Attributes
    ----------
    ends : (2, n) float64
        The densities, with equal masses on every connected component.
    names : (str, str)
        Names of the densities for messages.
    surface : Surface
        The surface of the densities.
    settings : DensitySettings
        Settings of the interpolation.
    control : Control
        Stops the work when cancelled.
    """

    ends: NDArray[np.float64]
    names: tuple[str, str]
    surface: Surface
    settings: DensitySettings
    control: Control

    def work(self, start: float, end: float) -> Work[DensityFrames]:
        """Solve all frames, including both ends, at times from `start` to `end`, and return them."""
        message = Sentence("From {first} to {second}", {"first": self.names[0], "second": self.names[1]})
        yield Progress(0.0, message)
        instants = np.arange(self.settings.steps + 1) / self.settings.steps
        # Without a bound, bisection would make the blur vary from frame to frame.
        is_plain = self.settings.entropy_limit is None or len(instants) == 2
        work = self._solve_barycenters(instants) if is_plain else self._bounded(instants)
        parts = yield from within(work, 0.0, 1.0, message)
        return joined_frames([self._frames(part, start, end) for part in parts])

    def _solve_barycenters(self, instants: NDArray[np.float64]) -> Work[list[Interpolation]]:
        """Solve weighted barycenters, a few at a time."""
        found = []
        parts = np.array_split(instants, -(-len(instants) // _FRAMES_AT_ONCE))
        for done, part in enumerate(parts, start=1):
            with one_blas_thread(), reachable(self.surface, self.names):
                found.append(interpolate(*self.ends, part, self.surface, **self._options))
            yield Progress(done / len(parts), Sentence("Solving"))
        return found

    def _bounded(self, instants: NDArray[np.float64]) -> Work[list[Interpolation]]:
        """Solve by bisection, several midpoints of a level at a time."""
        limit = self.settings.entropy_limit
        work = bisection(*self.ends, self.surface, times=instants, entropy_limit=limit, **self._options)
        found = yield from solving(work, self.surface, self.names)
        # Convert iterations per level to iterations per frame.
        inner = (found.iterations[min(_halvings(t), len(found.iterations)) - 1] for t in instants[1:-1])
        return [replace(found, iterations=(0, *inner, 0))]

    @property
    def _options(self) -> dict[str, object]:
        return {
            "tolerance": self.settings.tolerance,
            "max_iterations": self.settings.max_iterations,
            "control": self.control,
        }

    def _frames(self, found: Interpolation, start: float, end: float) -> DensityFrames:
        """Convert an interpolation with iterations per frame to frames at times of this leg."""
        known = {0.0: (start, self.names[0]), 1.0: (end, self.names[1])}
        places = [known.get(t, (start + (end - start) * t, None)) for t in found.times.tolist()]
        records = [
            record(time, bits, name, error, converged, iterations, "scaling" if name else found.numerics, raised)
            for (time, name), bits, error, converged, iterations, raised in zip(
                places,
                found.entropies,
                found.marginal_errors,
                found.converged,
                found.iterations,
                found.raised_limits,
                strict=True,
            )
        ]
        return DensityFrames(np.array([time for time, _ in places]), found.densities, records, self.surface)


def _halvings(instant: float) -> int:
    """Return the number of halvings that reach an instant; it is large if bisection does not."""
    # A float is a whole number divided by a power of two.
    return instant.as_integer_ratio()[1].bit_length() - 1
