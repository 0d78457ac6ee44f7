# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The benchmark of recoloring measures what it says."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import recolor, recolor_cases, recolor_large
from benchmarks.recolor_cases import WAYS, distance_left, gradient_growth, lab, shown
from tests.applications.palettes import cloud


@pytest.fixture
def small(monkeypatch):
    """Small made-up pictures, and few samples of them."""
    monkeypatch.setattr(recolor_cases, "photograph", lambda name: recolor_cases.synthetic(len(name), 60, 90))
    monkeypatch.setattr(recolor_cases, "_SAMPLES", 100)


def test_distance_of_translates_is_their_length():
    """Along a random axis, a shift counts by its cosine: a third of its square on average."""
    first = cloud(0, (50, 0, 0), np.eye(3) * 5, 20_000)
    found = distance_left(first, first + np.array([[0.0], [30.0], [0.0]]))
    assert found == pytest.approx(30.0 / np.sqrt(3.0), rel=0.15)
    assert distance_left(first, first[:, ::-1]) == pytest.approx(0.0, abs=1e-9)


def test_growth_of_gradients():
    rng = np.random.default_rng(0)
    colors = rng.uniform(-20, 20, (3, 20, 30))
    assert gradient_growth(colors, colors) == pytest.approx(1.0)
    assert gradient_growth(colors, 3.0 * colors + 5.0) == pytest.approx(3.0)


def test_colors_come_back_from_the_screen():
    picture = recolor_cases.synthetic(3, 30, 40)
    np.testing.assert_allclose(shown(lab(picture)), picture, atol=1e-9)


def test_every_way_brings_the_palette_nearer(small):
    found = recolor_cases.pair("coffee", "camera!")
    assert set(found) == {"before", *WAYS}
    for name in WAYS:
        assert found[name]["left"] < 0.8 * found["before"], name
    assert found["sliced"]["left"] < found["linear"]["left"]


def test_larger_tables_are_more_exact(small):
    errors = [recolor_cases.table_error("coffee", "camera!", size)["mean"] for size in (9, 33)]
    assert errors[1] < 0.5 * errors[0]


def test_film_frames_are_measured(small, monkeypatch):
    monkeypatch.setattr(recolor_large, "_HEIGHT", 54)
    monkeypatch.setattr(recolor_large, "_WIDTH", 96)
    monkeypatch.setattr(recolor_large, "photograph", recolor_cases.photograph)
    pixels = recolor_large.enlarged("coffee")
    np.testing.assert_allclose(pixels * 255, np.round(pixels * 255), atol=1e-4)
    for kind in recolor_large.FORMATS:
        found = recolor_large.arrays("coffee", "camera!", kind, 1)
        assert 1000 < found["colors"] <= 54 * 96 and found["exact"]["cpu"] > 0 and found["table"]["cpu"] > 0


def test_the_tables_are_printed(monkeypatch, capsys):
    figures = {"seconds": 1.0, "left": 2.0, "growth": 3.0}
    clocks = {"cpu": 1.0, "wall": 2.0}
    answers = {
        "pair": {"before": 9.0, "linear": figures},
        "arrays": {"colors": 900, "solve": 0.5, "exact": clocks, "table": clocks, "more": 40.0},
        "editor": {**clocks, "more": 50.0},
        "table_error": {"mean": 0.1, "most": 1.0, "worst": 5.0},
    }
    monkeypatch.setattr(recolor, "measured", lambda _module, case, **_options: answers[case])
    recolor.main()
    printed = capsys.readouterr().out
    assert "chelsea -> astronaut" in printed and "linear" in printed and "3840 x 2160" in printed
