# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Outlines as curve objects, and flat objects as meshes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.flat.flat_frames import FlatFrame
from ...geometry.fitting import BezierRing, fitted_beziers
from .flat_rings import CurveLook

# Steps of a curve's piece in Blender: pieces are short.
_STEPS = 8
# Numbers of Blender's kinds of handles.
_FREE, _ALIGNED = 0, 3


@dataclass(frozen=True)
class FittedFrame(FlatFrame):
    """A finished blend of flat shapes, with the curves that its object is made of.

    Attributes
    ----------
    curves : tuple of BezierRing
        In the plane of the blend.
    """

    curves: tuple[BezierRing, ...] = ()

    @classmethod
    def of(cls, frame: FlatFrame, error: float) -> FittedFrame:
        """Fit curves to the outline of a frame, within so many cells; it touches nothing of Blender."""
        curves = () if frame.outline is None else fitted_beziers(frame.outline, error * frame.record["cell"])
        return cls(**vars(frame), curves=curves)


def write_curves(curve: bpy.types.Curve, curves: Sequence[BezierRing], look: CurveLook) -> None:
    """Replace the splines of a curve, whose materials stay.

    Parameters
    ----------
    curve : bpy.types.Curve
        Its own X and Y are those of the plane.
    curves : sequence of BezierRing
        An outline.
    look : CurveLook
        Depth and fill.
    """
    _prepare(curve, look)
    for ring in curves:
        _add_spline(curve, ring)


def write_rings(curve: bpy.types.Curve, rings: Sequence[NDArray[np.float64]], look: CurveLook) -> None:
    """Replace the splines of a curve by closed polygons, (n, 2) each, as they are."""
    _prepare(curve, look)
    for ring in rings:
        spline = curve.splines.new("POLY")
        spline.points.add(len(ring) - 1)
        places = np.concatenate([ring, np.zeros((len(ring), 1)), np.ones((len(ring), 1))], axis=1)
        spline.points.foreach_set("co", places.astype(np.float32).ravel())
        spline.use_cyclic_u = True


def _prepare(curve: bpy.types.Curve, look: CurveLook) -> None:
    curve.splines.clear()
    curve.dimensions = "2D"
    curve.fill_mode = look.fill_mode
    curve.extrude, curve.bevel_depth, curve.offset = look.extrude, look.bevel_depth, look.offset
    curve.bevel_resolution = look.bevel_resolution
    curve.resolution_u = _STEPS


def _add_spline(curve: bpy.types.Curve, ring: BezierRing) -> None:
    spline = curve.splines.new("BEZIER")
    points = spline.bezier_points
    points.add(len(ring.points) - 1)
    kinds = np.where(ring.corners, _FREE, _ALIGNED).astype(np.int32)
    for name in ("handle_left_type", "handle_right_type"):
        points.foreach_set(name, kinds)
    for name, places in (("co", ring.points), ("handle_left", ring.left), ("handle_right", ring.right)):
        points.foreach_set(name, np.pad(places, ((0, 0), (0, 1))).astype(np.float32).ravel())
    spline.use_cyclic_u = True


def mesh_of(obj: bpy.types.Object) -> bpy.types.Mesh:
    """Make a mesh of a curve or text object as Blender fills, bevels and extrudes it; modifiers are left out."""
    mesh = bpy.data.meshes.new_from_object(obj)
    mesh.name = obj.name
    return mesh
