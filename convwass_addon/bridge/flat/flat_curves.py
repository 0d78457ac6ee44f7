# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write outlines as curve objects, and convert flat objects to meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.flat.flat_frames import FlatFrame
from ...geometry.plane.fitting import BezierRing, fitted_beziers
from ...geometry.plane.outlines import Outline, ring_area
from ..element_values import element_values, write_floats
from .flat_rings import CurveStyle

# Steps per curve segment, which is short: the first with which Blender fills the whole area. Where points are
# close to each other, it may leave out an arm behind a narrow neck.
_STEPS = (8, 12, 6, 16, 5)
# Largest missing or excess share of the filled area.
_MISSING = 0.005
# Factor on the fitting error where curves share borders, so that no gaps are visible.
_BORDER = 1 / 3
# Blender's handle types.
_FREE, _ALIGNED = 0, 3


@dataclass(frozen=True)
class FittedFrame(FlatFrame):
    """A finished blend of flat shapes, with the curves of its object.

    Attributes
    ----------
    curves : tuple of BezierRing
        In the plane of the blend: the curves of all regions, or of the whole outline.
    owners : tuple of int
        Index of the region of every curve; 0 if there is only one.
    """

    curves: tuple[BezierRing, ...] = ()
    owners: tuple[int, ...] = ()

    @classmethod
    def of(cls, frame: FlatFrame, error: float) -> FittedFrame:
        """Fit curves to the outline of a frame, with an error in cells, without accessing Blender's data."""
        outlines = [region.outline for region in frame.regions]
        if outlines:
            error *= _BORDER
        elif frame.outline is not None:
            outlines = [frame.outline]
        fitted = [fitted_beziers(outline, error * frame.record["cell"]) for outline in outlines]
        owners = tuple(number for number, own in enumerate(fitted) for _ in own)
        return cls(**vars(frame), curves=tuple(ring for own in fitted for ring in own), owners=owners)

    def grouped(self, outline: Outline, number: int) -> tuple[tuple[BezierRing, ...], ...]:
        """Return the curves of region `number`, grouped by parts: an outer ring and its holes."""
        own = iter(ring for ring, owner in zip(self.curves, self.owners, strict=True) if owner == number)
        return tuple(tuple(next(own) for _ in region.rings) for region in outline.regions)


def write_curves(
    curve: bpy.types.Curve, curves: Sequence[BezierRing], style: CurveStyle, slots: Sequence[int] | None = None
) -> None:
    """Replace the splines of a curve; its materials are kept.

    Parameters
    ----------
    curve : bpy.types.Curve
        Its local X and Y axes are those of the plane.
    curves : sequence of BezierRing
        An outline.
    style : CurveStyle
        Depth and fill.
    slots : sequence of int, optional
        Material slot of every ring; rings with the same slot are filled together.
    """
    _prepare(curve, style)
    for ring, slot in zip(curves, slots or [0] * len(curves), strict=True):
        _add_spline(curve, ring).material_index = slot
    if style.fill_mode != "NONE":
        _choose_steps(curve, curves)


def write_rings(curve: bpy.types.Curve, rings: Sequence[NDArray[np.float64]], style: CurveStyle) -> None:
    """Replace the splines of a curve by closed polygons, (n, 2) each."""
    _prepare(curve, style)
    for ring in rings:
        spline = curve.splines.new("POLY")
        spline.points.add(len(ring) - 1)
        places = np.concatenate([ring, np.zeros((len(ring), 1)), np.ones((len(ring), 1))], axis=1)
        write_floats(spline.points, "co", places)
        spline.use_cyclic_u = True


def _prepare(curve: bpy.types.Curve, style: CurveStyle) -> None:
    curve.splines.clear()
    curve.dimensions = "2D"
    curve.fill_mode = style.fill_mode
    curve.extrude, curve.bevel_depth, curve.offset = style.extrude, style.bevel_depth, style.offset
    curve.bevel_resolution = style.bevel_resolution
    curve.resolution_u = _STEPS[0]


def _choose_steps(curve: bpy.types.Curve, rings: Sequence[BezierRing]) -> None:
    """Set the first number of steps with which Blender fills the area between the rings, or else the usual one."""
    for steps in _STEPS:
        curve.resolution_u = steps
        area = sum(ring_area(ring.sampled(steps)) for ring in rings)
        if abs(_filled_area(curve) - area) <= _MISSING * area:
            return
    curve.resolution_u = _STEPS[0]


def _filled_area(curve: bpy.types.Curve) -> float:
    """Return the area that Blender fills, without depth."""
    flat = curve.copy()
    flat.extrude = flat.bevel_depth = flat.offset = 0.0
    flat.fill_mode = "FRONT"
    obj = bpy.data.objects.new(curve.name, flat)
    mesh = mesh_of(obj)
    areas = element_values(mesh.polygons, "area")
    bpy.data.meshes.remove(mesh)
    bpy.data.objects.remove(obj)
    bpy.data.curves.remove(flat)
    return float(areas.sum(dtype=np.float64))


def _add_spline(curve: bpy.types.Curve, ring: BezierRing) -> bpy.types.Spline:
    spline = curve.splines.new("BEZIER")
    points = spline.bezier_points
    points.add(len(ring.points) - 1)
    kinds = np.where(ring.corners, _FREE, _ALIGNED).astype(np.int32)
    for name in ("handle_left_type", "handle_right_type"):
        points.foreach_set(name, kinds)
    for name, places in (("co", ring.points), ("handle_left", ring.left), ("handle_right", ring.right)):
        write_floats(points, name, np.pad(places, ((0, 0), (0, 1))))
    spline.use_cyclic_u = True
    return spline


def mesh_of(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Convert a curve or text object to a mesh, with fill, bevel and extrusion but without modifiers."""
    mesh = bpy.data.meshes.new_from_object(obj)
    mesh.name = obj.name
    return mesh
