# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Optimal transport on arrays: the paper, without files or Blender."""

from .barycenter import Barycenter, barycenter
from .bisection import bisect, bisection
from .coordinates import BarycentricCoordinates, NearestBarycenter, barycentric_coordinates, nearest_barycenter
from .distance import Distance, DistanceMatrix, distance, distance_matrix
from .domain import Domain, KernelTooNarrowError
from .geodesic import point_distances
from .grid import Grid
from .inputs import Inputs
from .interpolation import Interpolation, interpolate
from .maps import transport_map
from .masses import from_masses
from .neighbors import barycenter_between, barycenter_from_neighbor
from .propagation import Propagation, propagate
from .soft_map import SoftMap, soft_map, soft_map_domain
from .soft_map_levels import SoftMapSweeps, SymmetricSoftMap, soft_map_between, symmetric_soft_map
from .soft_map_problem import SourceEdges
from .sphere import Sphere
from .surface import Surface

__all__ = [
    "Barycenter",
    "BarycentricCoordinates",
    "Distance",
    "DistanceMatrix",
    "Domain",
    "Grid",
    "Inputs",
    "Interpolation",
    "KernelTooNarrowError",
    "NearestBarycenter",
    "Propagation",
    "SoftMap",
    "SoftMapSweeps",
    "SourceEdges",
    "Sphere",
    "Surface",
    "SymmetricSoftMap",
    "barycenter",
    "barycenter_between",
    "barycenter_from_neighbor",
    "barycentric_coordinates",
    "bisect",
    "bisection",
    "distance",
    "distance_matrix",
    "from_masses",
    "interpolate",
    "nearest_barycenter",
    "point_distances",
    "propagate",
    "soft_map",
    "soft_map_between",
    "soft_map_domain",
    "symmetric_soft_map",
    "transport_map",
]
