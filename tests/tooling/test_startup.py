# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Enabling the extension and drawing its panels imports nothing that only work needs.

If one of these tests fails, the last line of the traceback in this package is an import that belongs in the function
that starts the work; see CONTRIBUTING.md.
"""

from __future__ import annotations

import subprocess
import sys

REFUSING = """
import builtins, sys

WORK = ("scipy", "skimage", "robust_laplacian", "cholespy", "sksparse", "threadpoolctl", "distributed")
import_before = builtins.__import__

def import_unless_for_work(name, globals=None, locals=None, fromlist=(), level=0):
    if level == 0 and name.partition(".")[0] in WORK:
        raise AssertionError(f"{name} is imported before there is work for it")
    return import_before(name, globals, locals, fromlist, level)

import bpy
import numpy

builtins.__import__ = import_unless_for_work
"""

REGISTERED = "import convwass_addon; convwass_addon.register()\n"

# Transport is the solver; everything that imports it imports SciPy.
CHECKED = "found = {*sys.modules} & {*WORK, 'convwass_addon.transport'}; assert not found, found\n"

LOOKED_AT = """
from tests.panels.drawing import draw, panels

bpy.ops.mesh.primitive_cube_add()
assert len(panels()) > 20
assert [panel for panel in panels() if draw(panel)]
operators = [name for name in dir(bpy.types) if name.startswith("CONVWASS_OT_")]
assert len(operators) > 40
for name in operators:
    getattr(bpy.ops.convwass, name.removeprefix("CONVWASS_OT_")).poll()
"""


# Blender 4.5 may crash if a process ends normally.
END = "import os; sys.stderr.flush(); os._exit(0)\n"


def run(project, script: str) -> None:
    answer = subprocess.run(
        [sys.executable, "-c", script + END], cwd=project, capture_output=True, text=True, timeout=600
    )
    assert answer.returncode == 0, answer.stderr
    # Blender prints errors in classes and continues.
    assert answer.stderr == ""


def test_registering_imports_no_work_modules(project):
    run(project, REFUSING + REGISTERED + CHECKED)


def test_drawing_panels_and_polling_imports_no_work_modules(project):
    run(project, REFUSING + REGISTERED + LOOKED_AT + CHECKED)
