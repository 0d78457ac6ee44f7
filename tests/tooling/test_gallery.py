# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The gallery's pictures exist, and its code lines work."""

from __future__ import annotations

import importlib.util
import shlex
import sys

import numpy as np
import pytest

from convwass_addon.applications.skeletons.skeleton_fit import fit_steps
from convwass_addon.applications.skeletons.skeleton_graph import JointGraph
from convwass_addon.applications.skeletons.skeleton_settings import SkeletonSettings
from convwass_addon.applications.soft_maps.map_sides import MapSide
from convwass_addon.applications.soft_maps.map_solving import soft_map_steps
from convwass_addon.applications.soft_maps.surface_maps import distribution_of
from convwass_addon.cli import program
from convwass_addon.progress import drained
from convwass_addon.transport import Grid, Surface, barycenter, bisect, distance, point_distances, propagate
from tests.shapes import ball

LARGEST = 400_000


@pytest.fixture(scope="module")
def gallery(project):
    sys.path.insert(0, str(project / "docs"))
    try:
        spec = importlib.util.spec_from_file_location("gallery", project / "docs" / "gallery.py")
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
    finally:
        sys.path.remove(str(project / "docs"))
    return module


def drawn_here(project, gallery):
    return [figure for figure in gallery.FIGURES if (project / "docs" / figure.script[0]).is_file()]


def test_all_figures_exist_once_and_in_order(project, gallery):
    assert [figure.number for figure in gallery.FIGURES] == list(range(1, 15))
    assert len(drawn_here(project, gallery)) >= 13


def test_the_page_is_up_to_date(project, gallery):
    page = (project / "docs" / "gallery.md").read_text(encoding="utf-8")
    assert page == gallery.page(gallery.FIGURES), "python3 run.py gallery --page writes it anew"


def test_pictures_exist(project, gallery):
    for figure in drawn_here(project, gallery):
        assert (project / "docs" / "pictures" / figure.picture).is_file(), figure.picture


def test_the_readme_shows_four_of_them(project, gallery):
    readme = (project / "README.md").read_text(encoding="utf-8")
    shown = {f"Fig. {figure.number}: " for figure in gallery.FIGURES if f"(docs/pictures/{figure.picture})" in readme}
    assert len(shown) == 4 and all(f"![{number}" in readme for number in shown)


def test_new_pictures_are_small(project):
    for name in ("solids_path.jpg", "solids_triangle.jpg", "solids_grid.jpg", "two_maps.png", "side_by_side.jpg"):
        assert (project / "docs" / "pictures" / name).stat().st_size < LARGEST, name


def test_commands_are_understood(project, gallery):
    commands = [figure for figure in drawn_here(project, gallery) if figure.language == "sh"]
    assert len(commands) >= 6
    parser = program.command_line_parser("convwass")
    for figure in commands:
        words = shlex.split(figure.line)
        assert words[:5] == ["python3", "run.py", "python", "-m", "convwass_addon"]
        options = parser.parse_args(words[5:])
        for shape in getattr(options, "shapes", []):
            assert shape.startswith("text:") or shape.endswith(".png") or (project / shape).is_file()


@pytest.mark.parametrize("number", [2, 3, 4, 5, 6, 9, 10])
def test_python_lines_run(number, gallery):
    (figure,) = (figure for figure in gallery.FIGURES if figure.number == number)
    names = known(number)
    exec(figure.line, names)
    check(number, names)


def check(number, names):
    """Check that a line computed what its figure shows."""
    if number == 2:
        marginal = names["plan"].sum(axis=1)
        np.testing.assert_allclose(marginal / marginal.sum(), names["mu_0"] / names["mu_0"].sum(), atol=1e-4)
    elif number == 3:
        assert names["lengths"][17] == pytest.approx(0.0, abs=1e-6)
        points = names["surface"].positions
        angles = np.arccos(np.clip(points @ points[17], -1.0, 1.0))
        assert np.corrcoef(names["lengths"], angles)[0, 1] > 0.99
    elif number == 4:
        assert float(names["middle"].density @ names["surface"].weights) == pytest.approx(1.0, rel=1e-3)
    elif number in (5, 6):
        assert len(names["found"].densities) == {5: 4, 6: 5}[number]
    elif number == 9:
        assert np.abs(names["joints"][1]).max() < 0.3
    else:
        assert names["row"].shape == (len(names["horse"].mesh.vertices),)
        assert names["row"].max() > 0.0


def known(number):
    """Return small inputs with the names that the lines of a figure use."""
    shape = ball(1.0, points=120)
    if number == 2:
        line = np.linspace(0.0, 1.0, 32)
        peaks = [np.exp(-(((line - place) / 0.2) ** 2)) for place in (0.3, 0.6)]
        return {"np": np, "distance": distance, "grid": Grid((32,), sigma=2.0), "mu_0": peaks[0], "mu_1": peaks[1]}
    if number == 9:
        graph = JointGraph.from_arrays(
            [[-0.8, 0.0, 0.0], [0.0, 0.1, 0.0], [0.8, 0.0, 0.0]], [[0, 1], [1, 2]], [True, False, True], tuple("abc")
        )
        return {
            "drained": drained,
            "fit_steps": fit_steps,
            "SkeletonSettings": SkeletonSettings,
            "mesh": shape,
            "graph": graph,
        }
    if number == 10:
        ends = [int(shape.vertices[:, axis].argmax()) for axis in range(3)]
        pairs = np.array([[end, end] for end in [*ends, int(shape.vertices[:, 0].argmin())]])
        sides = {"cow": MapSide(shape, "cow"), "horse": MapSide(shape, "horse"), "pairs": pairs}
        return {**sides, "drained": drained, "soft_map_steps": soft_map_steps, "distribution_of": distribution_of}
    surface = Surface(shape.vertices, shape.faces)
    ends = [np.exp(3.0 * sign * shape.vertices[:, 0]) for sign in (-1.0, 1.0)]
    ends = [end / float(end @ surface.weights) for end in ends]
    names = {"surface": surface, "mu_0": ends[0], "mu_1": ends[1], "bound": "max"}
    functions = {"point_distances": point_distances, "barycenter": barycenter, "propagate": propagate}
    return {**names, **functions, "bisect": bisect}
