# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw docs/pictures/reflectance.png, materials between four others: ``python3 run.py python docs/reflectance.py``.

Three sheets of five by five balls under one lamp, after figure 8 of Solomon et al. 2015: at the left materials are
mixed linearly, as by a Mix Shader; in the middle every lobe is a Wasserstein barycenter; at the right its entropy is
also bounded by that of the widest material. The corners are the same in all sheets: facets tilted to one side and to
the other (twill, hammered metal), and metals brushed along the parallels and the meridians of the ball. The balls are
shaded directly from the tables, so that only the interpolation differs.

It takes a quarter of an hour.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from convwass_addon.applications.reflectance.lobe_interpolation import LobeBlend, linear_lobes
from convwass_addon.applications.reflectance.lobe_table import LobeTable
from convwass_addon.applications.reflectance.materials import Color, Ggx
from convwass_addon.applications.reflectance.reflectance_settings import ReflectanceSettings
from convwass_addon.progress import drained

PICTURE = Path(__file__).resolve().parent / "pictures" / "reflectance.png"
SETTINGS = ReflectanceSettings(rows=48, incoming=9, turns=12, tolerance=2e-2)

_SIDE = 5
_BALL, _GAP, _MIDDLE = 124, 8, 32
_SAMPLES = 2
# Direction of the lamp; the eye is at +Z, and Y is up.
_LAMP = np.array([-0.25, 0.5, 0.83])
_EXPOSURE, _MATTE = 0.62, 0.035
_BACKGROUND = 0.028


