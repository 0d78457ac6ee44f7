# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for moving densities along a surface."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Companion, Settings, setting


@dataclass(frozen=True)
class DensitySettings(Settings):
    """Settings for moving densities along a surface."""

    steps: int = setting(
        24,
        "Steps",
        "Steps from each group to the next; between them frames are mixed",
        least=1,
        most=10_000,
        soft_most=100,
        note="24 make 23 frames between the two",
        panel="path",
    )
    entropy_limit: str | float | None = setting(
        "between",
        "Entropy Limit",
        "Keep densities from spreading out more than this on their way",
        choices=(
            Choice(None, "Off", "No limit"),
            Choice(
                "between",
                "As the Groups",
                "Interpolate the spread between the one group and the next",
            ),
            Choice("max", "As the Widest Group", "No density spreads out more than the widest group"),
            Choice(float, "Custom", "Set the bound in nats"),
        ),
        number=Companion(
            "entropy_bound",
            "Entropy Bound",
            "Largest entropy of a density, in nats; 0 covers the whole surface evenly",
            start=-2.0,
        ),
        note='For blends "between" goes by their weights, and at the places of a graph it is "max"; without a limit '
        "densities spread as the plain barycenters of the paper do",
        panel="path",
    )
    blur: float | None = setting(
        None,
        "Blur",
        "Standard deviation of the transport's blur along the surface; 0 chooses it from the mesh. A longer blur "
        "carries mass farther and is smoother",
        help="Standard deviation of the transport's blur along the surface, in units of the scene; a longer blur "
        "carries mass farther and is smoother",
        least=0.0,
        open_ends=True,
        soft_most=1.0,
        subtype="DISTANCE",
        precision=3,
        zero_is_automatic=True,
        automatic="what suits the mesh",
        panel="solver",
    )
    pieces: str = setting(
        "keep",
        "Pieces",
        "What to do where groups have different shares of their mass on the connected pieces of the mesh, between "
        "which nothing can travel",
        choices=(
            Choice("keep", "Keep", "Refuse such groups, and name the pieces", identifier="keep"),
            Choice(
                "match",
                "Match",
                "Scale each group on every piece to the share that the first one has there",
                identifier="match",
            ),
        ),
        option="--match-pieces",
        flag="match",
        panel="solver",
    )
    blend_sharpness: float = setting(
        0.75,
        "Sharpness",
        "How much of the blur is taken out of blends of several groups, which keeps their peaks apart",
        least=0.0,
        most=1.0,
        subtype="FACTOR",
        note="It acts before the bound of the entropy, which alone would melt the peaks into one",
        panel="solver",
    )
    tolerance: float = setting(
        1e-2,
        "Tolerance",
        "Marginal error at which a density is done; less is more accurate and takes longer",
        least=0.0,
        most=1.0,
        open_ends=True,
        soft_least=1e-6,
        soft_most=0.5,
        precision=4,
        panel="solver",
    )
    max_iterations: int = setting(
        500,
        "Iterations",
        "Largest number of solver iterations",
        least=1,
        soft_most=2000,
        panel="solver",
    )
    substeps: int = setting(
        10,
        "Substeps",
        "Time steps of the kernel; 20 for distances accurate to a percent",
        least=1,
        most=100,
        prop=None,
    )
