# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where vertices on the lists of guides and of pairs were when they were chosen."""

from __future__ import annotations

import bpy
from bpy.props import FloatVectorProperty, IntProperty

from ..bridge.vertex_places import Place


class PlaceProperties:
    """Mixin of groups that store a `Place`."""

    count: IntProperty(name="Count", description="Number of vertices of the mesh then; 0 if unknown", min=0)
    local: FloatVectorProperty(name="Local", description="Position of the vertex then, in local space")
    world: FloatVectorProperty(name="World", description="Position of the vertex then, in world space")
    edges: IntProperty(name="Edges", description="Checksum of the edges of the mesh then; 0 if unknown", min=0)

    @property
    def place(self) -> Place | None:
        """Where the vertex was; None if that is unknown, as in files of earlier versions."""
        return Place(self.count, tuple(self.local), tuple(self.world), self.edges) if self.count else None

    @place.setter
    def place(self, place: Place | None) -> None:
        if place is None:
            self.count = 0
        else:
            self.count, self.local, self.world, self.edges = place.count, place.local, place.world, place.edges


class CONVWASS_PG_vertex_place(PlaceProperties, bpy.types.PropertyGroup):
    """Where a vertex was."""
