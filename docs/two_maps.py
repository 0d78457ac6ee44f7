# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw a map and its mirror image, as Fig. 10 of Solomon et al. 2015: ``python3 run.py python docs/two_maps.py``.

Writes docs/pictures/two_maps.png. At the left a cow with points in colors and fixed points in black; then the horse
with their distributions on it, the fixed points paired left with left, and left with right.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image
from renderer import Shape, posed, read_mesh, rendered
from scipy.spatial.transform import Rotation

from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.applications.soft_maps.soft_map_settings import SoftMapSettings
from convwass_addon.applications.soft_maps.surface_maps import SurfaceMap, distribution_of
from convwass_addon.geometry.meshes.mesh import TriangleMesh
from convwass_addon.progress import drained

PROJECT = Path(__file__).resolve().parents[1]
PICTURE = PROJECT / "docs" / "pictures" / "two_maps.png"
# The view of both bodies, slightly from above and from the front.
_TURN, _TILT = -42.0, -66.0
_WIDTH, _GAP = 500, 36
_CLAY = np.array([0.93, 0.92, 0.90])
_BLACK = np.array([0.05, 0.05, 0.06])
# Radii of the points in the picture's unit, which is the longer side of a body.
_POINT, _FIXED = 0.075, 0.022
_LEAST = 0.15
# The blur of the paper's maps, which shows their uncertainty.
_SETTINGS = SoftMapSettings(sharpness=0.0)

# Ears, knees, hocks, muzzle and tip of the tail of the cow and of the horse, in the units of their files.
_FIXED_PLACES = (
    ((0.58, 0.29, 1.24), (0.70, 0.07, 1.82)),
    ((0.58, -0.29, 1.24), (0.70, -0.07, 1.82)),
    ((0.40, 0.14, 0.39), (0.49, 0.12, 0.42)),
    ((0.40, -0.14, 0.39), (0.79, -0.12, 0.65)),
    ((-0.77, 0.14, 0.44), (-0.54, 0.13, 0.45)),
    ((-0.77, -0.14, 0.44), (-0.67, -0.13, 0.48)),
    ((0.99, 0.00, 0.97), (0.98, 0.00, 1.25)),
    ((-0.97, 0.00, 0.37), (-1.00, 0.00, 0.60)),
)
_CROSSED = (1, 0, 3, 2, 5, 4, 6, 7)
# Points of the cow: hooves, flank and back; and their colors.
_FOLLOWED = (
    ((0.41, 0.14, 0.04), (0.86, 0.12, 0.16)),
    ((0.41, -0.14, 0.04), (0.12, 0.35, 0.85)),
    ((-0.55, 0.14, 0.04), (0.95, 0.62, 0.10)),
    ((-0.55, -0.14, 0.04), (0.05, 0.62, 0.45)),
    ((0.10, -0.30, 0.80), (0.55, 0.20, 0.70)),
    ((0.00, 0.00, 1.18), (0.55, 0.75, 0.12)),
)


def main() -> None:
    """Solve both maps and draw the bodies in a row."""
    cow, horse = (read_mesh(PROJECT / "assets" / "shapes" / f"{name}.ply") for name in ("cow", "horse"))
    pairs = np.array([[_nearest(cow, here), _nearest(horse, there)] for here, there in _FIXED_PLACES])
    followed = [_nearest(cow, place) for place, _ in _FOLLOWED]
    shape = _posed(cow)
    images = [_image(shape, [_disc(shape, vertex, _POINT) for vertex in followed], pairs[:, 0])]
    for order in (np.arange(len(pairs)), np.array(_CROSSED)):
        found = _solved(cow, horse, np.stack([pairs[:, 0], pairs[order, 1]], axis=1))
        rows = [_shown(distribution_of(found, vertex)) for vertex in followed]
        images.append(_image(_posed(horse), rows, pairs[:, 1]))
    height = max(len(image) for image in images)
    canvas = np.ones((height, len(images) * (_WIDTH + _GAP) - _GAP, 3))
    for column, image in enumerate(images):
        left = column * (_WIDTH + _GAP)
        canvas[height - len(image) :, left : left + _WIDTH] = image
    Image.fromarray(np.rint(255 * canvas).astype(np.uint8) | 1).save(PICTURE, optimize=True)


def _solved(source: TriangleMesh, target: TriangleMesh, pairs: NDArray[np.int64]) -> SurfaceMap:
    found = drained(soft_map_steps(MapSide(source, "cow"), MapSide(target, "horse"), pairs, _SETTINGS))
    print([str(notice) for notice in found.notices])
    return found


def _shown(density: NDArray[np.float64]) -> NDArray[np.float64]:
    """Emphasize small values relative to the largest, and drop those that would only tint the body."""
    return np.clip((np.sqrt(density / density.max()) - _LEAST) / (1.0 - _LEAST), 0.0, 1.0)


def _nearest(mesh: TriangleMesh, place: tuple[float, float, float]) -> int:
    return int(np.linalg.norm(mesh.vertices - place, axis=1).argmin())


def _posed(mesh: TriangleMesh) -> Shape:
    turn = Rotation.from_euler("zx", [_TURN, _TILT], degrees=True).as_matrix()
    return posed(mesh.vertices, mesh.faces, turn)


def _disc(shape: Shape, vertex: int, radius: float) -> NDArray[np.float64]:
    """Return 1 within a radius of a vertex, and 0 beyond, with an edge as soft as the triangles."""
    distances = np.linalg.norm(shape.vertices - shape.vertices[vertex], axis=1)
    return np.clip(1.5 - distances / radius, 0.0, 1.0)


def _image(shape: Shape, shares: list[NDArray[np.float64]], fixed: NDArray[np.int64]) -> NDArray[np.float64]:
    """Draw shares of the colors, each (n,), and the fixed points in black."""
    colors = np.tile(_CLAY, (len(shape.vertices), 1))
    for share, (_, color) in zip(shares, _FOLLOWED, strict=True):
        colors += share[:, None] * (np.array(color) - colors)
    for vertex in fixed:
        colors += _disc(shape, vertex, _FIXED)[:, None] * (_BLACK - colors)
    channels = [
        rendered(shape, channel, lambda values, _: np.repeat(values[:, None], 3, axis=1), _WIDTH)
        for channel in np.clip(colors, 0.0, 1.0).T
    ]
    return np.stack([channel[..., index] for index, channel in enumerate(channels)], axis=-1)


if __name__ == "__main__":
    main()
