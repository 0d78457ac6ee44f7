# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Barycenters and distances of distributions in plain arrays, without Blender.

python3 run.py python docs/scripts/barycenter_arrays.py [--cells 64] [--out blends.npz]

Two round peaks on a plane: their distance, and positions and widths of blends. A fade would show both peaks,
each at half of its height; transport shows a single one that moves.
"""

from __future__ import annotations

import argparse

import numpy as np

from convwass_addon.transport import Grid, barycenter, distance


def heap(domain: Grid, center: tuple[float, float], width: float) -> np.ndarray:
    """Return a round peak of mass 1 on a square grid; center and width are fractions of its side."""
    side = domain.shape[0]
    away = np.linalg.norm(domain.positions / side - center, axis=-1)
    density = np.exp(-0.5 * (away / width) ** 2)
    return density / (density * domain.weights).sum()


def moments(density: np.ndarray, domain: Grid) -> tuple[np.ndarray, float]:
    """Return the mean position and the standard deviation along an axis, as fractions of the side."""
    masses = density * domain.weights
    middle = np.tensordot(masses, domain.positions, axes=density.ndim)
    spread = (masses[..., None] * (domain.positions - middle) ** 2).sum() / density.ndim
    return middle / domain.shape[0], float(np.sqrt(spread)) / domain.shape[0]


def main() -> None:
    """Print a table of the results, and save the densities if requested."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cells", type=int, default=64, help="of the grid, along a side")
    parser.add_argument("--out", help="an .npz file for the densities")
    options = parser.parse_args()

    domain = Grid((options.cells, options.cells), sigma=1.0)
    first, second = heap(domain, (0.3, 0.3), 0.05), heap(domain, (0.7, 0.6), 0.08)

    found = distance(first, second, domain)
    print(f"distance: {found.length / options.cells:.4f} of the side")

    blends = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        blend = barycenter([first, second], [1.0 - share, share], domain, sharpness=1.0, tolerance=1e-4)
        (x, y), width = moments(blend.density, domain)
        print(f"{share:.2f}: middle {x:.4f} {y:.4f}, width {width:.4f}, converged {blend.converged}")
        blends.append(blend.density)
    if options.out:
        np.savez_compressed(options.out, blends=np.stack(blends))


if __name__ == "__main__":
    main()
