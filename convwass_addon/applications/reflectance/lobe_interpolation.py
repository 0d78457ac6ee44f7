# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Interpolate materials by Wasserstein barycenters of their lobes (Solomon et al. 2015, section 7)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...one_line import one_line
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ...transport import Inputs, KernelTooNarrowError, Sphere
from ...transport.barycenter import Barycenter, barycenter
from ...transport.sharpening import entropy, sharpening_exponent
from ..blend_weights import normalized_weights
from .lobe_table import LobeTable, incoming_directions, tabulated
from .materials import Material
from .reflectance_settings import ReflectanceSettings

_FEWEST, _MOST = 2, 4
# Weights below this are rounding errors of zero.
_NO_WEIGHT = 1e-9
# Densities below this fraction of a lobe's maximum are set to zero.
_NO_LIGHT = 1e-9


@dataclass(frozen=True)
class InterpolatedLobes:
    """A material interpolated between others.

    Attributes
    ----------
    table : LobeTable
        Its lobes, with albedos that are linear in the weights.
    weights : (k,) float64
        Weights of the materials; sum 1.
    starts : tuple of Barycenter
        One barycenter per incoming direction, to start from at other weights.
    record : dict
        JSON-ready figures: settings, iterations, errors, entropies and exponents of the bound.
    notices : tuple of Sentence
        Warnings for the user.
    """

    table: LobeTable
    weights: NDArray[np.float64]
    starts: tuple[Barycenter, ...]
    record: dict[str, object]
    notices: tuple[Sentence, ...] = ()

    __repr__ = one_line("table", "weights", "notices")


class LobeBlend:
    """Two to four tabulated materials, prepared for blending with any weights.

    Parameters
    ----------
    tables : sequence of LobeTable
        With equal directions and resolution.
    settings : ReflectanceSettings
        Its `rows`, `incoming` and `turns` must be those of the tables.

    Raises
    ------
    InputError
        Too few or too many materials, or tables that do not match.
    """

    def __init__(self, tables: Sequence[LobeTable], settings: ReflectanceSettings) -> None:
        if not _FEWEST <= len(tables) <= _MOST:
            raise InputError("Choose two to four materials, not {count}.", count=len(tables))
        if not all(table.fits(tables[0]) for table in tables[1:]):
            raise InputError("The tables have different directions; tabulate all materials with the same settings.")
        self.tables = tuple(tables)
        self.settings = settings
        self.domain = Sphere(tables[0].rows, settings.sigma, part="upper")
        lobes = np.stack([table.lobes for table in tables], axis=1)
        # The far tail of a highlight carries no light, but its distance would make scalings underflow.
        lobes[lobes < _NO_LIGHT * lobes.max(axis=(2, 3), keepdims=True)] = 0.0
        self._inputs = [Inputs.of(own, self.domain) for own in lobes]

    @classmethod
    def of(cls, materials: Sequence[Material], settings: ReflectanceSettings) -> LobeBlend:
        """Tabulate materials, for several azimuths if any of them is anisotropic.

        Raises
        ------
        InputError
            Fewer than two materials, or more than four.
        """
        if not _FEWEST <= len(materials) <= _MOST:
            raise InputError("Choose two to four materials, not {count}.", count=len(materials))
        is_isotropic = all(material.is_isotropic for material in materials)
        incoming = incoming_directions(settings.incoming, 1 if is_isotropic else settings.turns)
        return cls([tabulated(material, incoming, settings.rows) for material in materials], settings)

    def __len__(self) -> int:
        """Return the number of incoming directions."""
        return len(self._inputs)

    def steps(
        self, weights: ArrayLike, before: InterpolatedLobes | None = None, control: Control = UNINTERRUPTED
    ) -> Work[InterpolatedLobes]:
        """Interpolate at given weights.

        Parameters
        ----------
        weights : (k,)
            Weights of the materials; nonnegative, not all zero.
        before : InterpolatedLobes, optional
            Result at other weights, to start from.
        control : Control
            Stops the work when cancelled.

        Yields
        ------
        Progress
            Before every direction.

        Returns
        -------
        InterpolatedLobes

        Raises
        ------
        InputError
            Invalid weights.
        """
        alphas = blend_weights(weights, len(self.tables))
        solved: list[Barycenter] = []
        lobes, exponents = [], []
        for index in range(len(self)):
            values = {"done": index + 1, "total": len(self)}
            yield Progress(index / len(self), Sentence("Direction {done} of {total}", values))
            # For anisotropic materials the previous direction is no good start, because highlights would have to turn.
            neighbor = solved[-1] if solved and self.tables[0].is_isotropic else None
            start = before.starts[index] if before is not None else neighbor
            found = self._solved(index, alphas, start, control)
            exponent = self._exponent(index, alphas, found)
            solved.append(found)
            exponents.append(exponent)
            lobes.append(self._bounded(found.density, exponent) / self.domain.area)
        if alphas.max() == 1.0:
            # A single material is reproduced exactly, without the kernel's blur.
            lobes = list(self.tables[int(alphas.argmax())].lobes)
        table = replace(self.tables[0], lobes=np.array(lobes), albedo=_mixed_albedo(self.tables, alphas))
        record = self._record(alphas, solved, exponents, table)
        return InterpolatedLobes(table, alphas, tuple(solved), record, _notices(solved))

    def _solved(
        self, index: int, alphas: NDArray[np.float64], start: Barycenter | None, control: Control
    ) -> Barycenter:
        try:
            return self._barycenter(index, alphas, start, control)
        except KernelTooNarrowError:
            if start is None:
                raise InputError("The highlights are too far apart for this blur; blur the lobes more.") from None
        return self._solved(index, alphas, None, control)

    def _barycenter(
        self, index: int, alphas: NDArray[np.float64], start: Barycenter | None, control: Control
    ) -> Barycenter:
        # A bound inside the iteration distorts lobes or does not converge, so it is applied to the result.
        return barycenter(
            self._inputs[index],
            alphas,
            self.domain,
            sharpness=self.settings.sharpness,
            tolerance=self.settings.tolerance,
            max_iterations=self.settings.max_iterations,
            numerics="scaling",
            initial=start,
            control=control,
        )

    def _exponent(self, index: int, alphas: NDArray[np.float64], found: Barycenter) -> float:
        if self.settings.entropy_limit == "free":
            return 1.0
        own = self._inputs[index].entropies[alphas > 0]
        limit = own.max() if self.settings.entropy_limit == "largest" else alphas[alphas > 0] @ own
        with np.errstate(divide="ignore"):
            logs = np.log(found.density)
        return sharpening_exponent(logs, float(limit), self.domain.weights)

    def _bounded(self, density: NDArray[np.float64], exponent: float) -> NDArray[np.float64]:
        if exponent == 1.0:
            return density
        power = (density / density.max()) ** exponent
        return power / (power * self.domain.weights).sum()

    def _record(
        self, alphas: NDArray[np.float64], solved: list[Barycenter], exponents: list[float], table: LobeTable
    ) -> dict[str, object]:
        return {
            "settings": self.settings.as_dict(),
            "weights": alphas.tolist(),
            "directions": len(self),
            "isotropic": table.is_isotropic,
            "iterations": [list(found.iterations) for found in solved],
            "marginal_error": max(found.marginal_error for found in solved),
            "converged": all(found.converged for found in solved),
            "entropies": [entropy(lobe * self.domain.area, self.domain.weights) for lobe in table.lobes],
            "exponents": exponents,
        }


