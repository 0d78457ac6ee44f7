# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""One pair of pictures, recolored by several methods; and one of film frame size."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import ot
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from convwass_addon.applications.palettes.lab_colors import (
    lab_of_linear,
    linear_of_lab,
    linear_of_srgb,
    srgb_of_linear,
)
from convwass_addon.applications.palettes.lookup_table import lookup_table
from convwass_addon.applications.palettes.palette_settings import RecolorSettings
from convwass_addon.applications.palettes.pixel_blocks import recolored_blocks
from convwass_addon.applications.palettes.pixels import PixelFormat, image_palette
from convwass_addon.applications.palettes.recoloring import Recoloring, recoloring
from convwass_addon.progress import drained

from .clock import Clock
from .processes import run_case

# Number of directions along which palettes are compared, and smallest gradient whose growth counts.
_DIRECTIONS, _EDGE = 64, 0.3
_SLICES, _SAMPLES = 30, 1000

Way = Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]]


@dataclass(frozen=True)
class _Pair:
    """Two pictures as sRGB from 0 to 1, (height, width, 3)."""

    source: NDArray[np.float64]
    target: NDArray[np.float64]


def photograph(name: str) -> NDArray[np.float64]:
    """Return a photograph from scikit-image, or if missing a synthetic picture for the same name."""
    try:
        from skimage import data

        return getattr(data, name)()[..., :3] / 255.0
    except (ImportError, AttributeError, OSError, ValueError):
        return synthetic(sum(map(ord, name)))


