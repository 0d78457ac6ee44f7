# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The transport library works in plain Python with only NumPy and SciPy."""

from __future__ import annotations

import subprocess
import sys

import pytest

ONLY_NUMPY_AND_SCIPY = """
import sys
from importlib.metadata import packages_distributions

INSTALLED = packages_distributions().keys() - {"numpy", "scipy", "convwass_addon"}
assert INSTALLED >= {"bpy", "skimage", "robust_laplacian", "threadpoolctl"}

class Missing:
    def find_spec(self, name, path=None, target=None):
        if name.partition(".")[0] in INSTALLED:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Missing())
sys.path.insert(0, sys.argv[1])
"""

GRID = """
import numpy as np
from convwass_addon.transport import Grid, barycenter

# Between two Gaussians of one width lies the same Gaussian, half-way.
x = np.arange(32) + 0.5
pair = np.exp(-((x - np.array([[10.0], [20.0]])) ** 2) / 8.0)
found = barycenter(pair / pair.mean(axis=1, keepdims=True), [0.5, 0.5], Grid((32,), 1.0))
assert found.converged
assert abs(found.density @ x / found.density.sum() - 15.0) < 0.01
"""

SURFACE = """
import numpy as np
from convwass_addon.transport import Surface, distance_matrix

# All corners of a regular tetrahedron are equally far apart, and have a quarter of its area.
corners = np.array([(1, 1, 1), (1, -1, -1), (-1, 1, -1), (-1, -1, 1)], dtype=float)
surface = Surface(corners, [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)])
found = distance_matrix(4 * np.eye(4), surface).values
np.testing.assert_allclose(found, found[0, 1] * (1 - np.eye(4)), rtol=1e-6)
assert found[0, 1] > 0.0
"""


@pytest.mark.parametrize("work", [GRID, SURFACE], ids=["grid", "surface"])
def test_transport_needs_only_numpy_and_scipy(project, work):
    command = [sys.executable, "-I", "-c", ONLY_NUMPY_AND_SCIPY + work, str(project)]
    answer = subprocess.run(command, capture_output=True, text=True, timeout=600)
    assert answer.returncode == 0, answer.stderr


def test_the_command_line_says_that_it_needs_blender(project):
    script = ONLY_NUMPY_AND_SCIPY + "import runpy; runpy.run_module('convwass_addon', run_name='__main__')"
    answer = subprocess.run(
        [sys.executable, "-I", "-c", script, str(project)], capture_output=True, text=True, timeout=600
    )
    assert answer.returncode == 1
    assert answer.stderr == "The command line needs Blender as a Python module: pip install 'convwass[blender]'\n"
