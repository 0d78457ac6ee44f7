# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How well each point of one surface goes with each of another: what a soft map is told besides to be smooth.

Signatures and distances to the marked pairs give a first guess; one surface is then laid over the other, from there or
from the pairs alone, and what comes to lie on what counts most.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ...geometry.closest_points import ClosestPoints
from ...geometry.functional_map import spectral_match
from ...geometry.surface_graph import surface_distances
from ...geometry.unit_shape import UnitShape
from .map_sides import MapSide
from .registered_maps import Overlay, overlaid
from .shape_descriptors import ShapeDescriptors, differences, shape_descriptors
from .soft_map_settings import SoftMapSettings

# The square of a distance from the match counts so much, in sizes of the surface (the square root of its area), and
# nothing counts more than 1, which that of 0.16 does. Steeper ones are worse (docs/performance.md, "Soft maps").
_STEEPNESS = 40.0
# The same for the first guess, where matches are rougher; farther ways than 0.32 are never needed.
_ROUGH_STEEPNESS = 10.0
# Weight of descriptor differences relative to the match: in the first guess, and in the end.
_DESCRIPTORS_IN_GUESS, _DESCRIPTORS = 0.3, 0.1
# What a painted group counts that covers a point of one surface fully and one of the other not at all.
_GROUP = 0.5


@dataclass(frozen=True)
class Comparison:
    """What is known of two surfaces before a soft map between them is solved.

    Attributes
    ----------
    costs : (n0, n1) float32
        c(x, y) of the soft map: small where x and y go together.
    overlay : Overlay
        The source laid over the target.
    """

    costs: NDArray[np.float32]
    overlay: Overlay


def compatibility(
    source: MapSide, target: MapSide, pairs: ArrayLike, settings: SoftMapSettings | None = None
) -> NDArray[np.float32]:
    """Return c(x, y) for all vertices of two meshes, (n0, n1); see :func:`comparison`."""
    return comparison(source, target, pairs, settings).costs


def comparison(
    source: MapSide, target: MapSide, pairs: ArrayLike, settings: SoftMapSettings | None = None
) -> Comparison:
    """Compare two meshes of about a thousand vertices.

    Parameters
    ----------
    source, target : MapSide
        Meshes with some area, in any units. Groups of equal names tell points apart.
    pairs : (k, 2) int
        Vertices of the two that belong together; none are allowed.
    settings : SoftMapSettings, optional
        Its group_weight is used.

    Raises
    ------
    InputError
        A mesh has no area.
    """
    settings = settings or SoftMapSettings()
    marked = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    shapes = UnitShape.of(source.mesh), UnitShape.of(target.mesh)
    groups = _common_groups(source, target)
    descriptors = [
        shape_descriptors(shape, ends, own) for shape, ends, own in zip(shapes, marked.T, groups, strict=True)
    ]
    painted = settings.group_weight * _group_costs(*groups)
    costs = differences(*descriptors) + painted
    reach = _ROUGH_STEEPNESS**-0.5
    between = surface_distances(shapes[1].graph, np.arange(len(shapes[1].vertices)), limit=reach)
    between = np.minimum(between, reach).astype(np.float32)
    guess = _guess(shapes[1], costs, between[_spectral(*descriptors)])
    overlay = overlaid(*shapes, marked, guess)
    near = _cost_of_distance(_distances_to(overlay.images, shapes[1], between), _STEEPNESS)
    return Comparison(near + np.float32(_DESCRIPTORS) * costs + np.float32(1.0 - _DESCRIPTORS) * painted, overlay)


def _spectral(source: ShapeDescriptors, target: ShapeDescriptors) -> NDArray[np.int64]:
    return spectral_match(source.spectrum, target.spectrum, source.descriptors, target.descriptors).forward


def _guess(target: UnitShape, costs: NDArray[np.float32], away: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return a vertex of the target for each of the source's that looks like it, not far `away` from its match."""
    total = _cost_of_distance(away, _ROUGH_STEEPNESS) + np.float32(_DESCRIPTORS_IN_GUESS) * costs
    total[:, target.areas <= 0] = np.inf
    return total.argmin(axis=1)


def _distances_to(images: ClosestPoints, target: UnitShape, between: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return how far every vertex of the target is from the image of each of the source's, (n0, n1).

    With shares b of a triangle's corners v, |p - y|^2 = sum b |v - y|^2 - sum b |v - p|^2 in the plane. Distances
    between vertices, (n1, n1), may end somewhere.
    """
    corners = target.mesh.faces[images.triangles]
    points = np.einsum("nc,ncd->nd", images.shares, target.vertices[corners])
    own = np.einsum("nc,nc->n", images.shares, np.square(target.vertices[corners] - points[:, None]).sum(axis=2))
    starts = np.arange(0, corners.size + 1, 3)
    shares = images.shares.astype(np.float32).ravel()
    blend = csr_array((shares, corners.ravel(), starts), (len(corners), len(between)))
    return np.sqrt(np.maximum(blend @ np.square(between) - own[:, None].astype(np.float32), 0.0))


def _cost_of_distance(distances: NDArray[np.float32], steepness: float) -> NDArray[np.float32]:
    return np.minimum(np.float32(steepness) * np.square(distances), np.float32(1.0))


def _common_groups(source: MapSide, target: MapSide) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the weights of the groups whose names both sides have, (g, n0) and (g, n1)."""
    names = sorted(set(source.groups) & set(target.groups))
    sides = []
    for side in (source, target):
        own = [np.asarray(side.groups[name], dtype=np.float64) for name in names]
        sides.append(np.array(own).reshape(len(names), len(side.mesh.vertices)))
    return sides[0], sides[1]


def _group_costs(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return what painted groups say, (n0, n1)."""
    costs = np.zeros((source.shape[1], target.shape[1]), np.float32)
    for here, there in zip(source.astype(np.float32), target.astype(np.float32), strict=True):
        costs += np.abs(here[:, None] - there)
    return np.float32(_GROUP) * costs
