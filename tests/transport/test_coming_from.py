# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The page for users of other libraries is correct: its snippets run here, next to POT."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import ot
import pytest

from convwass_addon.transport import Grid, distance

PAGE = Path(__file__).resolve().parents[2] / "docs" / "coming_from.md"
SNIPPETS = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


@pytest.fixture(scope="module")
def names():
    """All names defined by the snippets."""
    assert len(SNIPPETS) == 4
    assert sum(snippet.count("assert ") for snippet in SNIPPETS) >= 5
    found = {}
    for snippet in SNIPPETS:
        exec(compile(snippet, str(PAGE), "exec"), found)
    return found


def test_snippets_of_the_page_run(names):
    assert names["ours"].sum() == pytest.approx(1.0, abs=1e-6)


def test_names_of_pot_on_the_page_exist(names):
    used = set(re.findall(r"`(ot(?:\.\w+)+)", PAGE.read_text(encoding="utf-8")))
    assert len(used) >= 6
    for name in used:
        owner = ot
        for part in name.split(".")[1:]:
            owner = getattr(owner, part)


def test_the_plan_of_the_scalings_agrees_with_pot(names):
    grid, found = names["grid"], names["found"]
    kernel = np.exp(-names["M"] / (2.0 * grid.sigma**2))
    plan = found.v.reshape(-1, 1) * kernel * found.w.reshape(1, -1)
    np.testing.assert_allclose(plan / plan.sum(), names["plan"], atol=1e-6)


def test_divergences_are_squared_distances_here_and_in_pot():
    """Between two Gaussians of equal width: the squared distance of their means (Janati et al. 2020)."""
    n, width, sigma = 48, 4.0, 2.0
    x = np.arange(n)
    a, b = (np.exp(-((x - place) ** 2) / (2.0 * width**2)) for place in (18.0, 28.0))
    found = distance(a, b, Grid((n,), sigma), tolerance=1e-8)
    assert found.divergence == pytest.approx(100.0, rel=0.01)
    theirs = ot.bregman.empirical_sinkhorn_divergence(
        x[:, None].astype(float), x[:, None].astype(float), 2.0 * sigma**2, a / a.sum(), b / b.sum(), stopThr=1e-9
    )
    assert float(theirs) == pytest.approx(100.0, rel=0.01)
