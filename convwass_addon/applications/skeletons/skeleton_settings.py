# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for fitting a skeleton into a body."""

from __future__ import annotations

from dataclasses import dataclass

from ...schema import Choice, Companion, Settings, setting


@dataclass(frozen=True)
class SkeletonSettings(Settings):
    """Settings for fitting a skeleton into a body."""

    weights: str = setting(
        "length",
        "Lengths",
        "How bones share the distance between pinned joints",
        choices=(
            Choice(
                "length",
                "Proportional",
                "Bones keep the proportions that they had when the first joint was pinned; Unpin All forgets these",
                word="proportional",
            ),
            Choice("uniform", "All Alike", "All bones get the same length", word="alike"),
        ),
        option="--lengths",
        panel="settings",
    )
    placement: str = setting(
        "centered",
        "Placement",
        "Where to place joints within the limbs",
        choices=(
            Choice("centered", "Centered", "Settle joints along the middle of the limbs"),
            Choice(
                "expected",
                "As Published",
                "Leave joints at the means of their distributions, as in the paper; where limbs are thin or bent, "
                "those leave the body",
            ),
        ),
        panel="settings",
    )
    outside_pins: str = setting(
        "refuse",
        "Pins Outside",
        "What to do with joints that are pinned outside the body",
        choices=(
            Choice("refuse", "Refuse", "Say which they are, and change nothing"),
            Choice("move", "Move Inside", "Move them to the nearest place inside"),
        ),
        option="--move-pins",
        flag="move",
        help="Move pins that are outside to the nearest place inside",
        panel="settings",
    )
    gamma: float = setting(
        0.003,
        "Blur",
        "How much is blurred on the surface of the body, rescaled to an area of 1: with more, joints come to lie "
        "deeper and bones straighter, with too much all of them in the middle",
        least=1e-5,
        most=1.0,
        soft_least=0.001,
        soft_most=0.01,
        precision=4,
        step=0.05,
        option="--blur",
        note="It is the regularization gamma",
        panel="settings",
    )
    links: int = setting(
        2,
        "Links",
        "Number of links that a bone is divided into during layout, so that it can bend with the body",
        least=1,
        most=20,
        soft_most=6,
        note="This is the number for a bone of average length",
        panel="settings",
    )
    thickness: float = setting(
        0.0,
        "Thickness",
        "Thickness for surfaces that enclose nothing, which also closes gaps between parts; 0 for none",
        least=0.0,
        soft_most=1.0,
        subtype="DISTANCE",
        note="In the units of the body",
        panel="settings",
    )
    slack: float | None = setting(
        None,
        "Slack",
        "How much more distributions may spread out than the pinned joints, in nats; below 1 the solve may not "
        "converge",
        help="How much more the distributions may spread out on the surface than the pinned joints, in nats of "
        "entropy; below 1 the solve may not converge",
        least=0.0,
        most=20.0,
        soft_most=5.0,
        switch=Companion(
            "limit_spread",
            "Limit Spread",
            "Keep what moves along the surface from spreading out more than the pinned joints do, which follows thin "
            "limbs more closely but lies less deep",
            start=1.0,
        ),
        automatic="no limit, which keeps joints deepest",
        panel="settings",
    )
    tolerance: float = setting(
        3e-2,
        "Tolerance",
        "Marginal error at which distributions are done",
        least=0.0,
        most=1.0,
        open_ends=True,
        prop=None,
        option=None,
    )
    max_iterations: int = setting(
        200, "Iterations", "Largest number of sweeps over the skeleton", least=1, prop=None, option=None
    )
