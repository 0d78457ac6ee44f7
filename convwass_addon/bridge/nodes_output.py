# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the modifiers of an object make, since Geometry Nodes turn objects of any type into others."""

from __future__ import annotations

from dataclasses import dataclass

import bpy

from .visibility import evaluated_object

RADIUS = "radius"
"""Attribute of strands and points."""

_SPLINES = ("FONT", "CURVE", "SURFACE")


@dataclass(frozen=True)
class NodesOutput:
    """Kinds of geometry that an object consists of after its modifiers.

    Attributes
    ----------
    mesh, instances, volume : bool
        Whether there are faces, instances, or a volume.
    strands, points : bool
        Whether there are any with a radius. Splines of curves and texts are not strands.
    lacks_radius : bool
        Whether there are strands or points without a radius.
    """

    mesh: bool = False
    instances: bool = False
    volume: bool = False
    strands: bool = False
    points: bool = False
    lacks_radius: bool = False

    @property
    def is_mesh(self) -> bool:
        """Whether there are faces and nothing else that encloses volume."""
        return self.mesh and not (self.instances or self.volume or self.strands or self.points)


def has_nodes(obj: bpy.types.Object) -> bool:
    """Return whether an object has Geometry Nodes."""
    return any(modifier.type == "NODES" for modifier in obj.modifiers)


def nodes_output(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> NodesOutput:
    """Return what an object consists of after its modifiers.

    Parameters
    ----------
    obj : bpy.types.Object
        The original (not evaluated) object; may be hidden.
    depsgraph : bpy.types.Depsgraph
        ``context.evaluated_depsgraph_get()``; updated here.
    """
    with evaluated_object(obj, depsgraph) as evaluated:
        made = evaluated.evaluated_geometry()
        strands = made.curves if obj.type not in _SPLINES else None
        thin = [own for own in (strands, made.pointcloud) if own is not None and len(own.points)]
        return NodesOutput(
            mesh=made.mesh is not None and len(made.mesh.polygons) > 0,
            instances=made.instances_pointcloud() is not None,
            volume=made.volume is not None,
            strands=_has_radius(strands),
            points=_has_radius(made.pointcloud),
            lacks_radius=not all(map(_has_radius, thin)),
        )


def _has_radius(data: bpy.types.Curves | bpy.types.PointCloud | None) -> bool:
    return data is not None and RADIUS in data.attributes
