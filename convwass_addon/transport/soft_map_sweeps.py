# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The iteration of soft maps: Algorithm 4 on a graph of about a thousand vertices, as large matrix products."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ..geometry.algebra.products import multiply
from .graph import PropagationGraph

# Densities below this are set to zero: they would underflow to subnormal float32 numbers, which are many times slower.
# The bounds of scalings and messages keep their products with the smallest kernel entries in the normal range.
NEGLIGIBLE = np.float32(1e-12)
_SMALLEST, _LARGEST = np.float32(1e-15), np.float32(1e10)
# Steps in which the debiasing density approaches that of the initial densities.
_STARTING_STEPS = 2
# Edge ends processed together: few enough for the processor's cache, enough for fast products.
_ENDS_AT_ONCE = 256
# Threads that update the blocks of one color.
_THREADS = 2

T = TypeVar("T")


@dataclass(frozen=True)
class Block:
    """Some vertices of one color, in the order of the iteration.

    Attributes
    ----------
    vertices, ends : slice
        The vertices, and all edge ends at them.
    owner : (len(ends),) int64
        Index within the block of the vertex of each end.
    shares : (len(vertices), len(ends)) float32
        The weight of every end's edge over the sum of weights at its vertex, zero at other vertices' ends.
    """

    vertices: slice
    ends: slice
    owner: NDArray[np.int64]
    shares: NDArray[np.float32]


@dataclass(frozen=True)
class SweepOrder:
    """Vertices and edge ends of a graph sorted by color, so that a sweep reads memory sequentially.

    Attributes
    ----------
    graph : PropagationGraph
        Every vertex has an edge.
    vertices : (size,) int64
        The graph's vertices in this order.
    ends : (2 e,) int64
        The graph's ends in this order.
    """

    graph: PropagationGraph
    vertices: NDArray[np.int64]
    ends: NDArray[np.int64]

    @classmethod
    def of(cls, graph: PropagationGraph) -> SweepOrder:
        """Sort by color, then by vertex."""
        vertices = np.concatenate(graph.colors)
        return cls(graph, vertices, np.concatenate([graph.ends_at[vertex] for vertex in vertices]))

    @cached_property
    def opposite(self) -> NDArray[np.int64]:
        """Index in this order of the other end of every end's edge, (2 e,)."""
        place = np.empty_like(self.ends)
        place[self.ends] = np.arange(len(self.ends))
        return place[self.ends ^ 1]

    @cached_property
    def colors(self) -> tuple[tuple[Block, ...], ...]:
        """Blocks of vertices by color; no edge joins two vertices of one color."""
        degrees = np.array([len(self.graph.ends_at[vertex]) for vertex in self.vertices])
        last_ends = np.cumsum(degrees)
        colors, start = [], 0
        for color in self.graph.colors:
            found, stop = [], start + len(color)
            while start < stop:
                first_end = last_ends[start] - degrees[start]
                filled = int(np.searchsorted(last_ends[:stop], first_end + _ENDS_AT_ONCE, side="right"))
                after = max(start + 1, filled)
                found.append(self._block(slice(start, after), slice(first_end, last_ends[after - 1]), degrees))
                start = after
            colors.append(tuple(found))
        return tuple(colors)

    def _block(self, vertices: slice, ends: slice, degrees: NDArray[np.int64]) -> Block:
        count = vertices.stop - vertices.start
        owner = np.repeat(np.arange(count), degrees[vertices])
        shares = np.zeros((count, len(owner)), np.float32)
        weights = self.graph.weight_of_end[self.ends[ends]]
        shares[owner, np.arange(len(owner))] = weights / self.graph.total_weights[self.vertices[vertices]][owner]
        return Block(vertices, ends, owner, shares)