@dataclass(frozen=True)
class LeaningFacets:
    """GGX facets around an axis that is tilted along the tangent, which shifts the highlight.

    Attributes
    ----------
    lobe : Ggx
        Lobe of the facets.
    lean : float
        Tilt from the normal towards the tangent, in radians.
    """

    lobe: Ggx
    lean: float
    is_isotropic = False

    def reflectance(self, incoming: NDArray[np.float64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the reflectance of the facets, (..., 3); zero for light from below them."""
        cosine, sine = np.cos(self.lean), np.sin(self.lean)
        turned = np.array([[cosine, 0.0, -sine], [0.0, 1.0, 0.0], [sine, 0.0, cosine]])
        light, seen = turned @ incoming, outgoing @ turned.T
        if light[2] <= 0:
            return np.zeros((*outgoing.shape[:-1], 3))
        return np.where(seen[..., 2:] > 0, self.lobe.reflectance(light, seen), 0.0)


_GOLD: Color = (1.0, 0.72, 0.32)
_STEEL: Color = (0.62, 0.72, 0.86)
_COPPER: Color = (0.95, 0.52, 0.38)
_JADE: Color = (0.5, 0.85, 0.66)
CORNERS = (
    LeaningFacets(Ggx(0.13, 0.13, _GOLD), np.radians(-17.0)),
    LeaningFacets(Ggx(0.13, 0.13, _STEEL), np.radians(17.0)),
    Ggx(0.5, 0.09, _COPPER),
    Ggx(0.09, 0.5, _JADE),
)


def main() -> None:
    """Draw the picture."""
    blends = [LobeBlend.of(CORNERS, SETTINGS), LobeBlend.of(CORNERS, replace(SETTINGS, entropy_limit="largest"))]
    linear = [linear_lobes(blends[0].tables, weights) for weights in _weights()]
    free, bounded = zip(*_moved(blends), strict=True)
    panels = [_sheet(tables) for tables in (linear, free, bounded)]
    between = np.full((panels[0].shape[0], _MIDDLE, 3), _BACKGROUND)
    values = np.concatenate([panels[0], between, panels[1], between, panels[2]], axis=1)
    Image.fromarray((255 * _display(values) + 0.5).astype(np.uint8)).save(PICTURE, optimize=True)


def _weights() -> Iterator[NDArray[np.float64]]:
    """Yield the weights of the corners, row by row from the top left."""
    for down in np.linspace(0.0, 1.0, _SIDE):
        for right in np.linspace(0.0, 1.0, _SIDE):
            yield np.outer([1.0 - down, down], [1.0 - right, right]).ravel()


def _moved(blends: list[LobeBlend]) -> Iterator[list[LobeTable]]:
    """Blend for all weights, each started from the previous solution."""
    before = None
    for place, weights in enumerate(_weights()):
        tables = []
        for blend in blends:
            before = drained(blend.steps(weights, before))
            tables.append(before.table)
        print(f"{place + 1} of {_SIDE**2}", [str(notice) for notice in before.notices], flush=True)
        yield tables


def _sheet(tables: Sequence[LobeTable]) -> NDArray[np.float64]:
    side = _SIDE * (_BALL + _GAP) + _GAP
    sheet = np.full((side, side, 3), _BACKGROUND)
    for place, table in enumerate(tables):
        top, left = (_GAP + step * (_BALL + _GAP) for step in divmod(place, _SIDE))
        sheet[top : top + _BALL, left : left + _BALL] = _ball(table)
    return sheet


def _ball(table: LobeTable) -> NDArray[np.float64]:
    """Shade a ball seen from +Z without perspective, (pixels, pixels, 3)."""
    fine = _BALL * _SAMPLES
    x = (np.arange(fine) + 0.5) / fine * 2.0 - 1.0
    x, y = np.meshgrid(x, -x)
    inside = x**2 + y**2 < 1.0
    x, y = x[inside], y[inside]
    normal = np.stack([x, y, np.sqrt(1.0 - x**2 - y**2)], axis=-1)
    tangent = np.cross([0.0, 1.0, 0.0], normal)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=-1, keepdims=True), 1e-12)
    frame = np.stack([tangent, np.cross(normal, tangent), normal], axis=1)
    light, eye = frame @ (_LAMP / np.linalg.norm(_LAMP)), frame @ np.array([0.0, 0.0, 1.0])
    lit = np.maximum(light[:, 2:], 0.0)
    colors = (reflectance_with_grain(table, light, eye) + _MATTE * table.albedo[0]) * lit
    picture = np.full((fine, fine, 3), _BACKGROUND)
    picture[inside] = colors + 0.012
    # Tone mapping before averaging avoids a jagged rim.
    return _linear(_display(picture).reshape(_BALL, _SAMPLES, _BALL, _SAMPLES, 3).mean(axis=(1, 3)))


def reflectance_with_grain(
    table: LobeTable, light: NDArray[np.float64], eye: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Look up a table with grain, (n, 3), between four incoming directions, each by the given half vector."""
    half = light + eye
    half /= np.maximum(np.linalg.norm(half, axis=-1, keepdims=True), 1e-12)
    angles, turns = SETTINGS.incoming, SETTINGS.turns
    theta = np.arctan2(np.hypot(light[:, 0], light[:, 1]), light[:, 2])
    row = np.minimum(theta / table.theta_in.max() * (angles - 1), angles - 1.001)
    turn = np.arctan2(light[:, 1], light[:, 0]) / (2.0 * np.pi) * turns
    total, share = np.zeros((len(light), 3)), np.zeros((len(light), 1))
    for down in (0, 1):
        for on in (0, 1):
            angle, place = np.floor(row).astype(int) + down, (np.floor(turn).astype(int) + on) % turns
            part = np.abs(1 - down - row % 1.0) * np.abs(1 - on - turn % 1.0)
            index = place * angles + np.where(place % 2 == 1, angles - 1 - angle, angle)
            known = table.incoming[index]
            out = 2.0 * (known * half).sum(axis=-1, keepdims=True) * half - known
            part = np.where(out[:, 2] > 0, part, 0.0)[:, None]
            total += part * _read(table, index, out)
            share += part
    return np.where((light[:, 2:] > 0) & (share > 0), total / np.maximum(share, 1e-9), 0.0)


def _read(table: LobeTable, index: NDArray[np.int64], outgoing: NDArray[np.float64]) -> NDArray[np.float64]:
    """Interpolate bilinearly in latitude and longitude."""
    rows = table.rows
    row = np.clip(np.arccos(np.clip(outgoing[:, 2], -1, 1)) / (np.pi / 2) * rows - 0.5, 0.0, rows - 1.001)
    column = np.arctan2(outgoing[:, 1], outgoing[:, 0]) / (2.0 * np.pi) * 4 * rows - 0.5
    total = np.zeros(len(index))
    for down in (0, 1):
        for on in (0, 1):
            part = np.abs(1 - down - row % 1.0) * np.abs(1 - on - column % 1.0)
            i, j = np.floor(row).astype(int) + down, (np.floor(column).astype(int) + on) % (4 * rows)
            total += part * table.lobes[index, i, j]
    return (total / np.maximum(outgoing[:, 2], 0.05))[:, None] * table.albedo[index]


def _display(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Convert to display values, with a shoulder that preserves the color of highlights."""
    toned = 1.0 - np.exp(-_EXPOSURE * values)
    return np.where(toned < 0.0031308, 12.92 * toned, 1.055 * toned ** (1 / 2.4) - 0.055)


def _linear(shown: NDArray[np.float64]) -> NDArray[np.float64]:
    toned = np.where(shown < 0.04045, shown / 12.92, ((shown + 0.055) / 1.055) ** 2.4)
    return -np.log(np.maximum(1.0 - toned, 1e-9)) / _EXPOSURE


if __name__ == "__main__":
    main()
