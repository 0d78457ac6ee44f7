# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Triangle meshes as domains of transport: heat flows along the surface, by implicit Euler steps."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import diags_array

from ..geometry.algebra.factorization import Factorization, factorize
from ..geometry.arrays.chunks import chunks
from ..geometry.meshes.edges import vertex_components
from ..geometry.meshes.mesh import TriangleMesh
from ..one_line import one_line
from ..progress import UNINTERRUPTED, Control
from .domain import KernelTooNarrowError
from .log_range import HEADROOM, LOG_NOTHING, floored_log, flushed_exp
from .matern import cost_slope, kernel_distance, squared_distance
from .mesh_levels import MeshLevel
from .region import Region, ThroughWholeArrays

# A smaller gamma blurs a large shape less than is ever needed, and makes long distances less accurate.
_SMALLEST_DEFAULT_GAMMA = 0.01
# With the default number of steps, the kernel is accurate up to distances of about gamma over the mean edge length.
_GAMMA_PER_EDGE_LENGTH = 0.7
# Coarser meshes, which only provide a start, may have a narrower kernel: chosen by eye.
_COARSE_GAMMA_PER_EDGE_LENGTH = 0.2
# A dense kernel of 2500 vertices takes 2500^2 x 8 bytes = 50 MB; its rows are processed in blocks of this many values.
_DENSE_VERTICES = 2500
_BLOCK = 1 << 22
# Columns solved together: CHOLMOD handles four in one pass over the factor, and more only take memory.
_COLUMNS = 4


