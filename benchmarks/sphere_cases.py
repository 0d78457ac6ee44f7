# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Transport on the sphere, one case per process: ``python -m benchmarks.sphere_cases CASE OPTIONS``.

A case prints one line of JSON.
"""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from convwass_addon.applications.reflectance.ggx_fit import fit_ggx
from convwass_addon.applications.reflectance.lobe_interpolation import LobeBlend
from convwass_addon.applications.reflectance.materials import AshikhminShirley, BlinnPhong, Ggx, Material
from convwass_addon.applications.reflectance.reflectance_settings import ReflectanceSettings
from convwass_addon.applications.skies.lamps import SUN_RADIUS
from convwass_addon.applications.skies.sky_frames import Skies
from convwass_addon.applications.skies.sky_images import LUMINANCE, add_disc, great_circle, light_of
from convwass_addon.progress import drained
from convwass_addon.transport import Sphere, barycenter
from convwass_addon.transport.sphere import directions, solid_angles

from .processes import run_case

_PAIRS: dict[str, tuple[Material, Material]] = {
    "round": (Ggx(0.1, 0.1), Ggx(0.5, 0.5)),
    "models": (BlinnPhong(400), AshikhminShirley(10, 1000)),
    "crossed": (Ggx(0.4, 0.08), Ggx(0.08, 0.4)),
}
_TIMES = (0.1, 0.25, 0.5, 0.75, 0.9)


def kernel(rows: int, kind: str) -> dict[str, object]:
    """Apply a kernel to two columns, and use it to compute midpoints of blobs."""
    # A narrower kernel would not reach as far as these paths.
    domain = Sphere(rows, 1.5 * rows / 64, kernel=kind)
    start = time.process_time()
    domain.apply(np.ones(domain.shape))
    built = time.process_time() - start
    values = np.random.default_rng(0).random((2, *domain.shape))
    start = time.process_time()
    for _ in range(5):
        domain.apply(values)
    applied = (time.process_time() - start) / 5
    worst, seconds = 0.0, 0.0
    pairs = (((90, 40), (90, 140)), ((40, 20), (110, 110)), ((15, 20), (60, 170)), ((45, 20), (40, 200)))
    for ends in pairs:
        first, second = (_unit(90 - polar, azimuth) for polar, azimuth in ends)
        cosines = [domain.positions @ end for end in (first, second)]
        width = np.pi * 3 / 64
        mus = np.stack([np.exp(-(np.arccos(np.clip(c, -1, 1)) ** 2) / (2 * width**2)) for c in cosines])
        start = time.process_time()
        found = barycenter(mus, [0.5, 0.5], domain, tolerance=1e-3)
        seconds += (time.process_time() - start) / len(pairs)
        middle = ((found.density * domain.weights)[..., None] * domain.positions).sum(axis=(0, 1))
        off = np.linalg.norm(middle / np.linalg.norm(middle) - great_circle(first, second, 0.5))
        worst = max(worst, float(off) / domain.radians)
    return {"built": built, "applied": applied, "seconds": seconds, "off": worst}


def lobes(pair: str, entropy: str) -> dict[str, object]:
    """Interpolate halfway between two materials, for all incoming directions."""
    turns = {"turns": 4, "incoming": 4} if pair != "round" else {}
    start = time.process_time()
    blend = LobeBlend.of(_PAIRS[pair], ReflectanceSettings(entropy_limit=entropy, **turns))
    prepared = time.process_time() - start
    start = time.process_time()
    found = drained(blend.steps([0.5, 0.5]))
    seconds = time.process_time() - start
    fit = fit_ggx(found.table)
    own = float(np.mean(found.record["entropies"]))
    return {
        "directions": len(blend),
        "prepared": prepared,
        "seconds": seconds,
        "error": found.record["marginal_error"],
        "entropy": own,
        "fit": fit.record(),
    }


def skies(rows: int) -> dict[str, object]:
    """Interpolate two analytic skies with suns 93 degrees apart."""
    low, high = _unit(12, 70), _unit(50, 165)
    ends = _sky(rows, low, (3, 1.5, 0.5), (0.5, 0.3, 0.15)), _sky(rows, high, (1.5, 1.4, 1.2), (2, 1.9, 1.7))
    start = time.process_time()
    found = Skies(*ends)
    found.frame(0.05)
    prepared = time.process_time() - start
    vectors, areas = directions(rows, 2 * rows), solid_angles(rows, 2 * rows)
    seconds = off = energy = 0.0
    for moment in _TIMES:
        start = time.process_time()
        image = found.frame(moment).image.astype(float)
        seconds += (time.process_time() - start) / len(_TIMES)
        luminance = image @ LUMINANCE
        mass = areas * np.where(luminance > 0.1 * luminance.max(), luminance, 0)
        place = (mass[..., None] * vectors).sum(axis=(0, 1))
        distance = np.linalg.norm(place / np.linalg.norm(place) - great_circle(low, high, moment))
        off = max(off, float(distance) * rows / np.pi)
        want = (1 - moment) * light_of(ends[0]) + moment * light_of(ends[1])
        energy = max(energy, float(np.abs(light_of(image) / want - 1).max()))
    return {"prepared": prepared, "seconds": seconds, "off": off, "energy": energy}


def _unit(elevation: float, azimuth: float) -> NDArray[np.float64]:
    up, turn = np.radians(elevation), np.radians(azimuth)
    return np.array([np.cos(up) * np.cos(turn), np.cos(up) * np.sin(turn), np.sin(up)])


def _sky(rows: int, sun: NDArray[np.float64], haze: tuple, flux: tuple) -> NDArray[np.float64]:
    vectors = directions(rows, 2 * rows)
    above = vectors[..., 2:] > 0
    air = np.array([0.2, 0.35, 0.8]) * (0.3 + 0.7 * np.exp(-3 * np.maximum(vectors[..., 2:], 0)))
    angle = np.arccos(np.clip(vectors @ sun, -1, 1))[..., None]
    image = np.where(above, air + np.exp(-angle / np.radians(15)) * np.array(haze), [0.08, 0.07, 0.05])
    add_disc(image, sun, np.array(flux, float), SUN_RADIUS)
    return image


if __name__ == "__main__":
    run_case(kernel, lobes, skies)
