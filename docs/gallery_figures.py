# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The figures of Solomon et al. 2015, our versions of them, and the scripts that draw these."""

from __future__ import annotations

from dataclasses import dataclass

SHELL, PYTHON = "sh", "python"
_MORPH = "python3 run.py python -m convwass_addon morph"
_THREE = "assets/shapes/cow.ply assets/shapes/bird.ply assets/shapes/double_torus.ply"


@dataclass(frozen=True)
class Figure:
    """A figure of the paper and ours.

    Attributes
    ----------
    number : int
        Number in the paper.
    title : str
        Short title.
    script : tuple of str
        The script that draws the picture: a file of docs/, and its arguments.
    picture : str
        In docs/pictures.
    paper, ours : str
        Descriptions of both versions.
    line : str
        The command or code that computes it.
    language : str
        Language of the line, `SHELL` or `PYTHON`.
    """

    number: int
    title: str
    script: tuple[str, ...]
    picture: str
    paper: str
    ours: str
    line: str
    language: str = PYTHON


FIGURES = (
    Figure(
        1,
        "Shape interpolation",
        ("solids.py", "path"),
        "solids_path.jpg",
        "A cow becomes a duck becomes a torus, on a grid of 100 cells along each side.",
        "A cow becomes a bird becomes a double torus, with the same number of cells. The shapes themselves are the "
        "original meshes, and every frame encloses the interpolated volume.",
        f"{_MORPH} {_THREE} --motion transport --frames 4 --resolution 100 --render --out row.blend",
        SHELL,
    ),
    Figure(
        2,
        "Transport plans",
        ("figures.py", "transport_plans"),
        "transport_plans.png",
        "Plans between two densities on a line, for four values of γ.",
        "The same: as γ grows, the plan spreads from the graph of the optimal map toward the product of the two.",
        "found = distance(mu_0, mu_1, grid)\nplan = found.v[:, None] * grid.apply(np.eye(len(mu_0))) * found.w",
    ),
    Figure(
        3,
        "Distances between points",
        ("figures.py", "distances"),
        "distances.png",
        "Distances from a vertex by one application of the heat kernel, with γ = 10⁻⁵.",
        "At the left with a correction for the kernel near its source; the other two show the paper's formula with a "
        "wide and a narrow kernel.",
        "lengths = point_distances(17, surface)",
    ),
    Figure(
        4,
        "Barycenters under an entropy bound",
        ("figures.py", "barycenters"),
        "barycenters.png",
        "Barycenters of two distributions on a surface, increasingly sharp.",
        "The same on a horse; H is the larger entropy of the two.",
        "middle = barycenter([mu_0, mu_1], [0.5, 0.5], surface, entropy_limit=bound)",
    ),
    Figure(
        5,
        "Propagation over graphs",
        ("figures.py", "propagations"),
        "propagations.png",
        "Graphs of barycenters and of displacement interpolation; vertices with given distributions are solid.",
        "A star with four given distributions and a line with two; shaded vertices are given, white ones are computed.",
        'found = propagate([(0, 1), (1, 2), (2, 3)], 1.0, {0: mu_0, 3: mu_1}, surface, entropy_limit="max")',
    ),
    Figure(
        6,
        "Displacement interpolation",
        ("figures.py", "interpolations"),
        "interpolations.png",
        "Two peaks travel to two others, without and with a bound on the entropy.",
        "The same on a double torus: without a bound above, with one below.",
        "found = bisect(mu_0, mu_1, surface, levels=2)",
    ),
    Figure(
        7,
        "Between three shapes",
        ("solids.py", "triangle"),
        "solids_triangle.jpg",
        "All barycenters of Fig. 1's cow, duck and torus, in a triangle.",
        "All barycenters of a cow, a bird and a double torus. *Make Blend Pad* turns such a sheet into one shape that "
        "follows a handle.",
        f"{_MORPH} {_THREE} --motion transport --layout triangle --steps 6 --render --out triangle.blend",
        SHELL,
    ),
    Figure(
        8,
        "Reflectance",
        ("reflectance.py",),
        "reflectance.png",
        "Four materials at the corners: mixed linearly, by barycenters, and by barycenters of bounded entropy.",
        "At the left mixed linearly, in the middle by transport, at the right with bounded entropy: highlights move "
        "and turn instead of doubling.",
        "python3 run.py python -m convwass_addon reflect ashikhmin:20,400 ashikhmin:400,20 principled:0.2 blinn:60 "
        "--out between.npz",
        SHELL,
    ),
    Figure(
        9,
        "Skeletons",
        ("skeletons.py",),
        "skeletons.jpg",
        "Skeletons laid out in bodies: green joints are given, blue ones are computed.",
        "In a horse, a bird, an octopus and a double torus, whose skeleton has two loops; then the octopus bound "
        "to its skeleton and posed.",
        "skeleton = drained(fit_steps(mesh, graph, SkeletonSettings()))\njoints = skeleton.positions",
    ),
    Figure(
        10,
        "Soft maps",
        ("two_maps.py",),
        "two_maps.png",
        "Points of one body, and their distributions on another: a map and its mirror image, distinguished by a few "
        "fixed points, which are black.",
        "A cow's points on a horse. In the middle, left corresponds to left; at the right the same fixed points are "
        "paired crosswise. [soft_maps.jpg](pictures/soft_maps.jpg) shows uses of such maps.",
        "found = drained(soft_map_steps(cow, horse, pairs))\nrow = distribution_of(found, 17)",
    ),
    Figure(
        11,
        "Colors",
        ("recolor.py",),
        "recolor.jpg",
        "Two images take each other's colors in steps; below, the histogram of the chrominance between the two.",
        "The same with two photographs of scikit-image.",
        "python3 run.py python -m convwass_addon recolor coffee.png --palette rocket.png --steps 5 --out between/",
        SHELL,
    ),
    Figure(
        12,
        "Flat shapes",
        ("flat.py",),
        "flat_sheet.png",
        "Four shapes at the corners, mixed linearly at the left, by barycenters at the right.",
        "The same with two letters, a heart and a shape in two parts, as outlines instead of pixels, with moving "
        "colors.",
        f"{_MORPH} text:A text:B text:C text:D --layout grid --steps 5 --out letters.blend",
        SHELL,
    ),
    Figure(
        13,
        "Gray images",
        ("flat_rows.py",),
        "flat_grays.png",
        "A mahjong tile becomes another: linearly, by displacement, and with filters applied to the latter.",
        "A six that becomes a nine: linearly, by displacement, with the grays of the two, and with a threshold.",
        f"{_MORPH} six.png nine.png --flat-output picture --grays density --out tiles.blend",
        SHELL,
    ),
    Figure(
        14,
        "Between four shapes",
        ("solids.py", "grid"),
        "solids_grid.jpg",
        "All barycenters of four solids, one of them in two parts, on a grid of 60 cells along each side.",
        "All barycenters of a horse, a double torus, two dolphins and a bird, with 100 cells.",
        f"{_MORPH} assets/shapes/horse.ply assets/shapes/double_torus.ply assets/shapes/dolphins.ply "
        "assets/shapes/bird.ply --motion transport --layout grid --steps 5 --render --out sheet.blend",
        SHELL,
    ),
)
