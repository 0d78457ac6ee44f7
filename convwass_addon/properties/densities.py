# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of densities on surfaces, as each mesh object has its own, and what was last found out about it."""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    PointerProperty,
    StringProperty,
)

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.density_nodes import NAME
from ..bridge.densities.density_request import DensityRequest
from .from_schema import values_of, with_properties

DEFAULT_FOLDER = "//density"
"""Beside the .blend file."""

OUTPUTS = (
    ("GROUPS", "Vertex Groups", "One vertex group for each step"),
    ("COLORS", "Color Attributes", "One color attribute for each step, in the colors of a heat map"),
    ("ANIMATED_COLOR", "Animated Color", "One color attribute that shows the heat map of every frame, without images"),
    ("IMAGES", "Images", "One grayscale image for each step, through the UV map"),
)
"""What a played density can be baked to, as items of an enum."""

ON_SURFACE = ("blur", "pieces")
"""The settings that every solve on a surface takes."""

_LENGTH = {"min": 0.0, "subtype": "DISTANCE", "precision": 3}


def length_property() -> object:
    """Return the property of how far a density is diffused."""
    return FloatProperty(
        name="Length",
        description="Standard deviation that the density gains along the surface; 0 takes a twentieth of the surface's "
        "width",
        soft_max=1.0,
        **_LENGTH,
    )


def share_property() -> object:
    """Return the property of how much a density is sharpened."""
    return FloatProperty(
        name="Share",
        description="Share of its area that the density covers afterwards",
        default=0.5,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )


def radius_property() -> object:
    """Return the property of how far a dropped mass is spread."""
    return FloatProperty(
        name="Radius",
        description="Length by which a dropped mass is spread along the surface; 0 leaves it on the vertices alone",
        soft_max=1.0,
        **_LENGTH,
    )


@with_properties(DensitySettings, only=ON_SURFACE)
class SurfaceProperties:
    """What every solve on a surface is asked for."""


@with_properties(DensitySettings, without=(*ON_SURFACE, "steps"))
class TravelProperties(SurfaceProperties):
    """What every density that is made of others is asked for."""

    def density_settings(self, steps: int = DensitySettings.steps) -> DensitySettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return DensitySettings(steps, **values_of(self, DensitySettings, without=("steps",)))


@with_properties(DensityRequest)
@with_properties(DensitySettings, only=("steps",))
class PathProperties(TravelProperties):
    """What a density that travels is asked for besides."""

    density: StringProperty(
        name="Name",
        description="Name of the animated attribute, which materials and Geometry Nodes read; one of the same name is "
        "replaced",
        default=NAME,
    )
    add_material: BoolProperty(
        name="Show Heat Map",
        description="Give the object a material that shows the density, if it has none",
        default=True,
    )

    def request(self) -> DensityRequest:
        """Return what is stored with a density besides the settings of its solver."""
        return DensityRequest(**values_of(self, DensityRequest))


class OutputProperties:
    """What else a played density is baked to."""

    output: EnumProperty(name="Output", description="What the steps of the density are written to", items=OUTPUTS)
    folder: StringProperty(
        name="Folder",
        description="Where images go; // is the folder of the .blend file",
        default=DEFAULT_FOLDER,
        subtype="DIR_PATH",
        options={"PATH_SUPPORTS_BLEND_RELATIVE"},
    )
    size: IntProperty(
        name="Size",
        description="Pixels along each side of an image",
        default=1024,
        min=16,
        soft_max=4096,
        max=16384,
        subtype="PIXEL",
    )
    margin: IntProperty(
        name="Margin",
        description="Pixels around the islands of the UV map that are filled, so that no seams show",
        default=8,
        min=0,
        max=256,
        subtype="PIXEL",
    )
    file_format: EnumProperty(
        name="Format",
        description="Which files are written",
        items=(
            ("PNG", "PNG", "16 bits; white is the largest value of all steps"),
            ("OPEN_EXR", "OpenEXR", "32 bits, the values as they are"),
        ),
    )


class CONVWASS_PG_density_stop(bpy.types.PropertyGroup):
    """A group on the list of stops."""

    group: StringProperty(
        name="Group",
        description="Vertex group that the density comes to here; for Propagate, one that is left out, missing or "
        "empty is filled in",
    )
    frame: FloatProperty(
        name="Frame",
        description="Scene frame at which the density has come to this group",
        default=1.0,
        precision=1,
    )
    weight: FloatProperty(
        name="Weight",
        description="Share of this group in a blend, compared with those of the others",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this stop takes part", default=True)


class CONVWASS_PG_densities(PathProperties, OutputProperties, bpy.types.PropertyGroup):
    """Settings of the densities of an object."""

    first: StringProperty(name="First", description="Vertex group that the density starts from")
    second: StringProperty(name="Second", description="Vertex group that the density goes to")
    stops: CollectionProperty(
        name="Stops",
        description="Groups to go through or to blend, in this order; while there are none, the first and the second "
        "group count",
        type=CONVWASS_PG_density_stop,
    )
    active_stop: IntProperty(name="Active Stop", description="The stop that buttons beside the list act on", min=0)
    edges: StringProperty(
        name="Edges",
        description="Pairs of stops that are to be near to each other, by their numbers from 0, such as 0-1, 1-2, 1-3; "
        "empty for a chain",
    )
    length: length_property()
    share: share_property()
    radius: radius_property()

    @property
    def enabled_stops(self) -> list[CONVWASS_PG_density_stop]:
        """The stops that take part."""
        return [stop for stop in self.stops if stop.enabled]


class CONVWASS_PG_density_findings(bpy.types.PropertyGroup):
    """What was last found out about the densities of an object."""

    group: StringProperty(name="Group")
    covered: FloatProperty(name="Covered")
    radius: FloatProperty(name="Radius")
    entropy: FloatProperty(name="Entropy")
    first: StringProperty(name="First")
    second: StringProperty(name="Second")
    distance: FloatProperty(name="Distance")
    table: StringProperty(name="Table")


_classes = (CONVWASS_PG_density_stop, CONVWASS_PG_densities, CONVWASS_PG_density_findings)
_register_classes, _unregister_classes = bpy.utils.register_classes_factory(_classes)


def register() -> None:
    """Add the settings and the findings to objects."""
    _register_classes()
    bpy.types.Object.convwass_density = PointerProperty(type=CONVWASS_PG_densities)
    bpy.types.Object.convwass_density_findings = PointerProperty(type=CONVWASS_PG_density_findings)


def unregister() -> None:
    """Take both away."""
    del bpy.types.Object.convwass_density_findings
    del bpy.types.Object.convwass_density
    _unregister_classes()
