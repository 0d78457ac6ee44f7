# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials between others: every lobe is the Wasserstein barycenter of theirs (Solomon et al. 2015, section 7)."""

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
from .lobe_table import LobeTable, incoming_directions, tabulated
from .materials import Material
from .reflectance_settings import ReflectanceSettings

_FEWEST, _MOST = 2, 4
# What rounding leaves in weights that stand for zero.
_NO_WEIGHT = 1e-9
# Densities below this share of a lobe's largest are nothing.
_NO_LIGHT = 1e-9


@dataclass(frozen=True)
class InterpolatedLobes:
    """A material between others.

    Attributes
    ----------
    table : LobeTable
        Its lobes and, mixed in proportion to the weights, how much light they carry.
    weights : (k,) float64
        Of the materials; sum 1.
    starts : tuple of Barycenter
        Per incoming direction, to start the same directions from at other weights.
    record : dict
        Figures ready for JSON: settings, iterations, errors, entropies and what the bound did.
    notices : tuple of Sentence
        What the user should know.
    """

    table: LobeTable
    weights: NDArray[np.float64]
    starts: tuple[Barycenter, ...]
    record: dict[str, object]
    notices: tuple[Sentence, ...] = ()

    __repr__ = one_line("table", "weights", "notices")


class LobeBlend:
    """Two to four tabulated materials, prepared once for any weights.

    Parameters
    ----------
    tables : sequence of LobeTable
        Of the same directions and resolution.
    settings : ReflectanceSettings
        `rows`, `incoming` and `turns` of which are those of the tables already.

    Raises
    ------
    InputError
        Too few or too many materials, or tables that do not fit each other.
    """

    def __init__(self, tables: Sequence[LobeTable], settings: ReflectanceSettings) -> None:
        if not _FEWEST <= len(tables) <= _MOST:
            raise InputError("Choose two to four materials, not {count}.", count=len(tables))
        if not all(table.fits(tables[0]) for table in tables[1:]):
            raise InputError("These tables have other directions than the first one; tabulate them alike.")
        self.tables = tuple(tables)
        self.settings = settings
        self.domain = Sphere(tables[0].rows, settings.sigma, part="upper")
        lobes = np.stack([table.lobes for table in tables], axis=1)
        # What is far out in a highlight's tail carries no light, but is a long way for scalings to reach.
        lobes[lobes < _NO_LIGHT * lobes.max(axis=(2, 3), keepdims=True)] = 0.0
        self._inputs = [Inputs.of(own, self.domain) for own in lobes]

    @classmethod
    def of(cls, materials: Sequence[Material], settings: ReflectanceSettings) -> LobeBlend:
        """Tabulate materials; for several azimuths where any of them has a grain.

        Raises
        ------
        InputError
            Fewer than two materials, or more than four.
        """
        if not _FEWEST <= len(materials) <= _MOST:
            raise InputError("Choose two to four materials, not {count}.", count=len(materials))
        grainless = all(material.is_isotropic for material in materials)
        incoming = incoming_directions(settings.incoming, 1 if grainless else settings.turns)
        return cls([tabulated(material, incoming, settings.rows) for material in materials], settings)

    def __len__(self) -> int:
        """How many incoming directions there are."""
        return len(self._inputs)

    def steps(
        self, weights: ArrayLike, before: InterpolatedLobes | None = None, control: Control = UNINTERRUPTED
    ) -> Work[InterpolatedLobes]:
        """Interpolate at some weights.

        Parameters
        ----------
        weights : (k,)
            Of the materials; not negative, not all zero.
        before : InterpolatedLobes, optional
            At other weights, to start from.
        control : Control
            Ends the work when cancelled.

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
            Weights that make no sense.
        """
        alphas = blend_weights(weights, len(self.tables))
        solved: list[Barycenter] = []
        lobes, exponents = [], []
        for index in range(len(self)):
            values = {"done": index + 1, "total": len(self)}
            yield Progress(index / len(self), Sentence("Direction {done} of {total}", values))
            # Neighboring directions help each other only without a grain, along which highlights would have to turn.
            neighbor = solved[-1] if solved and self.tables[0].is_isotropic else None
            start = before.starts[index] if before is not None else neighbor
            found = self._solved(index, alphas, start, control)
            exponent = self._exponent(index, alphas, found)
            solved.append(found)
            exponents.append(exponent)
            lobes.append(self._bounded(found.density, exponent) / self.domain.area)
        if alphas.max() == 1.0:
            # A material alone is itself, also in what the kernel blurs.
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
        # A bound inside the iteration bends lobes into horns, or does not converge: it is applied to what comes out.
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
    """Mix materials as a Mix Shader does, to compare with: highlights fade in and out where they are.

    Raises
    ------
    InputError
        Weights that make no sense.
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
    """Check weights and make their sum 1; what rounding has left of a zero becomes one.

    Raises
    ------
    InputError
        There are not as many as materials, or they are negative, no numbers or all zero.
    """
    alphas = np.asarray(weights, dtype=np.float64)
    if alphas.shape != (count,):
        raise InputError("There must be one weight for each of the {count} materials.", count=count)
    if not np.isfinite(alphas).all() or (alphas < 0).any() or not alphas.any():
        raise InputError("Weights must be zero or positive numbers, and one of them positive.")
    alphas = alphas / alphas.sum()
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