def linear_lobes(tables: Sequence[LobeTable], weights: ArrayLike) -> LobeTable:
    """Mix materials linearly, like a Mix Shader, for comparison: highlights fade in place.

    Raises
    ------
    InputError
        Invalid weights.
    """
    alphas = blend_weights(weights, len(tables))
    albedo = _mixed_albedo(tables, alphas)
    grey = sum(
        w * table.albedo.sum(axis=1)[:, None, None] * table.lobes for w, table in zip(alphas, tables, strict=True)
    )
    mass = (grey * tables[0].cells).sum(axis=(1, 2), keepdims=True)
    return replace(tables[0], lobes=grey / np.where(mass > 0, mass, 1.0), albedo=albedo)


def _mixed_albedo(tables: Sequence[LobeTable], alphas: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.tensordot(alphas, np.stack([table.albedo for table in tables]), 1)


def blend_weights(weights: ArrayLike, count: int) -> NDArray[np.float64]:
    """Validate weights and normalize them to sum 1; rounding errors of zero become zero.

    Raises
    ------
    InputError
        The wrong number of weights, or weights that are negative, not finite or all zero.
    """
    alphas = normalized_weights(weights, count)
    alphas[alphas < _NO_WEIGHT] = 0.0
    return alphas / alphas.sum()


def _notices(solved: Sequence[Barycenter]) -> tuple[Sentence, ...]:
    open_ends = sum(not found.converged for found in solved)
    if not open_ends:
        return ()
    values = {"count": open_ends, "total": len(solved), "error": max(found.marginal_error for found in solved)}
    return (
        Sentence(
            "{count} of {total} lobes did not converge (error {error:.2g}); allow more iterations or blur more.", values
        ),
    )