class SoftMapIteration:
    """Sweeps over the source, one color at a time.

    The diagonal factors of eq. (18)'s kernels are moved into the scalings, so that every edge uses the plain kernel.
    The compatibility then is one more factor of the geometric mean at its vertex, like the debiasing density d (Janati
    et al. 2020), for which d_v H(a d_v) = mu_v. The scalings at a free vertex are those of Algorithm 4 after its
    update, mu / H(a s'), with s' at the other end of the edge. No error accumulates, and any start converges to the
    same map.

    Parameters
    ----------
    order : SweepOrder
        The source as a graph of n0 vertices.
    kernel : (n1, n1) float32
        Diffuses rows by ``rows @ kernel``; its entries are H(x, y) a(x).
    areas : (n1,) float32
        Area weights of the target, of sum 1.
    log_prior : (n0, n1) float32
        Added to the logarithms of the densities for the compatibility, in the order of the graph's vertices.
    fixed : dict from vertex to (n1,) density
        Given densities, of mass 1.
    sharpness : float
        Exponent of the debiasing density.
    """

    def __init__(
        self,
        order: SweepOrder,
        kernel: NDArray[np.float32],
        areas: NDArray[np.float32],
        log_prior: NDArray[np.float32],
        fixed: dict[int, NDArray[np.float64]],
        sharpness: float,
    ) -> None:
        self._order = order
        self._kernel = kernel
        self._areas = areas
        self._sharpness = np.float32(sharpness)
        self._log_prior = log_prior[order.vertices]
        place = np.argsort(order.vertices)
        self._fixed = {int(place[vertex]): density.astype(np.float32) for vertex, density in fixed.items()}
        self._densities = np.ones_like(self._log_prior)
        self._debias = np.ones_like(self._log_prior)
        self._other: NDArray[np.float32] | None = None
        self._share = np.float32(0.0)
        self._scalings = np.ones((len(order.ends), len(areas)), np.float32)
        blocks = [block for color in order.colors for block in color]
        self._rows = max(len(block.owner) for block in blocks)
        # Messages and scratch for every thread.
        self._buffers = [np.empty((2, self._rows, len(areas)), np.float32) for _ in range(_THREADS)]

    @property
    def densities(self) -> NDArray[np.float32]:
        """One row per vertex of the graph, (n0, n1), of mass 1."""
        found = np.empty_like(self._densities)
        found[self._order.vertices] = self._densities
        return found

    def start(self, densities: NDArray[np.float32]) -> None:
        """Start from these densities, (n0, n1), with the scalings of their plans to themselves."""
        self._densities = np.ascontiguousarray(densities[self._order.vertices], np.float32)
        self._debias = np.clip(self._densities, _SMALLEST, None)
        for _ in range(_STARTING_STEPS):
            self._update_debias()
        for color in self._order.colors:
            for block in color:
                np.take(self._debias[block.vertices], block.owner, axis=0, out=self._scalings[block.ends], mode="clip")

    def attract(self, log_densities: NDArray[np.float32], share: float) -> None:
        """Attract every row to another one, (n0, n1), known up to a factor, with weight `share`."""
        self._other = log_densities[self._order.vertices]
        self._share = np.float32(share)

    def sweep(self) -> float:
        """Update every vertex once; return the mean, over the vertices, of the mass moved: 0 to 2."""
        moved = 0.0
        for color in self._order.colors:
            moved += sum(_in_threads(partial(self._update, color), len(color)))
        if self._sharpness:
            self._update_debias()
        return moved / len(self._densities)

    def _update(self, color: Sequence[Block], number: int, thread: int) -> float:
        """Update one block of a color; return the mass that has moved."""
        block = color[number]
        messages, spare = self._buffers[thread][:, : len(block.owner)]
        np.take(self._scalings, self._order.opposite[block.ends], axis=0, out=spare, mode="clip")
        multiply(spare, self._kernel, messages)
        # A zero would make the geometric mean zero for good. The floor lets mass come back and bounds its cost.
        np.clip(messages, _SMALLEST, _LARGEST, out=messages)
        np.log(messages, out=spare)
        found = self._density(block, spare)
        before = self._densities[block.vertices]
        moved = float((np.abs(found - before) @ self._areas).sum())
        before[...] = found
        np.take(found, block.owner, axis=0, out=spare, mode="clip")
        np.divide(spare, messages, out=self._scalings[block.ends])
        return moved

    def _density(self, block: Block, log_messages: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the weighted geometric mean of the messages, the prior and the other factors, of mass 1."""
        found = np.empty((len(block.shares), len(self._areas)), np.float32)
        multiply(block.shares, log_messages, found)
        found += self._log_prior[block.vertices]
        if self._sharpness:
            found += self._sharpness * np.log(self._debias[block.vertices])
        if self._other is not None:
            found *= 1 - self._share
            found += self._share * self._other[block.vertices]
        found -= found.max(axis=1, keepdims=True)
        np.exp(found, out=found)
        # Normalize, because masses converge only over many sweeps; a factor is a constant in the compatibility.
        found /= (found @ self._areas)[:, None]
        for vertex in range(block.vertices.start, block.vertices.stop):
            if vertex in self._fixed:
                found[vertex - block.vertices.start] = self._fixed[vertex]
        found[found < NEGLIGIBLE] = 0.0
        return found

    def _update_debias(self) -> None:
        """Take half a step, in logarithms, towards d H(a d) = mu."""
        _in_threads(self._update_debias_of, -(-len(self._debias) // self._rows))

    def _update_debias_of(self, number: int, thread: int) -> None:
        part = slice(number * self._rows, (number + 1) * self._rows)
        debias = self._debias[part]
        diffused = self._buffers[thread][0, : len(debias)]
        multiply(debias, self._kernel, diffused)
        np.maximum(diffused, _SMALLEST, out=diffused)
        np.divide(self._densities[part], diffused, out=diffused)
        debias *= diffused
        np.sqrt(debias, out=debias)
        np.clip(debias, _SMALLEST, _LARGEST, out=debias)


def _in_threads(work: Callable[[int, int], T], count: int) -> list[T]:
    """Do `count` independent pieces of work; each gets its number and that of its thread."""

    def share(thread: int) -> list[T]:
        return [work(number, thread) for number in range(thread, count, _THREADS)]

    if count < _THREADS:
        return share(0) if count else []
    with ThreadPoolExecutor(_THREADS - 1, thread_name_prefix="convwass") as executor:
        others = [executor.submit(share, thread) for thread in range(1, _THREADS)]
        shares = [share(0), *(other.result() for other in others)]
    return [shares[number % _THREADS][number // _THREADS] for number in range(count)]
