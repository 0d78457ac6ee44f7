# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How far two shapes that are deformed onto each other agree, as figures."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

import numpy as np
from numpy.typing import NDArray

from ...geometry.poisson_deformation import deformation_gradients
from ...geometry.weighted_quantile import weighted_quantile
from .carriers import Carrier
from .shape_deformations import ShapeDeformation

# Vertices with less confidence are counted as doubtful.
_DOUBTFUL = 0.3
# Triangles that are stretched or squeezed by more than this, as a logarithm, are torn: four times.
_TORN = 1.4
# Shapes lie on each other beyond doubt from this mean confidence on, and with no larger shares torn and folded.
_CONFIDENT, _LITTLE_TORN, _LITTLE_FOLDED = 0.97, 0.02, 0.01


@dataclass(frozen=True)
class MapQuality:
    """How well one shape is deformed onto another; lengths in sizes of the surface (the square root of its area).

    Attributes
    ----------
    confidence : float
        Mean confidence of the map, 0 to 1.
    doubtful : float
        Share of the area with little confidence.
    round_trip, round_trip_95 : float
        Mean distance between a point and where the way there and back ends, and the one that 95 % of the area stay
        below.
    left, left_99 : float
        Distance from the other surface that is left after deforming: mean, and what 99 % stay below.
    stretch : float
        Mean largest logarithmic stretch of triangles, up or down.
    torn : float
        Share of the area that is stretched or squeezed more than four times.
    folded : float
        Share of the area that looks the other way than the surface it has come to lie on.
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
        """Return the worse figure of two, one by one."""
        worst = {own.name: max(getattr(self, own.name), getattr(other, own.name)) for own in fields(self)}
        return MapQuality(**{**worst, "confidence": min(self.confidence, other.confidence)})

    @property
    def is_beyond_doubt(self) -> bool:
        """Whether the shapes fit so well that it does not matter how good the map was that they began from."""
        return self.confidence >= _CONFIDENT and self.torn <= _LITTLE_TORN and self.folded <= _LITTLE_FOLDED

    def as_dict(self) -> dict[str, float]:
        """Return the figures ready for JSON."""
        return {name: round(value, 5) for name, value in asdict(self).items()}


def map_quality(source: Carrier, target: Carrier, there: ShapeDeformation, back: ShapeDeformation) -> MapQuality:
    """Measure the deformation of the source onto the target; `back` is that of the target."""
    mesh, other = source.mesh, target.mesh
    weights = mesh.vertex_areas / mesh.area
    home = there.images.interpolated(back.points[other.faces])
    trip = np.linalg.norm(home - mesh.vertices, axis=1) / source.size
    left = there.images.distances / target.size
    areas = np.linalg.norm(np.cross(*_sides(mesh.corners)), axis=1)
    areas = areas / areas.sum()
    # The third column is a normal, which grows with the others.
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
    """Tell which triangles look away from the surface that their first corner has come to lie on, (m,)."""
    faces = source.mesh.faces
    normals = np.cross(*_sides(there.points[faces]))
    facing = np.cross(*_sides(target.mesh.corners[there.images.triangles[faces[:, 0]]]))
    return np.einsum("nd,nd->n", normals, facing) < 0


def _sides(corners: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    return corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
