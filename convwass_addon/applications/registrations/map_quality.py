# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures of how well two shapes match that are deformed onto each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...geometry.deformation.poisson_deformation import stretches_of
from ...geometry.meshes.mesh import TriangleMesh
from ...geometry.meshes.normals import triangle_normals
from .carriers import Carrier
from .shape_deformations import ShapeDeformation

# Triangles with a larger logarithmic stretch count as torn: a factor of four.
_TORN = 1.4
# Shapes match beyond doubt with at least this mean confidence, and at most these fractions torn and folded.
_CONFIDENT, _LITTLE_TORN, _LITTLE_FOLDED = 0.97, 0.02, 0.01


@dataclass(frozen=True)
class MapQuality:
    """How well a deformed shape matches another.

    Attributes
    ----------
    confidence : float
        Mean confidence of the map, 0 to 1.
    torn : float
        Fraction of the area stretched or compressed by more than a factor of four.
    folded : float
        Fraction of the area that is oriented opposite to the surface that it lies on.
    crumpling : float
        Area of the deformed shape over that of the shape that it lies on: about 1 where it lies smoothly, and more
        where it lies in folds.
    """

    confidence: float
    torn: float
    folded: float
    crumpling: float

    def or_worse(self, other: MapQuality) -> MapQuality:
        """Return the worse of two records, figure by figure."""
        return MapQuality(
            confidence=min(self.confidence, other.confidence),
            torn=max(self.torn, other.torn),
            folded=max(self.folded, other.folded),
            crumpling=max(self.crumpling, other.crumpling),
        )

    @property
    def is_beyond_doubt(self) -> bool:
        """Whether the shapes match so well that the quality of the initial map is irrelevant."""
        return self.confidence >= _CONFIDENT and self.torn <= _LITTLE_TORN and self.folded <= _LITTLE_FOLDED


def map_quality(source: Carrier, target: Carrier, there: ShapeDeformation) -> MapQuality:
    """Measure how well the deformed source matches the target."""
    weights = source.mesh.vertex_areas / source.mesh.area
    areas = source.mesh.face_areas / source.mesh.area
    return MapQuality(
        confidence=float(weights @ there.confidence),
        torn=float(areas[stretches_of(source.mesh, there.points) > _TORN].sum()),
        folded=float(areas[_folded(source, target, there)].sum()),
        crumpling=TriangleMesh(there.points, source.mesh.faces).area / target.mesh.area,
    )


def _folded(source: Carrier, target: Carrier, there: ShapeDeformation) -> NDArray[np.bool_]:
    """Return the triangles that are oriented opposite to the surface at their first corner, (m,)."""
    faces = source.mesh.faces
    surface = target.mesh.corners[there.images.triangles[faces[:, 0]]]
    return (triangle_normals(there.points[faces]) * triangle_normals(surface)).sum(axis=1) < 0
