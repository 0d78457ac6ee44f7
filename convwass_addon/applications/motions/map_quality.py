# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of how well two shapes match that are deformed onto each other."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ...geometry.poisson_deformation import deformation_gradients
from ...geometry.weighted_quantile import weighted_quantile
from .carriers import Carrier
from .shape_deformations import ShapeDeformation

# Vertices with less confidence count as doubtful.
_DOUBTFUL = 0.3
# Triangles with a larger logarithmic stretch count as torn: a factor of four.
_TORN = 1.4
# Shapes match beyond doubt with at least this mean confidence, and at most these fractions torn and folded.
_CONFIDENT, _LITTLE_TORN, _LITTLE_FOLDED = 0.97, 0.02, 0.01


@dataclass(frozen=True)
class MapQuality:
    """How well a deformed shape matches another; lengths in sizes of the surface (the square root of its area).

    Attributes
    ----------
    confidence : float
        Mean confidence of the map, 0 to 1.
    doubtful : float
        Fraction of the area with little confidence.
    round_trip, round_trip_95 : float
        Round-trip error: mean, and 95th percentile by area.
    left, left_99 : float
        Remaining distance from the other surface: mean, and 99th percentile.
    stretch : float
        Mean over triangles of the largest absolute logarithmic stretch.
    torn : float
        Fraction of the area stretched or compressed by more than a factor of four.
    folded : float
        Fraction of the area that is oriented opposite to the surface that it lies on.
    """

    confidence: float
    doubtful: float
    round_trip: float
    round_trip_95: float
    left: float
    left_99: float
    stretch: float
    torn: float
    folded: float

    def or_worse(self, other: MapQuality) -> MapQuality:
        """Return the worse of two records, figure by figure."""
        worst = {own.name: max(getattr(self, own.name), getattr(other, own.name)) for own in fields(self)}
        return MapQuality(**{**worst, "confidence": min(self.confidence, other.confidence)})

    @property
    def is_beyond_doubt(self) -> bool:
        """Whether the shapes match so well that the quality of the initial map is irrelevant."""
        return self.confidence >= _CONFIDENT and self.torn <= _LITTLE_TORN and self.folded <= _LITTLE_FOLDED

    def as_dict(self) -> dict[str, float]:
        """Return the figures ready for JSON."""
        return {name: round(value, 5) for name, value in asdict(self).items()}


def map_quality(source: Carrier, target: Carrier, there: ShapeDeformation, back: ShapeDeformation) -> MapQuality:
    """Measure how well the deformed source matches the target; `back` is the deformation of the target."""
    mesh, other = source.mesh, target.mesh
    weights = mesh.vertex_areas / mesh.area
    home = there.images.interpolated(back.points[other.faces])
    trip = np.linalg.norm(home - mesh.vertices, axis=1) / source.size
    left = there.images.distances / target.size
    areas = np.linalg.norm(np.cross(*_sides(mesh.corners)), axis=1)
    areas = areas / areas.sum()
    # The third column is a normal, which is scaled like the others.
    gradients = deformation_gradients(mesh.vertices, there.points, mesh.faces) / there.scale
    sizes = np.linalg.svd(gradients, compute_uv=False)
    logarithms = np.log(np.maximum(np.stack([sizes[:, 0], sizes[:, 2]], axis=1), 1e-6))
    stretch = np.abs(logarithms).max(axis=1)
    return MapQuality(
        confidence=float(weights @ there.confidence),
        doubtful=float(weights[there.confidence < _DOUBTFUL].sum()),
        round_trip=float(weights @ trip),
        round_trip_95=weighted_quantile(trip, weights, 0.95),
        left=float(weights @ left),
        left_99=weighted_quantile(left, weights, 0.99),
        stretch=float(areas @ stretch),
        torn=float(areas[stretch > _TORN].sum()),
        folded=float(areas[_folded(source, target, there)].sum()),
    )


def _folded(source: Carrier, target: Carrier, there: ShapeDeformation) -> NDArray[np.bool_]:
    """Return the triangles that are oriented opposite to the surface at their first corner, (m,)."""
    faces = source.mesh.faces
    normals = np.cross(*_sides(there.points[faces]))
    facing = np.cross(*_sides(target.mesh.corners[there.images.triangles[faces[:, 0]]]))
    return np.einsum("nd,nd->n", normals, facing) < 0


def _sides(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
