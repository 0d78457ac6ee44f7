# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compatibility of points on two surfaces: the data term of a soft map.

Signatures and distances to the marked pairs give an initial guess. One surface is then registered to the other,
starting from the guess or from the pairs alone, and the resulting correspondence dominates the compatibility.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_array

from ...geometry.deformation.functional_map import spectral_match
from ...geometry.deformation.unit_shape import UnitShape
from ...geometry.meshes.closest_points import ClosestPoints
from ...geometry.meshes.surface_graph import surface_distances
from ...progress import UNINTERRUPTED, Control
from ..workers import both_ways
from .map_sides import MapSide
from .registered_maps import Overlay, overlaid
from .shape_descriptors import ShapeDescriptors, differences, shape_descriptors
from .soft_map_settings import SoftMapSettings

# Weight of the squared distance from the match, relative to the size of the surface (the square root of its area). The
# cost is limited to 1, reached at a distance of 0.16. Steeper costs are worse (docs/performance, "Soft maps").
_STEEPNESS = 40.0
# The same for the initial guess, where matches are less precise; distances beyond 0.32 are not needed.
_ROUGH_STEEPNESS = 10.0
# Weights of the descriptors relative to the match, in the guess and in the result.
_DESCRIPTORS_IN_GUESS, _DESCRIPTORS = 0.3, 0.1
# Cost of a painted group that covers a point of one surface fully and one of the other not at all.
_GROUP = 0.5


@dataclass(frozen=True)
class Comparison:
    """What is known about two surfaces before their soft map is solved.

    Attributes
    ----------
    costs : (n0, n1) float32
        c(x, y) of the soft map: small where x and y correspond.
    overlay : Overlay
        The registration of the source to the target.
    """

    costs: NDArray[np.float32]
    overlay: Overlay


def comparison(
    source: MapSide,
    target: MapSide,
    pairs: ArrayLike,
    settings: SoftMapSettings | None = None,
    control: Control = UNINTERRUPTED,
) -> Comparison:
    """Compare two meshes of about a thousand vertices.

    Parameters
    ----------
    source, target : MapSide
        Meshes with some area, in any units. Groups with equal names distinguish points.
    pairs : (k, 2) int
        Corresponding vertices, possibly none.
    settings : SoftMapSettings, optional
        Only its group_weight is used.
    control : Control
        Stops the work.

    Raises
    ------
    InputError
        A mesh has no area.
    """
    settings = settings or SoftMapSettings()
    marked = np.asarray(pairs, dtype=np.int64).reshape(-1, 2)
    shapes = UnitShape.of(source.mesh), UnitShape.of(target.mesh)
    groups = _common_groups(source, target)
    descriptors = both_ways(lambda k: shape_descriptors(shapes[k], marked[:, k], groups[k]))
    painted = settings.group_weight * _group_costs(*groups)

    def told_apart() -> NDArray[np.float32]:
        return differences(*descriptors) + painted

    def matched() -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        return _near_distances(shapes[1]), _spectral(*descriptors)

    costs, (between, matches) = both_ways(lambda k: (told_apart, matched)[k]())
    guess = _guess(shapes[1], costs, between[matches])
    overlay = overlaid(*shapes, marked, guess, control)
    near = _cost_of_distance(_distances_to(overlay.images, shapes[1], between), _STEEPNESS)
    return Comparison(near + np.float32(_DESCRIPTORS) * costs + np.float32(1.0 - _DESCRIPTORS) * painted, overlay)


def _near_distances(shape: UnitShape) -> NDArray[np.float32]:
    """Return the distances between all vertices on a surface, (n, n), clipped at what a guess can tell."""
    reach = _ROUGH_STEEPNESS**-0.5
    between = surface_distances(shape.graph, np.arange(len(shape.vertices)), limit=reach)
    return np.minimum(between, reach).astype(np.float32)


def _spectral(source: ShapeDescriptors, target: ShapeDescriptors) -> NDArray[np.int64]:
    return spectral_match(source.spectrum, target.spectrum, source.descriptors, target.descriptors).forward


def _guess(target: UnitShape, costs: NDArray[np.float32], away: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return for every source vertex a similar target vertex close to its match, given the distances `away`."""
    total = _cost_of_distance(away, _ROUGH_STEEPNESS) + np.float32(_DESCRIPTORS_IN_GUESS) * costs
    total[:, target.areas <= 0] = np.inf
    return total.argmin(axis=1)


def _distances_to(images: ClosestPoints, target: UnitShape, between: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the distance of every target vertex from the image of every source vertex, (n0, n1).

    For an image p with weights b on a triangle's corners v, |p - y|^2 = sum b |v - y|^2 - sum b |v - p|^2 in the plane.
    Distances between vertices, (n1, n1), may be clipped.
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
    """Return the weights of the groups that both sides have, by name, (g, n0) and (g, n1)."""
    names = sorted(set(source.groups) & set(target.groups))
    sides = []
    for side in (source, target):
        own = [np.asarray(side.groups[name], dtype=np.float64) for name in names]
        sides.append(np.array(own).reshape(len(names), len(side.mesh.vertices)))
    return sides[0], sides[1]


def _group_costs(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return the costs of differences in painted groups, (n0, n1)."""
    costs = np.zeros((source.shape[1], target.shape[1]), np.float32)
    for here, there in zip(source.astype(np.float32), target.astype(np.float32), strict=True):
        costs += np.abs(here[:, None] - there)
    return np.float32(_GROUP) * costs
