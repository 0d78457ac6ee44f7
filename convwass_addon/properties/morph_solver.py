# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of what solves morphs."""

from __future__ import annotations

from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings


class SolverProperties:
    """What the solver of a morph is asked for."""

    resolution: IntProperty(
        name="Resolution",
        description="Cells along the longest side of the volume; twice as many take about ten times as long and keep "
        "parts that are half as thin",
        default=64,
        min=16,
        soft_max=160,
        max=512,
    )
    flat_resolution: IntProperty(
        name="Resolution",
        description="Cells along the longest side of flat shapes; twice as many take about four times as long and keep "
        "strokes that are half as wide",
        default=512,
        min=256,
        max=1024,
    )
    words: EnumProperty(
        name="Words",
        description="How texts and other shapes of several parts travel, where all shapes are flat",
        items=(
            ("MASS", "As One Mass", "All that a shape fills travels together"),
            ("LETTERS", "Letter by Letter", "Letters travel to letters in reading order"),
        ),
    )
    use_custom_blur: BoolProperty(
        name="Set Blur", description="Set the blur by hand instead of one cell (or an eightieth of the resolution)"
    )
    blur: FloatProperty(
        name="Blur",
        description="Standard deviation of the transport's blur in cells; more is smoother and loses thin parts",
        default=1.5,
        min=0.5,
        max=20.0,
        soft_max=5.0,
    )
    use_custom_sharpness: BoolProperty(
        name="Set Sharpness",
        description="Set one sharpness for all frames instead of 0.75, rising to 1 close to the original shapes",
    )
    sharpness: FloatProperty(
        name="Sharpness",
        description="0 is smooth and may melt details, 1 is crisp and may tear",
        default=0.75,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    entropy_limit: EnumProperty(
        name="Entropy Limit",
        description="Keep blends from spreading out more than this",
        items=(
            ("OFF", "Off", "No limit"),
            ("MAX", "As the Inputs", "No blend spreads out more than the input that spreads out most"),
            ("NUMBER", "Custom", "Set the bound in nats"),
        ),
    )
    entropy_bound: FloatProperty(
        name="Entropy Bound", description="Largest entropy of a blend, in nats; 0 fills the whole volume", default=-2.0
    )
    level: EnumProperty(
        name="Surface",
        description="Where the surface is taken",
        items=(
            ("volume", "True Volume", "At the density that encloses the interpolated volume"),
            ("half-max", "Half Maximum", "At half of the largest density; thin parts are lost and the volume breathes"),
        ),
    )
    thickness: FloatProperty(
        name="Thickness",
        description="Thickness given to shapes that enclose no volume, such as planes; 0 refuses them",
        default=0.0,
        min=0.0,
        soft_max=1.0,
        subtype="DISTANCE",
    )
    parts: EnumProperty(
        name="Parts",
        description="Which parts of the shapes travel together: those of the same name on all shapes",
        items=(
            ("none", "None", "The shapes travel as wholes"),
            ("vertex-groups", "Vertex Groups", "Every face belongs to the vertex group with the most weight on it"),
            ("materials", "Materials", "Every face belongs to its material"),
        ),
    )
    locality: FloatProperty(
        name="Locality",
        description="At 0 all mass travels; towards 1 it goes less and less far, and parts shrink in one place and "
        "grow in another",
        default=0.0,
        min=0.0,
        max=1.0,
        subtype="FACTOR",
    )
    thin_parts: BoolProperty(
        name="Keep Thin Parts",
        description="Thin parts keep their volume where one density for all would make them thinner or lose them",
        default=True,
    )
    mend: BoolProperty(
        name="Mend",
        description="Drop crumbs, bridge narrow gaps and close false holes, as far as the shapes themselves have none",
        default=True,
    )
    carry: BoolProperty(
        name="Carry Looks",
        description="Let blends carry the colors, materials and vertex groups of the shapes, and the velocity for "
        "motion blur",
        default=True,
    )

    def solver_settings(self) -> MorphSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return MorphSettings(
            resolution=self.resolution,
            blur=self.blur if self.use_custom_blur else None,
            sharpness=self.sharpness if self.use_custom_sharpness else None,
            entropy_limit={"OFF": None, "MAX": "max", "NUMBER": self.entropy_bound}[self.entropy_limit],
            level=self.level,
            thickness=self.thickness,
            locality=self.locality,
            thin_parts=self.thin_parts,
            mend=self.mend,
            parts=self.parts,
            carry=self.carry,
        )

    def flat_settings(self) -> FlatSettings:
        """Return the settings of the application where all shapes are flat; raises InputError as above."""
        shared = self.solver_settings().as_dict()
        own = {"resolution": self.flat_resolution, "words": self.words.lower(), "parts": "none"}
        return FlatSettings(**{**shared, **own})
