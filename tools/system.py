# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Required system packages, and the command that installs them."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

BLENDER_APT = "libx11-6 libxext6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1"
BLENDER_DNF = "libX11 libXext libXrender libXfixes libXi libxkbcommon libSM libICE libglvnd-glx libglvnd-egl"
"""The packages of the libraries that ``import bpy`` loads, and of libEGL, without which rendering aborts."""

CHOLMOD_APT = "gcc libc6-dev python3-dev libsuitesparse-dev"
CHOLMOD_DNF = "gcc python3-devel suitesparse-devel"
"""The packages needed to compile scikit-sparse."""


def as_root() -> str:
    """Return the prefix for commands that need root: empty if the user is root, because sudo may be missing then."""
    return "" if hasattr(os, "geteuid") and os.geteuid() == 0 else "sudo "


def install_lines(apt: str, dnf: str) -> str:
    """Return the command that installs packages on this system; both variants if it has neither apt-get nor dnf."""
    sudo = as_root()
    by_tool = {
        "apt-get": f"    {sudo}apt-get update && {sudo}apt-get install -y {apt}",
        "dnf": f"    {sudo}dnf install -y {dnf}",
    }
    here = [line for tool, line in by_tool.items() if shutil.which(tool)]
    return here[0] if here else "\n".join(by_tool.values())


def missing_for_cholmod(has_python_headers: bool) -> list[str]:
    """Return the missing prerequisites for compiling scikit-sparse; empty if it can be tried."""
    missing = []
    if not any(map(shutil.which, (os.environ.get("CC", "cc"), "cc", "gcc", "clang"))):
        missing.append("a C compiler")
    if not has_python_headers:
        missing.append("Python's headers")
    if not any((folder / "cholmod.h").is_file() for folder in _header_folders()):
        missing.append("SuiteSparse's headers")
    return missing


def _header_folders() -> list[Path]:
    prefixes = [Path("/usr"), Path("/usr/local"), Path("/opt/homebrew")]
    folders = [prefix / "include" / name for prefix in prefixes for name in ("", "suitesparse")]
    stated = os.environ.get("SUITESPARSE_INCLUDE_DIR")
    return [Path(stated), *folders] if stated else folders