def synthetic(seed: int, height: int = 300, width: int = 450) -> NDArray[np.float64]:
    """Return smooth blobs of a few colors, with grain and a uniform corner."""
    rng = np.random.default_rng(seed)
    fields = [gaussian_filter(rng.standard_normal((height, width)), 25.0) for _ in range(4)]
    colors = rng.uniform(0.1, 0.9, (4, 3))
    picture = colors[np.argmax(fields, axis=0)]
    picture = gaussian_filter(picture, (2, 2, 0)) + 0.01 * rng.standard_normal(picture.shape)
    picture[: height // 5, : width // 5] = colors[0]
    return np.clip(np.round(np.clip(picture, 0, 1) * 255) / 255, 0, 1)


def lab(picture: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the colors of a picture in Lab, (3, ...)."""
    return lab_of_linear(linear_of_srgb(np.moveaxis(picture, -1, 0)))


def shown(colors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return Lab colors as a screen shows them: 8-bit sRGB from 0 to 1, (..., 3)."""
    return np.round(np.clip(np.moveaxis(srgb_of_linear(linear_of_lab(colors)), 0, -1), 0, 1) * 255) / 255


def distance_left(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Return the sliced Wasserstein distance W2 between the colors of two pictures in Lab, (3, ...)."""
    axes = np.random.default_rng(0).standard_normal((_DIRECTIONS, 3))
    axes /= np.linalg.norm(axes, axis=1, keepdims=True)
    shares = (np.arange(2048) + 0.5) / 2048
    along = [np.array([_quantiles(line, shares) for line in axes @ own.reshape(3, -1)]) for own in (first, second)]
    return float(np.sqrt(((along[0] - along[1]) ** 2).mean()))


def _quantiles(values: NDArray[np.float64], shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute quantiles like np.quantile, but many times faster for many quantiles."""
    return np.interp(shares * (len(values) - 1), np.arange(len(values)), np.sort(values))


def gradient_growth(before: NDArray[np.float64], after: NDArray[np.float64]) -> float:
    """Return how much differences between neighbors grow: the 95th percentile of the ratio of gradients in Lab."""
    found = []
    for axis in (1, 2):
        steps = [np.linalg.norm(np.diff(own, axis=axis), axis=0).ravel() for own in (before, after)]
        counts = steps[0] > _EDGE
        found.append(steps[1][counts] / steps[0][counts])
    return float(np.percentile(np.concatenate(found), 95))


def ours(smoothing: float, edge_radius: int = 0) -> Way:
    """Return our method."""

    def way(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
        settings = RecolorSettings(smoothing=smoothing, edge_radius=edge_radius)
        pixels = [opaque(own) for own in (source, target)]
        change = _solved(*pixels, settings)
        out = np.empty_like(pixels[0])
        drained(recolored_blocks(pixels[0], PixelFormat(), change, None, out, workers=1))
        return lab(np.round(out[..., :3].astype(np.float64) * 255) / 255)

    return way


def _solved(source: NDArray[np.float32], target: NDArray[np.float32], settings: RecolorSettings) -> Recoloring:
    return recoloring(image_palette(source, PixelFormat()), [image_palette(target, PixelFormat())], None, settings)


def opaque(picture: NDArray[np.float64]) -> NDArray[np.float32]:
    """Return a picture as pixels with alpha 1."""
    pixels = np.ones((*picture.shape[:2], 4), dtype=np.float32)
    pixels[..., :3] = picture
    return pixels


def linear(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the map between Gaussians (Pitie and Kokaram 2007, linear Monge-Kantorovich), in Lab."""
    first, second = (lab(own).reshape(3, -1) for own in (source, target))
    root, back = _roots(np.cov(first))
    middle, _ = _roots(root @ np.cov(second) @ root)
    moved = back @ middle @ back @ (first - first.mean(axis=1, keepdims=True)) + second.mean(axis=1, keepdims=True)
    return lab(shown(moved.reshape(3, *source.shape[:2])))


def _roots(matrix: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the square root of a symmetric matrix, and its inverse."""
    values, axes = np.linalg.eigh(matrix)
    values = np.sqrt(np.maximum(values, 1e-9))
    return (axes * values) @ axes.T, (axes / values) @ axes.T


def sliced(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Match quantiles along rotated axes repeatedly (Pitie, Kokaram and Dahyot 2007), in Lab."""
    moved, wanted = (lab(own).reshape(3, -1) for own in (source, target))
    shares = (np.arange(4096) + 0.5) / 4096
    for turn in Rotation.random(_SLICES, random_state=0).as_matrix():
        along, others = turn @ moved, turn @ wanted
        for own, other in zip(along, others, strict=True):
            have, want = _quantiles(own, shares), _quantiles(other, shares)
            knots, ties = np.unique(have, return_inverse=True)
            images = np.bincount(ties, want) / np.bincount(ties)
            own[...] = np.interp(own, knots, images)
        moved = turn.T @ along
    return lab(shown(moved.reshape(3, *source.shape[:2])))


def histograms(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
    """Match the histograms of red, green and blue, as scikit-image does."""
    from skimage.exposure import match_histograms

    return lab(np.round(np.clip(match_histograms(source, target, channel_axis=-1), 0, 1) * 255) / 255)


def sampled(kind: str) -> Way:
    """Return transport between samples by POT's domain adaptation, exact or by Sinkhorn's algorithm."""

    def way(source: NDArray[np.float64], target: NDArray[np.float64]) -> NDArray[np.float64]:
        rng = np.random.default_rng(0)
        rows = [lab(own).reshape(3, -1).T / 100.0 for own in (source, target)]
        chosen = [own[rng.choice(len(own), _SAMPLES, replace=False)] for own in rows]
        plan = ot.da.EMDTransport() if kind == "exact" else ot.da.SinkhornTransport(reg_e=0.05)
        plan.fit(Xs=chosen[0], Xt=chosen[1])
        moved = plan.transform(Xs=rows[0]).T * 100.0
        return lab(shown(moved.reshape(3, *source.shape[:2])))

    return way


WAYS: dict[str, Way] = {
    "ours, smoothing 0": ours(0.0),
    "ours, smoothing 1": ours(1.0),
    "ours, smoothing 2": ours(2.0),
    "ours, 1, edge radius 8": ours(1.0, 8),
    "linear": linear,
    "sliced": sliced,
    "histograms": histograms,
    "samples, exact": sampled("exact"),
    "samples, Sinkhorn": sampled("sinkhorn"),
}
"""The methods to compare."""


def pair(source: str, target: str) -> dict[str, object]:
    """Recolor one photograph with the palette of another by all methods."""
    pictures = _Pair(photograph(source), photograph(target))
    before, wanted = lab(pictures.source), lab(pictures.target)
    found: dict[str, object] = {"before": distance_left(before, wanted)}
    for name, way in WAYS.items():
        clock = Clock()
        result = way(pictures.source, pictures.target)
        found[name] = {
            "seconds": clock.read()["cpu"],
            "left": distance_left(result, wanted),
            "growth": gradient_growth(before, result),
        }
    return found


def table_error(source: str, target: str, size: int) -> dict[str, float]:
    """Compare a lookup table with the map that it samples, on a photograph, in levels of 255."""
    pixels = opaque(photograph(source))
    change, found = _solved(pixels, opaque(photograph(target)), RecolorSettings()), []
    for own in (change, lookup_table(change, size)):
        out = np.empty_like(pixels)
        drained(recolored_blocks(pixels, PixelFormat(), own, None, out, workers=1))
        found.append(out)
    error = np.abs(found[0] - found[1])[..., :3] * 255
    return {"mean": float(error.mean()), "most": float(np.percentile(error, 99)), "worst": float(error.max())}


if __name__ == "__main__":
    run_case(pair, table_error)
