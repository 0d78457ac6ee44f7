# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The problem shared by all blends of a flat morph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...geometry.level_sets.flat_mending import FlatConnectivity
from ...geometry.plane.outlines import Outline
from ..morphs.interpolated_volumes import interpolated_volumes
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

# Shapes and letters of fewer cells are rejected.
_LEAST_CELLS = 20.0


@dataclass(frozen=True)
class FlatProblem:
    """Flat shapes on a plane grid; their volumes are areas in cells, or masses of images.

    Attributes
    ----------
    transport : TransportProblem
        The shapes as distributions, and how to blend them.
    outlines : tuple of Outline
        Outline of every shape at this resolution, scene units.
    connectivity : tuple of FlatConnectivity
        Connectivity of these outlines.
    silhouettes : tuple of float
        Area of every shape's silhouette in cells: where it is at least half full.
    layers : tuple of InputLayers
        The layers of every shape, if several colors are carried.
    motion : mapping
        Figures of the chosen motion for records; empty if transport was requested.
    """

    transport: TransportProblem
    outlines: tuple[Outline, ...]
    connectivity: tuple[FlatConnectivity, ...]
    silhouettes: tuple[float, ...]
    layers: tuple[InputLayers, ...]
    motion: Mapping[str, object] = field(default_factory=dict)

    @property
    def lattice(self) -> FlatLattice:
        """The grid of the shapes."""
        return self.transport.lattice

    @property
    def settings(self) -> FlatSettings:
        """The settings of the morph."""
        return self.transport.settings

    def on(self, lattice: FlatLattice, layers: tuple[InputLayers, ...]) -> FlatProblem:
        """Return the same problem on a larger grid of the same cells, with layers for that grid."""
        return replace(self, transport=replace(self.transport, lattice=lattice), layers=layers)

    def blend_areas(self, blend: Blend) -> NDArray[np.float64]:
        """Return the areas of the parts of a blend in cells, (p,), or their masses if densities are requested.

        Lengths are interpolated linearly: the barycenter of a shape and a copy of twice its size is 1.5 times as large.
        Therefore the square roots of areas are interpolated. Masses are interpolated directly.
        """
        if self.settings.output == "densities":
            return interpolated_volumes(blend.weights, [part.volumes for part in self.transport.parts], "volume")
        return np.array([interpolated_area(blend.weights, part.volumes) for part in self.transport.parts])

    def fullness(self, blend: Blend) -> float:
        """Return the ratio of a blend's silhouette to its mass in full cells, which exceeds 1 for gray images."""
        silhouette = interpolated_area(blend.weights, self.silhouettes)
        return silhouette / interpolated_area(blend.weights, self.transport.volumes)

    def silhouette(self, blend: Blend) -> float:
        """Return the area that the outline of a blend of moved shapes encloses, in cells."""
        return float(self.blend_areas(blend).sum()) * self.fullness(blend)


def interpolated_area(weights: Sequence[float], areas: Sequence[float] | NDArray[np.float64]) -> float:
    """Interpolate the square roots of areas, and return the squares."""
    return float(np.dot(weights, np.sqrt(areas)) ** 2)


def pieces_of(shapes: Sequence[FlatInput], names: Sequence[str], settings: FlatSettings) -> list[FlatPieces]:
    """Return the transported parts of every shape.

    Raises
    ------
    InputError
        Invalid shapes or words.
    """
    letters = matched_letters(shapes, names) if settings.words == "letters" else [None] * len(shapes)
    return [flat_pieces(*each) for each in zip(shapes, names, letters, strict=True)]


def flat_problem(
    shapes: Sequence[FlatInput], pieces: Sequence[FlatPieces], names: Sequence[str], settings: FlatSettings
) -> FlatProblem:
    """Rasterize shapes on one grid, and determine their connectivity.

    Parameters
    ----------
    shapes : sequence of FlatShape or FlatImage
        The inputs.
    pieces : sequence of FlatPieces
        Their transported parts; see :func:`pieces_of`.
    names : sequence of str
        Names of the shapes, for messages.
    settings : FlatSettings
        Settings of the morph.

    Raises
    ------
    InputError
        Shapes that are too small compared with the others, or invalid settings.
    """
    lattice = FlatLattice.around(pieces, settings.resolution, settings.sigma)
    every = [
        own.densities(lattice.origin + center, lattice.spacing, lattice.shape)
        for own, center in zip(pieces, lattice.centers, strict=True)
    ]
    for name, own in zip(names, every, strict=True):
        if min(float(part.sum()) for part in own) < _LEAST_CELLS:
            raise InputError(
                "'{name}', or a letter of it, is too small next to the others on this grid. Set Scale to Equal Volume "
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
    drawn = [own_outline(transport.occupancy(index), area) for index, area in enumerate(silhouettes)]
    return FlatProblem(
        transport,
        tuple(lattice.to_scene(own.outline, alone) for own, alone in zip(drawn, np.eye(len(drawn)), strict=True)),
        tuple(map(FlatConnectivity.of, drawn)),
        silhouettes,
        input_layers(shapes, lattice) if settings.carry else (),
    )


def _silhouette(shape: FlatInput, occupancy: NDArray[np.float64]) -> float:
    """Return the area in cells that is at least half full; without grays this is the whole area."""
    if not (isinstance(shape, FlatImage) and shape.kind == "density"):
        return float(occupancy.sum())
    half = 0.5 * min(1.0, float(occupancy.max()))
    return float(np.clip((occupancy - half) / half + 0.5, 0.0, 1.0).sum())
