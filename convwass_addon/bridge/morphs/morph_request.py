# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake was asked for, as it is stored with every morph, whoever asked."""

from __future__ import annotations

from dataclasses import asdict, dataclass


@dataclass(frozen=True)
class MorphRequest:
    """What a bake was asked for besides the settings of its solver, so that it can be asked for again.

    Attributes
    ----------
    layout, frames, frame_step, steps, order, reverse, alignment, scaling, start, frame_start, output, folder, \
cache_format, words, flat_output, grays
        Values of the arguments of Bake Morph, whose defaults are the same.
    weights : list of float or None
        Of a single blend, one per shape.
    at : list of float or None
        The frame numbers of a path, such as 7.35, that the blends are at where they are a sheet of such ones.
    """

    layout: str = "PATH"
    frames: int = 24
    frame_step: int = 1
    steps: int = 5
    order: str = "NAME"
    reverse: bool = False
    alignment: str = "PLACED"
    scaling: str = "PLACED"
    start: str = "SCENE"
    frame_start: int = 1
    output: str = "OBJECTS"
    folder: str = "//convwass"
    cache_format: str = "alembic"
    words: str = "MASS"
    flat_output: str = "CURVE"
    grays: str = "IMAGES"
    weights: list[float] | None = None
    at: list[float] | None = None

    def as_dict(self) -> dict[str, object]:
        """Return the request ready for JSON."""
        return asdict(self)
