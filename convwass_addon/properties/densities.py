# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of densities, stored with each mesh object, and the last figures measured on it."""

from __future__ import annotations

import bpy
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    FloatProperty,
    IntProperty,
    StringProperty,
)

from ..applications.densities.density_settings import DensitySettings
from ..bridge.densities.density_nodes import NAME
from ..bridge.densities.density_request import DensityRequest
from .from_schema import values_of, with_properties
from .registration import registration

DEFAULT_FOLDER = "//density"
"""Next to the .blend file."""

OUTPUTS = (
    ("GROUPS", "Vertex Groups", "One vertex group per step"),
    ("COLORS", "Color Attributes", "One color attribute per step, as a heat map"),
    (
        "ANIMATED_COLOR",
        "Animated Color",
        "One color attribute that shows the heat map of the current frame, without images",
    ),
    ("IMAGES", "Images", "One grayscale image per step, using the UV map"),
)
"""The outputs of an animated density, as items of an enum."""

ON_SURFACE = ("blur", "pieces")
"""Settings of every solve on a surface."""

_LENGTH = {"min": 0.0, "subtype": "DISTANCE", "precision": 3}


def length_property() -> object:
    """Return the property for the length of a diffusion."""
    return FloatProperty(
        name="Length",
        description="Standard deviation by which the density spreads along the surface; 0 for a twentieth of the "
        "width of the surface",
        soft_max=1.0,
        **_LENGTH,
    )


def share_property() -> object:
    """Return the property for the amount of sharpening."""
    return FloatProperty(
        name="Share",
        description="Share of its area that the density covers afterwards",
        default=0.5,
        min=0.01,
        max=1.0,
        subtype="FACTOR",
    )


def radius_property() -> object:
    """Return the property for the radius of a dropped mass."""
    return FloatProperty(
        name="Radius",
        description="Distance by which the dropped mass spreads along the surface; 0 keeps it on the vertices",
        soft_max=1.0,
        **_LENGTH,
    )


@with_properties(DensitySettings, only=ON_SURFACE)
class SurfaceProperties:
    """Properties of every solve on a surface."""


@with_properties(DensitySettings, without=(*ON_SURFACE, "steps"))
class TravelProperties(SurfaceProperties):
    """Properties of densities computed from others."""

    def density_settings(self, steps: int = DensitySettings.steps) -> DensitySettings:
        """Return the settings of the application; raises InputError if they are invalid."""
        return DensitySettings(steps, **values_of(self, DensitySettings, without=("steps",)))


@with_properties(DensityRequest)
@with_properties(DensitySettings, only=("steps",))
class PathProperties(TravelProperties):
    """Properties of an animated density."""

    density: StringProperty(
        name="Name",
        description="Name of the animated attribute, for materials and Geometry Nodes; an attribute of the same name "
        "is replaced",
        default=NAME,
    )
    add_material: BoolProperty(
        name="Show Heat Map",
        description="Assign a material that shows the density, if the object has none",
        default=True,
    )

    def request(self) -> DensityRequest:
        """Return the request stored with a density, in addition to the solver settings."""
        return DensityRequest(**values_of(self, DensityRequest))


class OutputProperties:
    """Properties for baking an animated density."""

    output: EnumProperty(name="Output", description="Destination of the steps of the density", items=OUTPUTS)
    folder: StringProperty(
        name="Folder",
        description="Folder for the images; // is the folder of the .blend file",
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
        description="Pixels filled around the islands of the UV map, so that seams do not show",
        default=8,
        min=0,
        max=256,
        subtype="PIXEL",
    )
    file_format: EnumProperty(
        name="Format",
        description="File format of the images",
        items=(
            ("PNG", "PNG", "16 bits; white is the maximum over all steps"),
            ("OPEN_EXR", "OpenEXR", "32 bits with unscaled values"),
        ),
    )


class CONVWASS_PG_density_stop(bpy.types.PropertyGroup):
    """A stop on the path of a density."""

    group: StringProperty(
        name="Group",
        description="Vertex group at this stop; Propagate fills in groups that are missing or empty",
    )
    frame: FloatProperty(
        name="Frame",
        description="Scene frame at which the density reaches this group",
        default=1.0,
        precision=1,
    )
    weight: FloatProperty(
        name="Weight",
        description="Share of this group in a blend, relative to the others",
        default=1.0,
        min=0.0,
        soft_max=1.0,
    )
    enabled: BoolProperty(name="Enabled", description="Whether this stop is used", default=True)


class CONVWASS_PG_densities(PathProperties, OutputProperties, bpy.types.PropertyGroup):
    """Settings of the densities of an object."""

    first: StringProperty(name="First", description="Vertex group at the start")
    second: StringProperty(name="Second", description="Vertex group at the end")
    stops: CollectionProperty(
        name="Stops",
        description="Groups to pass through or to blend, in this order; if empty, the first and the second group",
        type=CONVWASS_PG_density_stop,
    )
    active_stop: IntProperty(name="Active Stop", description="The stop that the buttons next to the list act on", min=0)
    edges: StringProperty(
        name="Edges",
        description="Pairs of stops that should be close to each other, by their numbers from 0, such as 0-1, 1-2, "
        "1-3; empty for a chain",
    )
    length: length_property()
    share: share_property()
    radius: radius_property()

    @property
    def enabled_stops(self) -> list[CONVWASS_PG_density_stop]:
        """The enabled stops."""
        return [stop for stop in self.stops if stop.enabled]


class CONVWASS_PG_density_findings(bpy.types.PropertyGroup):
    """The last figures measured on an object."""

    group: StringProperty(name="Group")
    covered: FloatProperty(name="Covered")
    radius: FloatProperty(name="Radius")
    entropy: FloatProperty(name="Entropy")
    first: StringProperty(name="First")
    second: StringProperty(name="Second")
    distance: FloatProperty(name="Distance")
    table: StringProperty(name="Table")


register, unregister = registration(
    (CONVWASS_PG_density_stop, CONVWASS_PG_densities, CONVWASS_PG_density_findings),
    (
        (bpy.types.Object, "convwass_density", CONVWASS_PG_densities),
        (bpy.types.Object, "convwass_density_findings", CONVWASS_PG_density_findings),
    ),
)
