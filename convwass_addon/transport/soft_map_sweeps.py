# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The iteration of soft maps: Algorithm 4 on a graph of about a thousand vertices, in products of large matrices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..geometry.products import multiply
from .graph import PropagationGraph

# Densities below this are nothing: a shorter tail would end in the subnormal numbers of float32, which are many times
# slower. Scalings and messages between their bounds leave products with the smallest entries of a kernel above them.
NEGLIGIBLE = np.float32(1e-12)
_SMALLEST, _LARGEST = np.float32(1e-15), np.float32(1e10)
# Steps in which the debiasing density gets near that of densities to start from.
_STARTING_STEPS = 2
# Ends of edges that are handled at once: few enough for the processor's cache, enough for fast products.
_ENDS_AT_ONCE = 256


@dataclass(frozen=True)
class Block:
    """Some vertices of one color, in the order of the iteration.

    Attributes
    ----------
    vertices, ends : slice
        The vertices, and all ends of edges there.
    owner : (len(ends),) int64
        Which of the block's vertices each end is at.
    shares : (len(vertices), len(ends)) float32
        The weight of every end's edge over the sum of weights at its vertex, zero at other vertices' ends.
    """

    vertices: slice
    ends: slice
    owner: NDArray[np.int64]
    shares: NDArray[np.float32]


@dataclass(frozen=True)
class SweepOrder:
    """Vertices and ends of edges of a graph, sorted by color, so that a sweep goes through memory once.

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
        """Where in this order the other end of every end's edge is, (2 e,)."""
        place = np.empty_like(self.ends)
        place[self.ends] = np.arange(len(self.ends))
        return place[self.ends ^ 1]

    @cached_property
    def total_weights(self) -> NDArray[np.float64]:
        """The sum of the weights of the edges at every vertex, (size,), in this order."""
        return np.bincount(self.graph.vertex_of_end, self.graph.weight_of_end, self.graph.size)[self.vertices]

    @cached_property
    def blocks(self) -> tuple[Block, ...]:
        """What is updated at once; no edge joins two vertices of a block."""
        degrees = np.array([len(self.graph.ends_at[vertex]) for vertex in self.vertices])
        last_ends = np.cumsum(degrees)
        found, start = [], 0
        for color in self.graph.colors:
            stop = start + len(color)
            while start < stop:
                first_end = last_ends[start] - degrees[start]
                filled = int(np.searchsorted(last_ends[:stop], first_end + _ENDS_AT_ONCE, side="right"))
                after = max(start + 1, filled)
                found.append(self._block(slice(start, after), slice(first_end, last_ends[after - 1]), degrees))
                start = after
        return tuple(found)

    def _block(self, vertices: slice, ends: slice, degrees: NDArray[np.int64]) -> Block:
        count = vertices.stop - vertices.start
        owner = np.repeat(np.arange(count), degrees[vertices])
        shares = np.zeros((count, len(owner)), np.float32)
        weights = self.graph.weight_of_end[self.ends[ends]]
        shares[owner, np.arange(len(owner))] = weights / self.total_weights[vertices][owner]
        return Block(vertices, ends, owner, shares)


class SoftMapIteration:
    """Sweeps over the source, a color at a time.

    With the diagonals of eq. (18)'s kernels moved into the scalings, every edge uses the plain kernel, and the
    compatibility is one factor of the geometric mean at its vertex, as the debiasing density d is (Janati et al. 2020),
    d_v H(a d_v) = mu_v. The scalings at a free vertex are those of Algorithm 4 after its update, mu / H(a s'), with s'
    at the other end of the edge, so nothing accumulates and any start ends in the same map.

    Parameters
    ----------
    order : SweepOrder
        The source as a graph of n0 vertices.
    kernel : (n1, n1) float32
        Rows times it are rows diffused: H(x, y) a(x).
    areas : (n1,) float32
        Area weights of the target, of sum 1.
    log_prior : (n0, n1) float32
        What the compatibility adds to the logarithms of the densities, in the order of the graph's vertices.
    fixed : dict from vertex to (n1,) density
        Given distributions, of mass 1.
    sharpness : float
        Power of the debiasing density.
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
        most = max(len(block.owner) for block in order.blocks)
        self._messages, self._spare = np.empty((2, most, len(areas)), np.float32)

    @property
    def densities(self) -> NDArray[np.float32]:
        """One row per vertex of the graph, (n0, n1), of mass 1."""
        found = np.empty_like(self._densities)
        found[self._order.vertices] = self._densities
        return found

    def start(self, densities: NDArray[np.float32]) -> None:
        """Begin with these densities, (n0, n1): with the scalings that take each to itself."""
        self._densities = np.ascontiguousarray(densities[self._order.vertices], np.float32)
        self._debias = np.clip(self._densities, _SMALLEST, None)
        for _ in range(_STARTING_STEPS):
            self._update_debias()
        for block in self._order.blocks:
            np.take(self._debias[block.vertices], block.owner, axis=0, out=self._scalings[block.ends], mode="clip")

    def attract(self, log_densities: NDArray[np.float32], share: float) -> None:
        """Have every row agree with another one, (n0, n1), known up to a factor, to which this share is given."""
        self._other = log_densities[self._order.vertices]
        self._share = np.float32(share)

    def sweep(self) -> float:
        """Update every vertex once; return the mean, over the vertices, of the mass that has moved, in 0 to 2."""
        moved = sum(self._update(block) for block in self._order.blocks)
        if self._sharpness:
            self._update_debias()
        return moved / len(self._densities)

    def _update(self, block: Block) -> float:
        count = len(block.owner)
        messages, spare = self._messages[:count], self._spare[:count]
        np.take(self._scalings, self._order.opposite[block.ends], axis=0, out=spare, mode="clip")
        multiply(spare, self._kernel, messages)
        # Nothing would end the geometric mean for good: with a floor a point can come back, and its cost is bounded.
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
        """Return the weighted geometric mean of the messages and of what else counts, of mass 1."""
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
        # Masses would settle only over many sweeps; a factor is a constant in the compatibility and changes nothing.
        found /= (found @ self._areas)[:, None]
        for vertex in range(block.vertices.start, block.vertices.stop):
            if vertex in self._fixed:
                found[vertex - block.vertices.start] = self._fixed[vertex]
        found[found < NEGLIGIBLE] = 0.0
        return found

    def _update_debias(self) -> None:
        """Take d half the way, in logarithms, to d H(a d) = mu."""
        rows = len(self._messages)
        for start in range(0, len(self._debias), rows):
            debias = self._debias[start : start + rows]
            diffused = self._messages[: len(debias)]
            multiply(debias, self._kernel, diffused)
            np.maximum(diffused, _SMALLEST, out=diffused)
            np.divide(self._densities[start : start + rows], diffused, out=diffused)
            debias *= diffused
            np.sqrt(debias, out=debias)
            np.clip(debias, _SMALLEST, _LARGEST, out=debias)
