# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape morphing and other geometry by convolutional Wasserstein distances, for Blender.

Importing this package imports nothing of Blender: ``transport``, ``geometry`` and ``applications`` work without it.
"""

from __future__ import annotations

from importlib.util import find_spec
from types import ModuleType

_IN_PLATFORM_ZIPS = ("scipy", "skimage", "lazy_loader")


def extension_id() -> str:
    """Return the name by which Blender knows the add-on.

    Returns
    -------
    str
        ``bl_ext.<repository>.convwass`` where it was installed as an extension, ``convwass_addon`` where the package
        was imported by itself. `bpy.utils.extension_path_user` takes it, and an ``AddonPreferences`` class names it as
        its ``bl_idname``.
    """
    return __package__.removesuffix(".convwass_addon")


def register() -> None:
    """Add the properties, operators, panels and command-line commands to Blender; all of them or, on an error, none.

    Raises
    ------
    ModuleNotFoundError
        If Blender lacks a package that only the zip files for one platform bring along.
    """
    _require_packages()
    done = []
    try:
        for package in _packages():
            package.register()
            done.append(package)
    except Exception:
        for package in reversed(done):
            package.unregister()
        raise


def unregister() -> None:
    """Take away what `register` added, in the opposite order."""
    for package in reversed(_packages()):
        package.unregister()


def _require_packages() -> None:
    # They are imported when work begins, which is too late to find out that they are missing.
    for package in _IN_PLATFORM_ZIPS:
        if find_spec(package) is None:
            message = (
                f"Convwass needs {package}, which this Blender does not have. Install the zip file that is named after "
                f"your platform (linux_x64, windows_x64 or macos_arm64): it brings everything along."
            )
            raise ModuleNotFoundError(message, name=package)


def _packages() -> tuple[ModuleType, ...]:
    # Imported here, since they import bpy and the rest of the package must do without.
    from . import (
        cli,
        operators,
        panels,
        preferences,
        properties,
        solver_presets,
        translations,
    )

    return (
        translations,
        *properties.registered(),
        solver_presets,
        preferences,
        operators,
        panels,
        cli,
    )
