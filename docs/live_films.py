# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A live morph of three shapes while its handle is led around the pad, for docs/moving.py."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from convwass_addon.applications.live.live_blends import LiveBlends
from convwass_addon.applications.live.live_settings import LiveSettings
from convwass_addon.applications.live.live_shapes import LiveShapes
from convwass_addon.applications.morphs.morph_inputs import MorphInputs
from convwass_addon.applications.morphs.morph_settings import MorphSettings
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import Control, drained

MOMENTS = 60
"""Number of pictures while the handle goes once around the pad."""

_CELLS = 80
# Weight of the third shape while the handle is near the edge between the other two, and the fraction of the time
# that the handle rests at corners.
_INSIDE, _REST = 0.06, 0.35
# Pixels of the pad, and its colors.
_SIDE, _MARGIN = 110, 26
_LINE, _INK, _HANDLE = (170, 170, 176), (52, 52, 56), (226, 106, 30)


@dataclass(frozen=True)
class Moment:
    """A shown blend.

    Attributes
    ----------
    mesh : TriangleMesh
        In scene units, on the ground.
    weights : (3,)
        Of the shapes.
    """

    mesh: TriangleMesh
    weights: NDArray[np.float64]


def live_frames(meshes: Sequence[TriangleMesh], names: Sequence[str]) -> list[Moment]:
    """Return what a live morph of three shapes shows on the way around its pad, once its lattice is filled."""
    shapes = LiveShapes(MorphInputs.of(meshes, names))
    # A clock that is far ahead: everything has been faded in.
    times = iter(range(0, 10**9, 10))
    live = LiveBlends(shapes, MorphSettings(), LiveSettings(live_resolution=_CELLS), clock=lambda: next(times))
    while live.has_work:
        drained(live.work(Control()))
    live.settle()
    moments = []
    for weights in way_around():
        live.point(weights)
        moments.append(Moment(_on_the_ground(live.shown().mesh), weights))
    return moments


def _on_the_ground(mesh: TriangleMesh) -> TriangleMesh:
    """Move a mesh up or down until its lowest point has the height 0."""
    return TriangleMesh(mesh.vertices - (0.0, 0.0, mesh.vertices[:, 2].min()), mesh.faces)


def way_around() -> NDArray[np.float64]:
    """Return weights along the edges of the pad, (n, 3), slower at the corners."""
    corners = np.full((3, 3), _INSIDE) + (1.0 - 3.0 * _INSIDE) * np.eye(3)
    turns = np.arange(MOMENTS) * 3.0 / MOMENTS
    leg, part = turns.astype(int), turns % 1.0
    eased = np.clip((part - _REST / 2.0) / (1.0 - _REST), 0.0, 1.0)
    eased = (eased**2 * (3.0 - 2.0 * eased))[:, None]
    return (1.0 - eased) * corners[leg] + eased * corners[(leg + 1) % 3]


def with_pad(picture: Image.Image, weights: NDArray[np.float64], names: Sequence[str]) -> Image.Image:
    """Draw the pad and its handle into the lower left corner of a picture."""
    low = picture.height - _MARGIN
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, np.sqrt(0.75)]]) * (_SIDE, -_SIDE) + (1.5 * _MARGIN, low)
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(14)
    draw.polygon([tuple(corner) for corner in corners], outline=_LINE, width=2)
    for corner, name, above in zip(corners, names, (False, False, True), strict=True):
        draw.text((corner[0], corner[1] + (-11 if above else 12)), name, _INK, font, anchor="mm")
    x, y = weights @ corners
    draw.ellipse((x - 7, y - 7, x + 7, y + 7), fill=_HANDLE)
    return picture
