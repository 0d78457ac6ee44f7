# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Painted weights as distributions on a surface: validation, statistics and display.

Solomon et al. 2015, section 5: a distribution on a triangle mesh is a density per vertex, and its mass is the sum of
density times area. All lengths are in scene units, those of the mesh's vertices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ...geometry.meshes.mesh import TriangleMesh
from ...progress import UNINTERRUPTED, Control
from ...sentence import Sentence
from ...transport import Surface
from ...transport.sharpening import entropy
from .density_memory import check_surface_memory

# Standard deviations of the kernel, in mean edge lengths. Below the first, it resolves edges instead of the surface;
# below the second, distances come out too short.
_LEAST_BLUR = 1.0
_GOOD_BLUR = 2.0


def density_surface(
    mesh: TriangleMesh, blur: float | None = None, substeps: int = 10, control: Control = UNINTERRUPTED
) -> Surface:
    """Return the surface on which densities of a mesh are defined.

    Parameters
    ----------
    mesh : TriangleMesh
        In scene units. Open, disconnected and non-manifold meshes and loose vertices are allowed.
    blur : float, optional
        Standard deviation of the kernel, per axis along the surface, in scene units; gamma is twice its square. By
        default it is chosen from the mesh.
    substeps : int
        Number of time steps of the kernel.
    control : Control
        Stops the work when cancelled.

    Raises
    ------
    InputError
        A mesh without area, or a blur shorter than the mesh's edges or longer than the surface.
    ResourceError
        The mesh needs more memory than is free.
    """
    check_surface_memory(mesh)
    if blur is None or not mesh.area > 0:
        return Surface(mesh.vertices, mesh.faces, None, substeps, control)
    size = mesh.root_area
    if not (np.isfinite(blur) and blur > 0):
        raise InputError("The blur must be a positive length, or left out.")
    if blur > size:
        raise InputError(
            "A blur of {blur:.3g} is longer than the whole surface is wide ({size:.3g}); take less than {most:.3g}.",
            blur=blur,
            size=size,
            most=0.2 * size,
        )
    edge = _mean_edge(mesh)
    if blur < _LEAST_BLUR * edge:
        raise InputError(
            "A blur of {blur:.3g} is finer than the mesh can carry: its edges are {edge:.3g} long on average. Take at "
            "least {least:.3g}, or subdivide the mesh.",
            blur=blur,
            edge=edge,
            # Increased, so that the value rounded for the message is still valid.
            least=1.01 * _LEAST_BLUR * edge,
        )
    return Surface(mesh.vertices, mesh.faces, 2.0 * (blur / size) ** 2, substeps, control)


def blur_of(surface: Surface) -> float:
    """Return the standard deviation of a surface's kernel, per axis, in scene units."""
    return float(surface.unit_length * np.sqrt(surface.gamma / 2.0))


def blur_notice(surface: Surface) -> Sentence | None:
    """Return a warning if the blur is so short for the mesh that distances come out too short, otherwise None."""
    blur, edge = blur_of(surface), surface.mean_edge_length * surface.unit_length
    if blur >= _GOOD_BLUR * edge:
        return None
    return Sentence(
        "The blur of {blur:.3g} is short for edges of {edge:.3g}: long distances come out too short. From {good:.3g} "
        "on they are right.",
        {"blur": blur, "edge": edge, "good": _GOOD_BLUR * edge},
    )


def distribution(weights: ArrayLike, surface: Surface, name: str) -> NDArray[np.float64]:
    """Return painted weights as a density of mass 1.

    Parameters
    ----------
    weights : (n,)
        One per vertex, in any scale; a density is returned unchanged. Weights on loose vertices, which have no area,
        are ignored.
    surface : Surface
        A surface of n vertices.
    name : str
        Name of the weights for messages: the vertex group.

    Returns
    -------
    (n,) float64
        Density; its sum times ``surface.weights`` is 1.

    Raises
    ------
    InputError
        The number of weights differs from that of the vertices, or weights are not finite, negative, all zero, or on
        loose vertices only.
    """
    painted = np.asarray(weights, dtype=np.float64)
    if painted.shape != surface.shape:
        raise InputError(
            "{name} has {count} weights and the mesh {vertices} vertices; read the group again from this mesh.",
            name=name,
            count=painted.size,
            vertices=surface.shape[0],
        )
    _check_values(painted, name)
    painted = np.where(surface.weights > 0, painted, 0.0)
    top = float(painted.max(initial=0.0))
    if not top > 0:
        raise InputError(
            "{name} has weight on loose vertices only, which have no area; paint some vertices that faces use.",
            name=name,
        )
    # Relative to the maximum, so that sums cannot overflow.
    painted = painted / top
    return painted / (painted @ surface.weights)


def _check_values(painted: NDArray[np.float64], name: str) -> None:
    bad = np.flatnonzero(~np.isfinite(painted))
    if len(bad):
        raise InputError(
            "{name} has weights that are not numbers (vertices: {count}, the first is {vertex}); paint them again.",
            name=name,
            count=len(bad),
            vertex=int(bad[0]),
        )
    negative = np.flatnonzero(painted < 0)
    if len(negative):
        raise InputError(
            "{name} has negative weights, down to {least:.3g} (vertices: {count}, the first is {vertex}); a density "
            "cannot be negative. Set them to zero.",
            name=name,
            least=float(painted.min()),
            count=len(negative),
            vertex=int(negative[0]),
        )
    if not painted.any():
        raise InputError("{name} is empty; paint some weight.", name=name)


@dataclass(frozen=True)
class DensityFigures:
    """Statistics of a density.

    Attributes
    ----------
    covered : float
        Fraction of the surface's area with any weight.
    entropy : float
        In nats; 0 for the uniform density and negative for all others.
    radius : float
        Radius of the uniform disc of the same entropy, in scene units: how far the density spreads.
    loose : int
        Number of vertices with weight but without area, whose weight is ignored.
    """

    covered: float
    entropy: float
    radius: float
    loose: int


def density_figures(weights: ArrayLike, surface: Surface, name: str) -> DensityFigures:
    """Return the statistics of painted weights, (n,); errors are those of :func:`distribution`."""
    density = distribution(weights, surface, name)
    found = entropy(density, surface.weights)
    return DensityFigures(
        covered=float(surface.weights[density > 0].sum()),
        entropy=found,
        radius=float(np.sqrt(surface.area * np.exp(found) / np.pi)),
        loose=int(np.count_nonzero((np.asarray(weights) > 0) & (surface.weights == 0))),
    )


@dataclass(frozen=True)
class HeatMap:
    """Values scaled to weights between 0 and 1, as vertex groups hold them.

    Attributes
    ----------
    weights : (n,) float64
        The largest is 1.
    scale : float
        Value of a weight of 1: the values are `weights` times this.
    """

    weights: NDArray[np.float64]
    scale: float


def heat_map(values: NDArray[np.float64]) -> HeatMap:
    """Scale a nonnegative density, (n,), for display as a heat map; an all-zero density stays zero."""
    top = float(values.max(initial=0.0))
    return HeatMap(values / top if top > 0 else np.zeros_like(values), top)


def _mean_edge(mesh: TriangleMesh) -> float:
    """Mean length of the triangles' sides, counted as in :class:`.transport.Surface`."""
    corners = mesh.corners
    return float(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).mean())