class Surface(ThroughWholeArrays):
    """A triangle mesh of any topology, with or without boundary, with one or several connected components.

    Lengths are those of the mesh rescaled to unit area. The heat kernel at time t = gamma / 4, for which -gamma ln H
    tends to the squared geodesic distance (Varadhan), is applied by `steps` implicit Euler steps. Each step solves
    (D_a + t / steps L) x = a * y with one sparse Cholesky factorization (Solomon et al. 2015, section 5, with the
    corrected time). L is positive semi-definite and has no positive off-diagonal entry, so heat is never negative and
    its tail is accurate to many digits.

    Parameters
    ----------
    vertices : (n, 3)
        Positions, in any unit.
    faces : (m, 3)
        Vertex indices. Degenerate triangles, non-manifold edges and unused vertices are allowed; unused vertices hold
        no mass.
    gamma : float, optional
        Entropic regularization, in units of the mesh rescaled to unit area; the blur has a standard deviation of
        sqrt(gamma / 2) per axis. By default proportional to the edge length, following the paper:
        max(0.01, 0.7 x mean edge length).
    steps : int
        Implicit Euler steps per application of the kernel. More steps make long distances more accurate: the relative
        error (too short) at distance d is about d^2 / (11 gamma steps).
    control : Control
        Stops long work on the surface when cancelled, such as Euler steps on many vertices. The surface and its coarser
        levels keep it.

    Attributes
    ----------
    mesh : TriangleMesh
        The mesh as given.
    laplacian : Laplacian
        Stiffness and vertex areas in the units of the vertices.
    area : float
        Total area in the units of the vertices, squared.
    mean_edge_length : float
        In lengths of the domain.

    Raises
    ------
    InputError
        Arrays that are not a mesh, or a mesh without area.
    ValueError
        `gamma` is not a positive number or `steps` not a positive integer.
    """

    dimension = 2
    has_quadratic_cost = False
    has_fast_propagation = True
    has_fast_balance = True
    relaxation = 1.0
    far_numerics = "dense log domain"

    __repr__ = one_line("shape", "gamma", "steps", "mean_edge_length")

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        gamma: float | None = None,
        steps: int = 10,
        control: Control = UNINTERRUPTED,
    ) -> None:
        mesh = TriangleMesh.from_arrays(vertices, faces)
        self._build(MeshLevel.of(mesh, control), gamma, steps)

    def with_kernel(self, gamma: float | None = None, steps: int = 10) -> Surface:
        """Return the same mesh with another kernel; the Laplacian and the coarser meshes are shared."""
        return self._on(self._level, gamma, steps)

    @classmethod
    def _on(cls, level: MeshLevel, gamma: float | None, steps: int) -> Surface:
        surface = object.__new__(cls)
        surface._build(level, gamma, steps)
        return surface

    def _build(self, level: MeshLevel, gamma: float | None, steps: int) -> None:
        self._level = level
        self.mesh = level.mesh
        self.laplacian = stiffness = level.laplacian
        self.shape = (len(self.mesh.vertices),)
        self.area = float(stiffness.areas.sum())
        self.unit_length = float(np.sqrt(self.area))
        self.mean_edge_length = level.mean_edge_length / self.unit_length
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

    @cached_property
    def _factor(self) -> Factorization:
        """The factorization, built when the kernel is first applied, because areas and lengths do not need it."""
        # Rescaling lengths changes the areas but not L.
        part = self.laplacian.matrix[self._used][:, self._used]
        system = diags_array(self._area_weights) + (self.gamma / 4.0 / self.steps) * part
        return factorize(system.tocsc())

    def factorize(self) -> None:
        """Factorize now rather than on first use, as it may take a while."""
        self._level.control.check()
        _ = self._factor

    @property
    def levels_below(self) -> int:
        """Approximate number of coarser surfaces."""
        return self._level.levels_below

    @property
    def solver(self) -> str:
        """The factorization in use."""
        return self._factor.name

    @property
    def factor_bytes(self) -> int | None:
        """Memory used by the factorization, in bytes; None where unknown."""
        return self._factor.factor_bytes

    @property
    def positions(self) -> NDArray[np.float64]:
        """The vertices, (n, 3)."""
        return self.mesh.vertices

    @cached_property
    def pieces(self) -> NDArray[np.int64] | None:
        """The connected component of every vertex, -1 for unused ones; None if there is only one."""
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
            The same shape, diffused; constants are preserved. Zero at vertices that no triangle uses.
        """
        values = np.asarray(columns, dtype=np.float64)
        result = np.zeros_like(values)
        result.reshape(-1, *self.shape)[:, self._used] = self._diffused(values.reshape(-1, *self.shape)[:, self._used])
        return result

    def log_apply(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Write log H (a * exp(column)) of every column, (k, n) or (n,), to `out`, by float64 scalings.

        A result is either accurate or `LOG_NOTHING`: in a sum of positive terms the largest one underflows last. `logs`
        and `out` may be the same array.
        """
        columns = logs.reshape(-1, *self.shape)[:, self._used]
        shift = columns.max(axis=1, keepdims=True) - HEADROOM
        columns = self._diffused(flushed_exp(columns, shift, columns))
        floored_log(columns, shift)
        target = out.reshape(-1, *self.shape)
        target[...] = LOG_NOTHING
        target[:, self._used] = columns

    def log_apply_far(self, logs: NDArray[np.float64], out: NDArray[np.float64]) -> None:
        """Like :meth:`log_apply`, by a dense kernel in the log domain: any range of scalings, on small meshes.

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
        # Empty elements become -inf; otherwise adding a large column could lift LOG_NOTHING to a plausible value.
        columns = np.where(values > LOG_NOTHING / 2, values + np.log(self._area_weights), -np.inf)
        target = out.reshape(-1, *self.shape)
        target[...] = LOG_NOTHING
        rows = max(1, _BLOCK // len(self._used))
        for column, result in zip(columns, target, strict=True):
            for some in chunks(len(self._used), rows):
                result[self._used[some]] = _log_sums(self._log_kernel[some] + column)

    def kernel_distance(
        self, log_values: NDArray[np.float64], log_at_source: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Distances, in units of the domain, at which the kernel of these steps in the plane has these values."""
        return kernel_distance(log_values, log_at_source, self.gamma, self.steps)

    def squared_distance(self, divergence: NDArray[np.float64]) -> NDArray[np.float64]:
        """Convert the debiased cost of transport with these Euler steps to a squared distance, in domain units."""
        return squared_distance(divergence, self.gamma, self.steps)

    def cost_slope(self, distance: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the derivative of the transport cost of these Euler steps by the distance (in domain units)."""
        return cost_slope(distance, self.gamma, self.steps)

    def coarser(self) -> Surface | None:
        """Return the surface with fewer vertices; None where that would save nothing or leave no surface.

        The kernel is the same if the coarser mesh can resolve it, otherwise wider (:attr:`fall_of_gamma`).
        """
        return self._coarser

    @cached_property
    def _coarser(self) -> Surface | None:
        below = self._level.coarser
        if below is None:
            return None
        # A kernel narrow for the mesh gives a better start than a kernel of another width, but heat must still be able
        # to cross the edges.
        edge_length = below.level.mean_edge_length / self.unit_length
        narrowest = min(_COARSE_GAMMA_PER_EDGE_LENGTH, self.gamma / self.mean_edge_length) * edge_length
        return self._on(below.level, max(self.gamma, narrowest), self.steps)

    @property
    def fall_of_gamma(self) -> float:
        """Ratio of gamma on the coarser mesh to gamma here."""
        return self.coarser().gamma / self.gamma

    def restrict(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        """Densities on the coarser mesh, (k, c): means over clusters of vertices, which preserve the mass."""
        return self._level.coarser.restrict(columns, self.laplacian.areas)

    def prolong(self, columns: NDArray[np.float64], region: Region) -> NDArray[np.float64]:
        """Interpolate columns of the coarser mesh, (k, c), linearly to a region of this one, (k, len)."""
        return self._level.coarser.prolong(columns, None if region.is_whole else region.index)

    def refined(self, support: Region, region: Region) -> Region:
        """Return the whole mesh, which is always solved at once."""
        return Region.whole(self.shape)

    @cached_property
    def _log_kernel(self) -> NDArray[np.float64]:
        """Logarithm of H between all vertices in use; minus infinity where float64 underflows."""
        count = len(self._used)
        # A unit mass at each vertex in turn, scaled as far as float64 allows.
        peaks = np.diag(np.exp(HEADROOM) / self._area_weights)
        kernel = np.empty((count, count))
        for some in chunks(count, 64):
            kernel[some] = self._diffused(peaks[some])
        floored_log(kernel)
        kernel[kernel <= LOG_NOTHING] = -np.inf
        return 0.5 * (kernel + kernel.T) - HEADROOM

    def _diffused(self, columns: NDArray[np.float64]) -> NDArray[np.float64]:
        result = np.empty_like(columns)
        for part in chunks(len(columns), _COLUMNS):
            some = columns[part]
            for _ in range(self.steps):
                self._level.control.check()
                some = self._factor.solve(some * self._area_weights)
            result[part] = some
        return result


def _log_sums(logs: NDArray[np.float64]) -> NDArray[np.float64]:
    """Log-sum-exp of every row; LOG_NOTHING where a row is empty. Overwrites `logs`."""
    top = np.maximum(logs.max(axis=1, keepdims=True), LOG_NOTHING)
    logs -= top
    np.exp(logs, out=logs)
    sums = logs.sum(axis=1)
    floored_log(sums, top[:, 0])
    return sums
