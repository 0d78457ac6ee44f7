# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Fixtures for all tests: a clean Blender profile with an empty scene."""

from __future__ import annotations

import os
import shutil
import sys
import tempfile
from pathlib import Path

import hypothesis
import pytest

# Blender reads these while bpy is imported, so no test module may have imported it before.
for variable in [name for name in os.environ if name.startswith(("BLENDER_USER_", "BLENDER_SYSTEM_"))]:
    del os.environ[variable]
_USER_RESOURCES = tempfile.mkdtemp(prefix="convwass-tests-")
os.environ["BLENDER_USER_RESOURCES"] = _USER_RESOURCES

if "PYTEST_XDIST_WORKER" in os.environ:
    # Several processes share the machine; NumPy's BLAS and OpenMP read these when they are loaded.
    os.environ["OPENBLAS_NUM_THREADS"] = os.environ["OMP_NUM_THREADS"] = "1"

# Tests also run on loaded machines: no test fails for being slow. `run.py fuzz` draws far more than 15 examples.
hypothesis.settings.register_profile("convwass", deadline=None, max_examples=15)
hypothesis.settings.load_profile("convwass")


_exit_status = 0


def pytest_sessionfinish(exitstatus: int) -> None:
    global _exit_status
    _exit_status = int(exitstatus)


@pytest.hookimpl(trylast=True)
def pytest_unconfigure() -> None:
    shutil.rmtree(_USER_RESOURCES, ignore_errors=True)
    bpy = sys.modules.get("bpy")
    if bpy is not None and bpy.app.version < (5, 0):
        # Blender 4.5 may wait forever for one of its own threads if the process ends normally.
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_exit_status)


@pytest.fixture(scope="session")
def project() -> Path:
    """The project's folder."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def registered_addon():
    """Register the add-on in this process's Blender, with factory settings, once for all tests."""
    import bpy

    import convwass_addon

    bpy.ops.wm.read_factory_settings(use_empty=True)
    convwass_addon.register()
    yield convwass_addon
    convwass_addon.unregister()


@pytest.fixture
def empty_scene(registered_addon):
    """Blender with factory settings, the add-on registered and an empty scene; returns the scene.

    Only the file is new: loading the preferences would also register Blender's own add-ons, once per test.
    """
    import bpy

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    return bpy.context.scene


@pytest.fixture(scope="session")
def scene_with(tmp_path_factory):
    """Give a function that begins a new file with what another function makes in an empty scene; returns the scene.

    What takes long to make is made only once. The file that is open then has not been saved.
    """
    import bpy

    files = {}

    def begun(make):
        if make not in files:
            bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
            make()
            files[make] = str(tmp_path_factory.mktemp("begun") / "begun.blend")
            bpy.ops.wm.save_as_mainfile(filepath=files[make], copy=True)
        bpy.ops.wm.read_homefile(filepath=files[make])
        return bpy.context.scene

    return begun
