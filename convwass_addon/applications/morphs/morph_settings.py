# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""How a morph is made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ...errors import InputError
from ...geometry.arrays.steps import linear_step
from ...schema import Choice, Companion, Settings, setting

# Automatic sharpness: the first value, rising to 1 where the largest weight exceeds the second.
_SHARPNESS = 0.75
_CRISP_FROM = 0.85
# Automatic blur: one cell, but no narrower than float64 permits across a grid. With one cell of a hundred, frames next
# to a distant shape exceed its range; with 1.25 none did. Other pairs widen it automatically (`blend_solver`).
_CELLS_PER_BLUR = 80.0
# With a sharpness s, errors that the kernel blurs away fall by 1 - s a round: near 1 they never do, and wrinkles stay
# (docs/performance, "Sharpness").
_SHARPEST = 0.95
# The automatic tolerance. That of the debiasing density falls with 1 - s beyond the automatic sharpness, because the
# errors that the kernel does not show grow as much.
_TOLERANCE = 1e-2
# At a locality of one half, mass moves a quarter of the longest side, and at least this many cells.
_REACHES = 4.0
_LEAST_REACH = 1.0


@dataclass(frozen=True)
class MorphSettings(Settings):
    """The settings of a morph."""

    resolution: int = setting(
        100,
        "Resolution",
        "Cells along the longest side of the volume; twice as many take about ten times as long and keep parts that "
        "are half as thin",
        least=8,
        most=1024,
        soft_most=160,
        unit="cells",
    )
    motion: str = setting(
        "automatic",
        "Motion",
        "How shapes move before the rest is transported",
        choices=(
            Choice(
                "automatic",
                "Automatic",
                "Guided where the shapes match; otherwise Warp completes or replaces it, or Transport is used where "
                "both would tear them",
            ),
            Choice("guided", "Guided", "Limbs swing: for poses, people, animals and other shapes of one build"),
            Choice("warp", "Warp", "Shapes bend smoothly towards each other: for shapes of different build"),
            Choice("transport", "Transport", "Matter flows to the nearest free place, as in the paper"),
        ),
        note="Flat shapes move part by part, or are transported",
        panel="motion",
    )
    coherence: float = setting(
        0.5,
        "Coherence",
        "How firmly shapes stay connected: 0 only transports, 0.5 moves them all the way, 1 keeps them stiffest",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="motion",
    )
    detail: float | None = setting(
        None,
        "Detail",
        "How much detail beyond the resolution blends keep: faces, wrinkles, sharp edges",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        switch=Companion(
            "use_custom_detail",
            "Set Detail",
            "Set the amount of detail; otherwise it is all, or none with the motion Transport",
            start=1.0,
        ),
        automatic="1, and 0 with the motion Transport, whose blends are those of the paper",
        note="Has no effect on flat shapes, nor where the surface is taken at the half maximum",
        panel="motion",
    )
    growth: str = setting(
        "volume",
        "Growth",
        "How blends of shapes of different size grow",
        choices=(
            Choice(
                "volume",
                "Even Volume",
                "Volume grows evenly, as if matter were added at a constant rate: small shapes grow fast at first",
            ),
            Choice("size", "Even Size", "Lengths grow evenly, as if the shapes were scaled"),
        ),
        note="Flat shapes always grow evenly in length, and shape keys of one mesh in volume",
        panel="motion",
    )
    on_floor: bool = setting(
        True,
        "Stay on Floor",
        "Shapes whose lowest points are at the same height stay on that floor while limbs swing, and feet that touch "
        "it do not slide",
        note="Has no effect with the motion Transport, nor on flat shapes",
        panel="motion",
    )
    sharpness: float | None = setting(
        None,
        "Sharpness",
        "0 is smooth and may melt details, 0.95 is crisp and may tear; larger values count as 0.95, because blends "
        "would wrinkle",
        least=0.0,
        most=1.0,
        soft_most=_SHARPEST,
        subtype="FACTOR",
        switch=Companion(
            "use_custom_sharpness",
            "Set Sharpness",
            "Set one sharpness for all frames instead of 0.75, rising to 0.95 close to the original shapes",
            start=_SHARPNESS,
        ),
        automatic=f"{_SHARPNESS:g}, rising to {_SHARPEST:g} close to the original shapes",
        note="0 is the paper's barycenter, 1 would be the debiased one",
        panel="solver",
    )
    blur: float | None = setting(
        None,
        "Blur",
        "Standard deviation of the transport's blur in cells; more is smoother and loses thin parts",
        least=0.5,
        most=20.0,
        soft_most=5.0,
        unit="cells",
        switch=Companion(
            "use_custom_blur",
            "Set Blur",
            "Set the blur by hand instead of one cell (or an eightieth of the resolution)",
            start=1.5,
        ),
        automatic="one cell, or an eightieth of the resolution (a hundredth for flat shapes) if that is more",
        panel="solver",
    )
    locality: float = setting(
        0.0,
        "Locality",
        "At 0, mass travels as far as it has to; the closer to 1, the shorter the distances, and what lies farther "
        "apart shrinks in one place and grows in the other",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        panel="solver",
    )
    entropy_limit: str | float | None = setting(
        None,
        "Entropy Limit",
        "Keep blends from spreading out more than this",
        choices=(
            Choice(None, "Off", "No limit"),
            Choice("max", "As the Inputs", "No blend spreads out more than the input that spreads out most"),
            Choice(float, "Custom", "Set the bound in nats"),
        ),
        number=Companion(
            "entropy_bound",
            "Entropy Bound",
            "Largest entropy of a blend, in nats; 0 fills the whole volume",
            start=-2.0,
        ),
        panel="solver",
    )
    level: str = setting(
        "volume",
        "Surface",
        "Where the surface is taken",
        choices=(
            Choice(
                "volume", "True Volume", "At the density that encloses the interpolated volume", identifier="volume"
            ),
            Choice(
                "half-max",
                "Half Maximum",
                "At half of the largest density; thin parts are lost, and the volume varies from frame to frame",
                identifier="half-max",
            ),
        ),
        panel="solver",
    )
    thin_parts: bool = setting(
        True,
        "Keep Thin Parts",
        "Thin parts keep their volume where one density for all would make them thinner or lose them",
        applies_when=("level", "volume"),
        panel="solver",
    )
    mend: bool = setting(
        True,
        "Mend",
        "Remove crumbs, narrow gaps and holes that the shapes do not have",
        applies_when=("level", "volume"),
        panel="solver",
    )
    thickness: float = setting(
        0.0,
        "Thickness",
        "Thickness given to shapes that enclose no volume, such as planes; 0 refuses them",
        least=0.0,
        soft_most=1.0,
        subtype="DISTANCE",
        note="In units of the scene",
        panel="solver",
        preset=False,
    )
    parts: str = setting(
        "none",
        "Parts",
        "Which parts of the shapes travel together: those of the same name on all shapes",
        choices=(
            Choice("none", "None", "The shapes travel as wholes", identifier="none"),
            Choice(
                "vertex-groups",
                "Vertex Groups",
                "Every face belongs to the vertex group with the most weight on it",
                identifier="vertex-groups",
            ),
            Choice("materials", "Materials", "Every face belongs to its material", identifier="materials"),
        ),
        panel="matching",
        preset=False,
    )
    tolerance: float | None = setting(
        None,
        "Tolerance",
        "A blend is solved when the errors of its marginals and of its debiasing density are smaller than this",
        least=0.0,
        most=1.0,
        open_ends=True,
        automatic=f"{_TOLERANCE:g}, and less for the debiasing density of blends that are sharper than {_SHARPNESS:g}",
        prop=None,
    )
    max_iterations: int = setting(
        200, "Iterations", "Most iterations on each level of the solver", least=1, prop=None, option=None
    )
    face_size: float = setting(
        1.0,
        "Face Size",
        "Length of the edges of blends; twice the length gives a quarter of the faces, and more where surfaces bend",
        least=0.5,
        most=3.0,
        unit="cells",
        note="Has no effect on flat shapes",
        panel="output",
    )
    carry: bool = setting(
        True,
        "Carry Attributes",
        "Let blends carry the colors, materials and vertex groups of the shapes, and the velocity for motion blur",
        panel="output",
        preset=False,
    )

    def __post_init__(self) -> None:
        """Check the settings.

        Raises
        ------
        InputError
            States the name of the setting and what it must be.
        """
        super().__post_init__()
        if self.locality > 0 and self.entropy_limit is not None:
            raise InputError("An entropy limit needs all mass to travel; set the locality to 0.")

    @property
    def heeds_guides(self) -> bool:
        """Whether the motion depends on guides."""
        return self.motion in ("automatic", "guided") and self.coherence > 0.0

    @property
    def carried_detail(self) -> float:
        """Fraction of the detail that blends carry, after the automatic choice."""
        if self.level != "volume":
            return 0.0
        if self.detail is not None:
            return self.detail
        return 0.0 if self.motion == "transport" else 1.0

    @property
    def sigma(self) -> float:
        """Blur in cells, after the automatic choice."""
        return max(1.0, self.resolution / _CELLS_PER_BLUR) if self.blur is None else self.blur

    @property
    def reach(self) -> float | None:
        """Distance in cells beyond which mass fades instead of moving; None if all of it moves."""
        if self.locality == 0:
            return None
        return max(self.resolution / _REACHES * (1.0 / self.locality - 1.0), _LEAST_REACH)

    def sharpness_at(self, weights: Sequence[float]) -> float:
        """Sharpness of the blend with these weights, after the automatic choice."""
        if self.sharpness is not None:
            return min(self.sharpness, _SHARPEST)
        near = linear_step(max(weights), _CRISP_FROM, 1.0)
        return min(float(_SHARPNESS + (1.0 - _SHARPNESS) * near**2 * (3.0 - 2.0 * near)), _SHARPEST)

    @property
    def stopping_error(self) -> float:
        """The tolerance of the marginals, with the automatic choice made."""
        return _TOLERANCE if self.tolerance is None else self.tolerance

    def debias_stopping_error_at(self, weights: Sequence[float]) -> float:
        """Tolerance of the debiasing density of the blend with these weights, after the automatic choice."""
        if self.tolerance is not None:
            return self.tolerance
        return _TOLERANCE * min((1.0 - self.sharpness_at(weights)) / (1.0 - _SHARPNESS), 1.0)
