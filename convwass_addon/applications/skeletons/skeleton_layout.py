# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lay out the free joints of a skeleton by Wasserstein propagation (Solomon et al. 2015, section 7)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.mean_value import mean_value_coordinates, positive_coordinates
from ...progress import UNINTERRUPTED, Control
from ...transport import KernelTooNarrowError, Propagation, Surface, propagate
from ...transport.sharpening import entropy
from ..workers import one_blas_thread
from .skeleton_bodies import SkeletonBody
from .skeleton_graph import JointGraph
from .skeleton_links import Links, spread_along
from .skeleton_settings import SkeletonSettings

# If the kernel is too narrow, it is widened by this factor, at most this often.
_WIDER, _WIDENINGS = 2.0, 4


@dataclass(frozen=True)
class Layout:
    """Joints at the means of their distributions.

    Attributes
    ----------
    positions : (v, 3) float64
        Spaced along the chains in proportion to the lengths of the bones; pins are unchanged.
    gamma : float
        Value used for the solve.
    links : int
        Number of links that the bones were divided into.
    solution : Propagation
        Distributions of the joints and of the ends of links.
    """

    positions: NDArray[np.float64]
    gamma: float
    links: int
    solution: Propagation


class LayoutProblem:
    """A skeleton and the body's surface, prepared for solving with several kernels.

    Parameters
    ----------
    graph : JointGraph
        Every connected component must have pins.
    body : SkeletonBody
        The body that contains the pins.
    settings : SkeletonSettings
        Settings of the layout.
    """

    def __init__(self, graph: JointGraph, body: SkeletonBody, settings: SkeletonSettings) -> None:
        self._graph = graph
        self._settings = settings
        self._vertices = body.surface.vertices
        self._surface = Surface(body.surface.vertices, body.surface.faces, settings.gamma)
        self.lengths = bone_lengths(graph, settings)
        self._links = Links.of(graph, self.lengths, settings.links)
        self._pins = np.flatnonzero(graph.pinned)
        points = graph.positions[self._pins]
        coordinates = mean_value_coordinates(points, body.surface)
        shares = positive_coordinates(coordinates, points, self._vertices)
        areas = self._surface.weights
        self._given = dict(zip(self._pins.tolist(), shares / np.where(areas > 0, areas, 1.0), strict=True))

    def solved(self, gamma: float, control: Control = UNINTERRUPTED) -> Layout:
        """Solve with a kernel, or with a wider one if it is too narrow."""
        for _ in range(_WIDENINGS):
            try:
                return self._solved(gamma, control)
            except KernelTooNarrowError:
                gamma *= _WIDER
        return self._solved(gamma, control)

    def _solved(self, gamma: float, control: Control) -> Layout:
        surface = self._surface.with_kernel(gamma)
        with one_blas_thread():
            solution = propagate(
                self._links.edges,
                self._links.weights,
                self._given,
                surface,
                size=self._links.size,
                entropy_limit=self._limit(surface),
                tolerance=self._settings.tolerance,
                max_iterations=self._settings.max_iterations,
                control=control,
            )
        means = (solution.densities * surface.weights) @ self._vertices
        means[self._pins] = self._graph.positions[self._pins]
        positions = spread_along(self._graph, self._links, means, self.lengths)
        return Layout(positions, gamma, len(self._links.edges), solution)

    def _limit(self, surface: Surface) -> float | None:
        if self._settings.slack is None:
            return None
        return max(entropy(density, surface.weights) for density in self._given.values()) + self._settings.slack


def bone_lengths(graph: JointGraph, settings: SkeletonSettings) -> NDArray[np.float64]:
    """Relative target lengths of the bones, (e,), all positive."""
    lengths = graph.lengths
    if settings.weights == "uniform" or not lengths.max() > 0:
        return np.ones(len(lengths))
    return np.maximum(lengths, 0.05 * lengths.mean())
