# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangle meshes as a domain of transport: heat flows along the surface, by implicit Euler steps."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import diags_array

from ..geometry.edges import vertex_components
from ..geometry.factorization import factorize
from ..geometry.laplacian import Laplacian, laplacian
from ..geometry.mesh import TriangleMesh
from .domain import HEADROOM, LOG_NOTHING, NEGLIGIBLE, KernelTooNarrowError, floored_log
from .matern import cost_slope, kernel_distance, squared_distance
from .region import Region, through_whole_arrays

# Below this gamma the blur of a large shape is finer than an artist would ask for, and long distances suffer.
_SMALLEST_DEFAULT_GAMMA = 0.01
# The kernel of the default number of steps is right up to distances of about gamma over the mean edge length.
_GAMMA_PER_EDGE_LENGTH = 0.7
# A dense kernel of 2500 vertices takes 50 MB; its rows are handled in blocks of this many values.
_DENSE_VERTICES = 2500
_BLOCK = 1 << 22


class Surface:
    """A triangle mesh, of any topology, with or without boundary, in one piece or several.

    Lengths of the domain are those of the mesh rescaled to unit area. The heat kernel at time t = gamma / 4, for which
    -gamma ln H goes to the squared geodesic distance (Varadhan), is applied by `steps` implicit Euler steps, each the
    solution of (D_a + t / steps L) x = a * y over one sparse Cholesky factorization (Solomon et al. 2015, section 5,
    with the corrected time). L is positive semi-definite and has no positive off-diagonal, so no heat is ever negative
    and its tail is right to many digits.

    Parameters
    ----------
    vertices : (n, 3)
        Positions, in any unit.
    faces : (m, 3)
        Vertex indices. Degenerate triangles, edges of more than two triangles, and vertices that no triangle uses are
        fine; the latter hold no mass.
    gamma : float, optional
        Entropic regularization in units of the mesh rescaled to unit area; the blur has a standard deviation of
        sqrt(gamma / 2) per axis. By default proportional to the edge length, as the paper's rule is:
        max(0.01, 0.7 x mean edge length).
    steps : int
        Implicit Euler steps per application of the kernel. More steps make long distances truer: the relative
        shortfall at distance d is about d^2 / (11 gamma steps).

    Attributes
    ----------
    mesh : TriangleMesh
        As given.
    laplacian : Laplacian
        Stiffness and vertex areas in the units of the vertices.
    area : float
        Total area in the units of the vertices, squared.
    mean_edge_length : float
        In lengths of the domain.
    solver : str
        The factorization in use.

    Raises
    ------
    InputError
        Arrays that are no mesh, or a mesh without any area.
    ValueError
        `gamma` is not a positive number or `steps` not a positive whole number.
    """

    has_quadratic_cost = False
    relaxation = 1.0
    far_numerics = "dense log domain"

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, gamma: float | None = None, steps: int = 10) -> None:
        mesh = TriangleMesh.from_arrays(vertices, faces)
        self._build(mesh, laplacian(mesh), gamma, steps)

    def with_kernel(self, gamma: float | None = None, steps: int = 10) -> Surface:
        """Return the same mesh with another kernel; the Laplacian is shared."""
        other = object.__new__(Surface)
        other._build(self.mesh, self.laplacian, gamma, steps)
        return other

    def _build(self, mesh: TriangleMesh, stiffness: Laplacian, gamma: float | None, steps: int) -> None:
        self.mesh = mesh
        self.laplacian = stiffness
        self.shape = (len(mesh.vertices),)
        self.area = float(stiffness.areas.sum())
        self.unit_length = float(np.sqrt(self.area))
        self.mean_edge_length = _mean_edge_length(mesh) / self.unit_length
        if gamma is None:
            gamma = max(_SMALLEST_DEFAULT_GAMMA, _GAMMA_PER_EDGE_LENGTH * self.mean_edge_length)
        self.gamma = float(gamma)
        self.steps = int(steps)
        if not (np.isfinite(self.gamma) and self.gamma > 0):
            raise ValueError(f"gamma must be a positive number, got {gamma}")
        if self.steps < 1 or self.steps != steps:
            raise ValueError(f"steps must be a positive whole number, got {steps}")
        self.weights = stiffness.areas / self.area
        self._used = np.flatnonzero(stiffness.areas > 0)
        self._area_weights = np.ascontiguousarray(self.weights[self._used])
        # L does not change when lengths are rescaled, areas do.
        part = stiffness.matrix[self._used][:, self._used]
        system = diags_array(self._area_weights) + (self.gamma / 4.0 / self.steps) * part
        self._factor = factorize(system.tocsc())
        self.solver = self._factor.name
        self.factor_bytes = self._factor.factor_bytes

    @property
    def positions(self) -> NDArray[np.float64]:
        """The vertices, (n, 3)."""
        return self.mesh.vertices

    @cached_property
    def pieces(self) -> NDArray[np.int64] | None:
        """The connected piece of every vertex, -1 for unused ones; None where there is only one piece."""
        labels = vertex_components(self.mesh)
        return labels if labels.max() > 0 else None

    def apply(self, columns: ArrayLike) -> NDArray[np.float64]:
        """Apply the heat kernel, H (a * column), to every column.

        Parameters
        ----------
        columns : (k, n) or (n,)
            Densities or scalings.

        Returns
        -------
        ndarray
            The same shape, diffused; constants stay constant. Zero at vertices that no triangle uses.
        """
        values = np.asarray(columns, dtype=np.float64)
        result = np.zeros_like(values)
        result.reshape(-1, *self.shape)[:, self._used] = self._diffused(values.reshape(-1, *self.shape)[:, self._used])
        return result

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column, (k, n) or (n,), to `out`, by scalings of float64.

        A result is either right or `LOG_NOTHING`: sums of positive terms lose their largest one last. `logs` and `out`
        may be the same array.
        """
        columns = logs.reshape(-1, *self.shape)[:, self._used]
        shift = columns.max(axis=1, keepdims=True) - HEADROOM
        columns -= shift
        np.exp(columns, out=columns)
        np.copyto(columns, 0.0, where=columns < NEGLIGIBLE)
        columns = self._diffused(columns)
        floored_log(columns, shift)
        target = out.reshape(-1, *self.shape)
        target[...] = LOG_NOTHING
        target[:, self._used] = columns

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write the same by a dense kernel in the log domain: any range of scalings, on small meshes.

        Raises
        ------
        KernelTooNarrowError
            The mesh is too large for a dense kernel.
        """
        if len(self._used) > _DENSE_VERTICES:
            raise KernelTooNarrowError(
                f"gamma = {self.gamma:.3g} is too small for scalings of float64 on {len(self._used)} vertices; "
                f"try {2 * self.gamma:.3g}"
            )
        values = logs.reshape(-1, *self.shape)[:, self._used]
        # Nothing stays nothing: not even the whole mass of a column may lift it to where it looks like a result.
        columns = np.where(values > LOG_NOTHING / 2, values + np.log(self._area_weights), -np.inf)
        target = out.reshape(-1, *self.shape)
        target[...] = LOG_NOTHING
        rows = max(1, _BLOCK // len(self._used))
        for column, result in zip(columns, target, strict=True):
            for start in range(0, len(self._used), rows):
                result[self._used[start : start + rows]] = _log_sums(self._log_kernel[start : start + rows] + column)

    def log_transfer(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Apply the kernel between regions; a mesh is solved as a whole, all columns at once."""
        return through_whole_arrays(self.log_apply, columns, sources, targets)

    def log_transfer_far(
        self, columns: Sequence[NDArray[np.float64]], sources: Sequence[Region], targets: Sequence[Region]
    ) -> list[NDArray[np.float64]]:
        """Do the same by the dense kernel."""
        return through_whole_arrays(self.log_apply_far, columns, sources, targets)

    def kernel_distance(
        self, log_values: NDArray[np.float64], log_at_source: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Distances in units of the domain at which the kernel of these Euler steps in the plane has these values."""
        return kernel_distance(log_values, log_at_source, self.gamma, self.steps)

    def squared_distance(self, divergence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Squared distance, in units of the domain, of transport that costs `divergence` by these Euler steps."""
        return squared_distance(divergence, self.gamma, self.steps)

    def cost_slope(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Slope, by the distance in units of the domain, of what transport by these Euler steps costs."""
        return cost_slope(distance, self.gamma, self.steps)

    def coarser(self) -> None:
        """Return None: on meshes a cold solve takes so few iterations that a coarser mesh would not pay."""

    @cached_property
    def _log_kernel(self) -> NDArray[np.float64]:
        """Logarithm of H between all vertices in use, minus infinity where float64 ends."""
        count = len(self._used)
        # A unit mass at every vertex in turn, as large as float64 allows.
        peaks = np.diag(np.exp(HEADROOM) / self._area_weights)
        kernel = np.empty((count, count))
        for start in range(0, count, 64):
            kernel[start : start + 64] = self._diffused(peaks[start : start + 64])
        floored_log(kernel)
        kernel[kernel <= LOG_NOTHING] = -np.inf
        return 0.5 * (kernel + kernel.T) - HEADROOM

    def _diffused(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        for _ in range(self.steps):
            columns = self._factor.solve(columns * self._area_weights)
        return columns


def _log_sums(logs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Logarithms of the sums of exp over every row; LOG_NOTHING where there is nothing. `logs` is used up."""
    top = np.maximum(logs.max(axis=1, keepdims=True), LOG_NOTHING)
    logs -= top
    np.exp(logs, out=logs)
    sums = logs.sum(axis=1)
    floored_log(sums, top[:, 0])
    return sums


def _mean_edge_length(mesh: TriangleMesh) -> float:
    edges = np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]])
    lengths = np.linalg.norm(mesh.vertices[edges[:, 0]] - mesh.vertices[edges[:, 1]], axis=1)
    return float(lengths.mean())
