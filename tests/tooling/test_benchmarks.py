# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Benchmarks can be started and measure known shapes correctly; speed is not tested."""

from __future__ import annotations

import importlib
from pathlib import Path

import numpy as np
import pytest

import benchmarks
from benchmarks import __main__ as command_line, constants, measures
from benchmarks.rods import RADIUS, Legged
from tests.shapes import ball, joined, square, torus

MODULES = sorted(path.stem for path in Path(benchmarks.__file__).parent.glob("*.py") if path.stem != "__main__")


@pytest.mark.parametrize("name", MODULES)
def test_every_module_can_be_imported_and_its_cases_called(name):
    module = importlib.import_module(f"benchmarks.{name}")
    cases = getattr(module, "CASES", {})
    assert all(isinstance(case, str) and callable(function) for case, function in cases.items())


@pytest.mark.parametrize("name", command_line.ALL)
def test_every_benchmark_has_a_command(name, capsys):
    with pytest.raises(SystemExit) as ended:
        command_line.main([name, "--help"])
    assert ended.value.code == 0
    assert name in capsys.readouterr().out


@pytest.mark.parametrize("varied", constants.VARIED, ids=lambda varied: varied.name)
def test_varied_constants_exist(varied):
    assert hasattr(varied.module, varied.name)
    assert varied.values


def test_components_bubbles_and_handles_are_counted():
    def counted(mesh):
        found = measures.topology(mesh)
        return found.pieces, found.crumbs, found.cavities, found.euler, found.handles

    assert counted(ball()) == (1, 0, 0, 2, 0)
    assert counted(torus()) == (1, 0, 0, 0, 1)
    assert counted(joined(ball(), torus(center=(4, 0, 0)))) == (2, 0, 0, 2, 1)
    assert counted(joined(ball(), ball(0.5).flipped())) == (1, 0, 1, 4, 0)
    assert counted(joined(ball(), ball(0.05, center=(2, 0, 0)))) == (2, 1, 0, 4, 0)
    with pytest.raises(ValueError, match="4 edges do not have two triangles"):
        measures.topology(square())


@pytest.mark.parametrize("dimensions", [2, 3])
@pytest.mark.parametrize("width", [2.0, 5.0])
def test_edge_width_of_a_known_ramp(dimensions, width):
    cells, radius = 64, 20.0
    distance = np.linalg.norm(np.moveaxis(np.indices((cells,) * dimensions), 0, -1) + 0.5 - cells / 2, axis=-1)
    density = np.clip(0.5 - (distance - radius) / width, 0.0, 1.0)
    # A linear ramp falls from 90 to 10 % over four fifths of its width.
    assert measures.edge_width(3.7 * density, float(density.sum())) == pytest.approx(0.8 * width, rel=0.08)


def test_overlap_of_two_balls_matches_the_closed_form():
    shift, radius = 0.4, 0.9
    assert measures.overlap_with_ball(ball(points=8000)) == pytest.approx(1.0, abs=2e-3)
    assert measures.overlap_with_ball(ball(radius, points=8000)) == pytest.approx(radius**3, abs=2e-3)
    lens = np.pi * (2 - shift) ** 2 * (shift**2 + 4 * shift) / (12 * shift)
    found = measures.overlap_with_ball(ball(center=(0, shift, 0), points=8000))
    assert found == pytest.approx(lens / (8 / 3 * np.pi - lens), abs=3e-3)
    apart = measures.overlap_with_ball(joined(ball(radius, points=8000), ball(0.2, center=(3, 0, 0))))
    assert apart == pytest.approx(radius**3 / (1 + 0.2**3), abs=3e-3)


def test_distance_of_concentric_balls_is_the_difference_of_their_radii():
    found = measures.mean_surface_distance(ball(1.0, points=8000), ball(1.25, points=8000))
    assert found == pytest.approx(0.25, abs=2e-3)


def test_points_inside_a_mesh_are_recognized():
    points = np.random.default_rng(0).uniform(-2, 2, (500, 3))
    radii = np.linalg.norm(points, axis=1)
    clear = (abs(radii - 1) > 0.01) & (abs(radii - 0.5) > 0.01)
    found = measures.inside(points, joined(ball(points=4000), ball(0.5).flipped()))
    np.testing.assert_array_equal(found[clear], ((radii < 1) & (radii > 0.5))[clear])


def test_second_differences_ignore_straight_lines():
    assert measures.largest_second_difference(np.arange(9.0) * 3 - 1)[0] == 0
    assert measures.largest_second_difference([0, 1, 2, 5, 8]) == (2, 2)
    size, where = measures.largest_second_difference([[0, 0], [1, 1], [5, 4], [9, 7]])
    assert (size, where) == (pytest.approx(13**0.5), 1)


def test_thin_parts_are_those_that_a_ball_cannot_enter():
    filled = np.zeros((40, 40, 40), bool)
    filled[5:25, 5:25, 5:25] = True
    assert measures.thin_volume(filled, 1.0) <= 12 * 20 * 3, "only the edges of a cube are thin"
    rod = np.zeros_like(filled)
    rod[25:38, 14:16, 14:16] = True
    assert measures.thin_volume(filled | rod, 3.0) - measures.thin_volume(filled, 3.0) == pytest.approx(
        rod.sum(), abs=8
    )
    assert measures.thin_volume(rod, 3.0) == rod.sum()


def test_points_of_legs_lie_in_the_legs():
    first = Legged.at([32, 32, 32])
    second = Legged.at([30, 33, 32], [1.6, 1.0, 0.6])
    half = first.barycenter(second, 0.5)
    np.testing.assert_allclose(half.thin_points(), (first.thin_points() + second.thin_points()) / 2)
    for shape in (first, half, second):
        filled = shape.occupancy(64, 3)
        # Samples may miss cells of which the surface cuts off only a corner.
        assert (filled[tuple(shape.thin_points().astype(int).T)] > 0).mean() > 0.99
        ratio = filled.sum() / first.occupancy(64, 3).sum()
        assert ratio == pytest.approx(np.prod(shape.stretch), rel=0.01)
    assert first.thin_points()[:, 2].min() == pytest.approx(32 - 18 - RADIUS, abs=0.1)
