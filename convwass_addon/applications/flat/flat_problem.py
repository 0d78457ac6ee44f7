# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all blends of a flat morph have in common."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.flat_mending import FlatConnectivity
from ..morphs.layouts import Blend
from ..morphs.morph_problem import MorphProblem
from ..morphs.parts import SplitShapes
from .flat_lattice import FlatLattice
from .flat_pieces import flat_pieces
from .flat_reading import flat_frame, flat_input_frame, own_outline
from .flat_regions import InputLayers, input_layers
from .flat_settings import FlatSettings
from .flat_shapes import FlatImage, FlatInput
from .letters import matched_letters

# A shape, or a letter, of fewer cells is none any more.
_LEAST_CELLS = 20.0


@dataclass(frozen=True)
class FlatProblem(MorphProblem):
    """The same as for solids, on a plane grid: volumes are areas in cells, or masses of images.

    Attributes
    ----------
    lattice : FlatLattice
        Where the cells of the shapes are.
    settings : FlatSettings
        How to blend them.
    connectivity : tuple of FlatConnectivity
        How every shape hangs together at this resolution.
    silhouettes : tuple of float
        Area in cells of what of every shape is at least half full.
    layers : tuple of InputLayers
        Where every shape has which color, where colors are carried and there are several.
    """

    silhouettes: tuple[float, ...] = ()
    layers: tuple[InputLayers, ...] = ()

    def shape_connectivity(self, index: int) -> FlatConnectivity:
        """Read how shape `index` hangs together, from all of its parts."""
        return FlatConnectivity.of(own_outline(self.occupancy(index), self.silhouettes[index]))

    def blend_volumes(self, blend: Blend) -> NDArray[np.float64]:
        """Areas of the parts of a blend in cells, (p,); where densities are asked for, their masses.

        Lengths go evenly from one shape to the other: the barycenter of a shape and its double is one and a half times
        as large. So it is the roots of areas that are interpolated. Masses are themselves.
        """
        if self.settings.output == "densities":
            return super().blend_volumes(blend)
        return np.array([_between(blend.weights, part.volumes) for part in self.parts])

    def fullness(self, blend: Blend) -> float:
        """How many times larger the silhouette of a blend is than its mass in full cells: more than 1 for gray ones."""
        return _between(blend.weights, self.silhouettes) / _between(blend.weights, self.volumes)


def _between(weights: Sequence[float], areas: Sequence[float] | NDArray[np.float64]) -> float:
    return float(np.dot(weights, np.sqrt(areas)) ** 2)


def flat_problem(shapes: Sequence[FlatInput], names: Sequence[str], settings: FlatSettings) -> FlatProblem:
    """Rasterize shapes on one grid, and read how they hang together.

    Raises
    ------
    InputError
        Shapes, words or settings that cannot work.
    """
    letters = matched_letters(shapes, names) if settings.words == "letters" else [None] * len(shapes)
    pieces = [flat_pieces(*each) for each in zip(shapes, names, letters, strict=True)]
    lattice = FlatLattice.around(pieces, settings.resolution, settings.sigma)
    every = [
        own.densities(lattice.origin + center, lattice.spacing, lattice.shape)
        for own, center in zip(pieces, lattice.centers, strict=True)
    ]
    for name, own in zip(names, every, strict=True):
        if min(float(part.sum()) for part in own) < _LEAST_CELLS:
            raise InputError(
                "'{name}', or a letter of it, is too small beside the others at this resolution; use a finer one, or "
                "scale it up.",
                name=name,
            )
    count = len(every[0])
    split = SplitShapes(
        tuple(f"letter {index + 1}" for index in range(count)) if count > 1 else ("all",),
        tuple([own[index] for own in every] for index in range(count)),
        np.array([[own[index].sum() for own in every] for index in range(count)]),
        (),
    )
    problem = FlatProblem.for_sketches(split, lattice, settings)
    problem = replace(
        problem,
        silhouettes=tuple(_silhouette(shape, sum(own)) for shape, own in zip(shapes, every, strict=True)),
        layers=input_layers(shapes, lattice.centers, lattice) if settings.carry else (),
        reader=flat_frame,
        input_reader=flat_input_frame,
    )
    return problem.with_connectivity()


def _silhouette(shape: FlatInput, occupancy: NDArray[np.float64]) -> float:
    """Area in cells of what is at least half as full as it can be: all of it, unless there are grays."""
    if not (isinstance(shape, FlatImage) and shape.kind == "density"):
        return float(occupancy.sum())
    half = 0.5 * min(1.0, float(occupancy.max()))
    return float(np.clip((occupancy - half) / half + 0.5, 0.0, 1.0).sum())
