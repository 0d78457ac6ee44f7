# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What the operating system must have, and the line that installs it where it is missing."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

BLENDER_APT = "libx11-6 libxext6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libice6 libgl1 libegl1"
BLENDER_DNF = "libX11 libXext libXrender libXfixes libXi libxkbcommon libSM libICE libglvnd-glx libglvnd-egl"
"""The packages that hold the libraries which ``import bpy`` loads, and libEGL, without which rendering aborts."""

CHOLMOD_APT = "gcc libc6-dev python3-dev libsuitesparse-dev"
CHOLMOD_DNF = "gcc python3-devel suitesparse-devel"
"""The packages that scikit-sparse needs to be compiled."""


def as_root() -> str:
    """Return what begins a line that root has to run: nothing where the user is root, who may not have sudo."""
    return "" if hasattr(os, "geteuid") and os.geteuid() == 0 else "sudo "


def install_lines(apt: str, dnf: str) -> str:
    """Return the command that installs packages here; both known ones where neither apt-get nor dnf is found."""
    sudo = as_root()
    by_tool = {
        "apt-get": f"    {sudo}apt-get update && {sudo}apt-get install -y {apt}",
        "dnf": f"    {sudo}dnf install -y {dnf}",
    }
    here = [line for tool, line in by_tool.items() if shutil.which(tool)]
    return here[0] if here else "\n".join(by_tool.values())


def missing_for_cholmod(has_python_headers: bool) -> list[str]:
    """Return what is not there of the things that scikit-sparse needs to be compiled; empty where it can be tried."""
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
