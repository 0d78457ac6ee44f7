# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Shape morphing and other geometry by convolutional Wasserstein distances, for Blender.

Importing this package does not import Blender: ``transport``, ``geometry`` and ``applications`` work without it.
"""

from __future__ import annotations

from importlib.util import find_spec
from types import ModuleType

_IN_PLATFORM_ZIPS = ("scipy", "skimage", "lazy_loader")


def extension_id() -> str:
    """Return the add-on's name in Blender.

    Returns
    -------
    str
        ``bl_ext.<repository>.convwass`` if installed as an extension, ``convwass_addon`` if the package was imported
        directly. Used for `bpy.utils.extension_path_user` and as the ``bl_idname`` of ``AddonPreferences``.
    """
    return __package__.removesuffix(".convwass_addon")


def register() -> None:
    """Register properties, operators, panels and command-line commands; on an error, register none.

    Raises
    ------
    ModuleNotFoundError
        Blender lacks a package that is only contained in the platform-specific zip files.
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
    """Undo `register`, in reverse order."""
    for package in reversed(_packages()):
        package.unregister()


def _require_packages() -> None:
    # These packages are only imported when work begins, which is too late to find out that they are missing.
    for package in _IN_PLATFORM_ZIPS:
        if find_spec(package) is None:
            message = (
                f"Convwass needs {package}, which this Blender does not have. Install the zip file that is named after "
                f"your platform (linux_x64, windows_x64 or macos_arm64): it brings everything along."
            )
            raise ModuleNotFoundError(message, name=package)


def _packages() -> tuple[ModuleType, ...]:
    # Imported here because they import bpy, which the rest of the package must not.
    from . import (
        cli,
        manual,
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
        manual,
        cli,
    )
