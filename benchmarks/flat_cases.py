# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Flat morphs to measure, each in its own process."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.flat.flat_morph import flat_morph
from convwass_addon.applications.flat.flat_settings import FlatSettings
from convwass_addon.applications.flat.flat_shapes import FlatShape
from convwass_addon.applications.morphs.layouts import path_blends
from convwass_addon.geometry.plane.fitting import fitted_beziers

from .clock import Clock
from .processes import peak_megabytes, run_case

_LETTER = ((0, 0), (0.9, 3), (1.5, 3), (2.4, 0), (1.8, 0), (1.6, 0.7), (0.8, 0.7), (0.6, 0))
_HOLE = ((0.95, 1.2), (1.45, 1.2), (1.2, 2.2))


def _ellipse(x: float, y: float, width: float, height: float) -> NDArray[np.float64]:
    angles = np.linspace(0.0, 2 * np.pi, 200, endpoint=False)
    return np.stack([x + width * np.cos(angles), y + height * np.sin(angles)], axis=1)


def _heart() -> NDArray[np.float64]:
    t = np.linspace(0.0, 2 * np.pi, 300, endpoint=False)
    y = 13 * np.cos(t) - 5 * np.cos(2 * t) - 2 * np.cos(3 * t) - np.cos(4 * t)
    return np.stack([16 * np.sin(t) ** 3, y], axis=1) / 11.0


def _star() -> NDArray[np.float64]:
    angles = np.pi / 2 + np.arange(10) * np.pi / 5
    radii = np.where(np.arange(10) % 2, 0.7, 1.7)
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def _shape(*rings: object) -> FlatShape:
    return FlatShape(tuple(np.array(ring, dtype=np.float64) for ring in rings), "even-odd")


PAIRS = {
    "A to heart": (_shape(_LETTER, _HOLE), _shape(_heart())),
    "ring to star": (_shape(_ellipse(0, 0, 1.4, 1.4), _ellipse(0, 0, 0.7, 0.7)), _shape(_star())),
    "two to three": (
        _shape(_ellipse(0, 0, 0.9, 1.4), _ellipse(2.4, 0, 0.9, 1.4)),
        _shape(_ellipse(0, 0, 0.8, 0.8), _ellipse(1.8, 1, 0.8, 0.8), _ellipse(3.6, 0, 0.8, 0.8)),
    ),
}
"""Two shapes in scene units, by name."""


def frames(name: str, cells: int, count: int) -> dict[str, object]:
    """Make all frames from one shape to another, and fit curves to them."""
    settings = FlatSettings(resolution=cells, motion="transport")
    clock = Clock()
    # One more step than frames: the two ends are the shapes themselves.
    steps = flat_morph(PAIRS[name], name.split(" to "), path_blends(2, count + 1), settings, workers=2)
    made = [step.payload for step in steps if step.payload is not None and step.payload.outline is not None]
    used = clock.read()
    clock = Clock()
    curves = [fitted_beziers(frame.outline, settings.fit_error * frame.record["cell"]) for frame in made]
    return {
        **used,
        "fit": clock.read()["cpu"],
        "frames": len(made),
        "points": float(np.mean([len(frame.outline.points) for frame in made])),
        "fitted": float(np.mean([sum(len(ring.points) for ring in rings) for rings in curves])),
        "sigma": max(frame.record["sigma"] for frame in made),
        "peak": peak_megabytes(),
    }


if __name__ == "__main__":
    run_case(frames)
