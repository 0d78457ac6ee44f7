# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Registering adds everything and unregistering removes it, any number of times."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from types import ModuleType

import pytest


def convwass_types() -> set[str]:
    import bpy

    return {name for name in dir(bpy.types) if name.lower().startswith("convwass")}


def convwass_pointers() -> set[str]:
    """Names of the properties that the add-on added to Blender's own types."""
    import bpy

    owners = (bpy.types.Scene, bpy.types.Object, bpy.types.Collection, bpy.types.Mesh, bpy.types.WindowManager)
    return {f"{owner.__name__}.{name}" for owner in owners for name in dir(owner) if name.startswith("convwass")}


def handlers() -> dict[str, list]:
    """All registered application handlers."""
    import bpy

    lists = {name: getattr(bpy.app.handlers, name) for name in dir(bpy.app.handlers)}
    return {name: list(calls) for name, calls in lists.items() if isinstance(calls, list)}


def test_registering_twice_in_a_row_is_clean(empty_scene, registered_addon):
    added = convwass_types(), convwass_pointers()
    handlers_before = handlers()
    assert "CONVWASS_OT_bake_morph" in added[0]
    for _ in range(2):
        registered_addon.unregister()
        assert (convwass_types(), convwass_pointers()) == (set(), set())
        registered_addon.register()
        assert (convwass_types(), convwass_pointers()) == added
    assert handlers() == handlers_before


def test_failing_to_register_leaves_nothing(empty_scene, registered_addon, monkeypatch):
    from convwass_addon import panels

    def fail():
        raise RuntimeError("no panels today")

    registered_addon.unregister()
    with monkeypatch.context() as patch:
        patch.setattr(panels, "register", fail)
        with pytest.raises(RuntimeError, match="no panels today"):
            registered_addon.register()
    assert (convwass_types(), convwass_pointers()) == (set(), set())
    registered_addon.register()


@pytest.mark.parametrize("package", ["scipy", "skimage"])
def test_without_the_packages_the_error_names_the_zip_that_includes_them(project, package):
    script = f"import sys; sys.modules[{package!r}] = None; import bpy, convwass_addon; convwass_addon.register()"
    answer = subprocess.run([sys.executable, "-c", script], cwd=project, capture_output=True, text=True, timeout=600)
    assert answer.returncode == 1
    assert f"Convwass needs {package}" in answer.stderr
    assert "linux_x64" in answer.stderr


def test_optional_packages_may_be_missing(project):
    """The small zip includes no packages, and Linux distributions lack these two."""
    script = (
        "import sys; sys.modules.update(robust_laplacian=None, cholespy=None);"
        "import bpy, convwass_addon; convwass_addon.register(); convwass_addon.unregister();"
        # Baking, and solving on surfaces.
        "import convwass_addon.bridge.morphs.job, convwass_addon.transport;"
        "import convwass_addon.applications.densities.surface_densities;"
        # Commands are imported only for the command line.
        "sys.exit('convwass_addon.cli.program' in sys.modules)"
    )
    subprocess.run([sys.executable, "-c", script], cwd=project, check=True, timeout=600)


def test_extension_id_is_what_blender_calls_it(project, registered_addon, monkeypatch):
    assert registered_addon.extension_id() == "convwass_addon"
    assert imported_as("bl_ext.user_default.convwass.convwass_addon", project, monkeypatch).extension_id() == (
        "bl_ext.user_default.convwass"
    )


def imported_as(name: str, project, monkeypatch) -> ModuleType:
    """Import the package's top module under another name, as Blender does for an installed extension."""
    spec = importlib.util.spec_from_file_location(name, project / "convwass_addon" / "__init__.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, name, module)
    spec.loader.exec_module(module)
    return module
