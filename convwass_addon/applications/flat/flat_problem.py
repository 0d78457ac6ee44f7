# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What all blends of a flat morph have in common."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.flat_mending import FlatConnectivity
from ..morphs.layouts import Blend
from ..morphs.parts import SplitShapes
from ..morphs.transport_problem import TransportProblem
from .flat_lattice import FlatLattice
from .flat_layers import InputLayers, input_layers
from .flat_outlines import own_outline
from .flat_pieces import FlatPieces, flat_pieces
from .flat_settings import FlatSettings
from .flat_shapes import FlatImage, FlatInput
from .letters import matched_letters

# A shape, or a letter, of fewer cells is none any more.
_LEAST_CELLS = 20.0


@dataclass(frozen=True)
class FlatProblem:
    """Flat shapes on a plane grid: volumes are areas in cells, or masses of images.

    Attributes
    ----------
    transport : TransportProblem
        The shapes as distributions, and how to blend them.
    connectivity : tuple of FlatConnectivity
        How every shape is connected at this resolution.
    silhouettes : tuple of float
        Area in cells of what of every shape is at least half full.
    layers : tuple of InputLayers
        Where every shape has which color, where colors are carried and there are several.
    motion : mapping
        What records say about the motion that was chosen; empty where none was asked for.
    """

    transport: TransportProblem
    connectivity: tuple[FlatConnectivity, ...]
    silhouettes: tuple[float, ...]
    layers: tuple[InputLayers, ...]
    motion: Mapping[str, object] = field(default_factory=dict)

    @property
    def lattice(self) -> FlatLattice:
        """Where the cells of the shapes are."""
        return self.transport.lattice

    @property
    def settings(self) -> FlatSettings:
        """How to blend the shapes."""
        return self.transport.settings

    def on(self, lattice: FlatLattice, layers: tuple[InputLayers, ...]) -> FlatProblem:
        """Return the same problem with a grid of the same cells and more of them, and its layers there."""
        return replace(self, transport=replace(self.transport, lattice=lattice), layers=layers)

    def blend_areas(self, blend: Blend) -> NDArray[np.float64]:
        """Areas of the parts of a blend in cells, (p,); where densities are asked for, their masses.

        Lengths go evenly from one shape to the other: the barycenter of a shape and its double is one and a half times
        as large. So it is the roots of areas that are interpolated. Masses are themselves.
        """
        if self.settings.output == "densities":
            return self.transport.blend_volumes(blend)
        return np.array([interpolated_area(blend.weights, part.volumes) for part in self.transport.parts])

    def fullness(self, blend: Blend) -> float:
        """How many times larger the silhouette of a blend is than its mass in full cells: more than 1 for gray ones."""
        silhouette = interpolated_area(blend.weights, self.silhouettes)
        return silhouette / interpolated_area(blend.weights, self.transport.volumes)


def interpolated_area(weights: Sequence[float], areas: Sequence[float] | NDArray[np.float64]) -> float:
    """Interpolate areas as squares of lengths."""
    return float(np.dot(weights, np.sqrt(areas)) ** 2)


def pieces_of(shapes: Sequence[FlatInput], names: Sequence[str], settings: FlatSettings) -> list[FlatPieces]:
    """Return what of every shape is transported, in its parts.

    Raises
    ------
    InputError
        Shapes or words that cannot work.
    """
    letters = matched_letters(shapes, names) if settings.words == "letters" else [None] * len(shapes)
    return [flat_pieces(*each) for each in zip(shapes, names, letters, strict=True)]


def flat_problem(
    shapes: Sequence[FlatInput], pieces: Sequence[FlatPieces], names: Sequence[str], settings: FlatSettings
) -> FlatProblem:
    """Rasterize shapes on one grid, and read how they are connected.

    Parameters
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs.
    pieces : sequence of FlatPieces
        What of them is transported; see :func:`pieces_of`.
    names : sequence of str
        What messages call them.
    settings : FlatSettings
        How.

    Raises
    ------
    InputError
        Shapes that are too small beside the others, or settings that cannot work.
    """
    lattice = FlatLattice.around(pieces, settings.resolution, settings.sigma)
    every = [
        own.densities(lattice.origin + center, lattice.spacing, lattice.shape)
        for own, center in zip(pieces, lattice.centers, strict=True)
    ]
    for name, own in zip(names, every, strict=True):
        if min(float(part.sum()) for part in own) < _LEAST_CELLS:
            raise InputError(
                "'{name}', or a letter of it, is too small beside the others on this grid. Set Scale to Equal Volume "
                "(--scale equal-volume), scale it up, or use a finer resolution.",
                name=name,
            )
    count = len(every[0])
    split = SplitShapes(
        tuple(f"letter {index + 1}" for index in range(count)) if count > 1 else ("all",),
        tuple([own[index] for own in every] for index in range(count)),
        np.array([[own[index].sum() for own in every] for index in range(count)]),
        (),
    )
    silhouettes = tuple(_silhouette(shape, sum(own)) for shape, own in zip(shapes, every, strict=True))
    transport = TransportProblem.of(split, lattice, settings)
    return FlatProblem(
        transport,
        tuple(
            FlatConnectivity.of(own_outline(transport.occupancy(index), area)) for index, area in enumerate(silhouettes)
        ),
        silhouettes,
        input_layers(shapes, lattice.centers, lattice) if settings.carry else (),
    )


def _silhouette(shape: FlatInput, occupancy: NDArray[np.float64]) -> float:
    """Area in cells of what is at least half as full as it can be: all of it, unless there are grays."""
    if not (isinstance(shape, FlatImage) and shape.kind == "density"):
        return float(occupancy.sum())
    half = 0.5 * min(1.0, float(occupancy.max()))
    return float(np.clip((occupancy - half) / half + 0.5, 0.0, 1.0).sum())
