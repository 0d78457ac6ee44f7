# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A hash of the code that computes frames."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

from ...errors import InputError

PACKAGE = Path(__file__).resolve().parents[2]
# Everything that the applications import from the package.
_DIGESTED = (
    "transport",
    "geometry",
    "applications",
    "array_files.py",
    "disk_space.py",
    "drafts.py",
    "errors.py",
    "one_line.py",
    "progress.py",
    "schema.py",
    "sentence.py",
)


def digested_files(package: Path) -> list[Path]:
    """Return the source files that determine the frames.

    Parameters
    ----------
    package : Path
        Folder of the package, ``convwass_addon`` or a copy of it.

    Returns
    -------
    list of Path
        Sorted.

    Raises
    ------
    InputError
        A folder or file is missing: a hash of the rest would not distinguish versions.
    """
    found: list[Path] = []
    for name in _DIGESTED:
        path = package / name
        files = [path] if path.is_file() else list(path.rglob("*.py"))
        if not files:
            raise InputError(
                "The source files {path} are missing, so cached frames cannot be told from those of another version; "
                "install Convwass again.",
                path=str(path),
            )
        found += files
    return sorted(found)


def digest_of(package: Path) -> bytes:
    """Return the SHA-256 of the code that computes frames, independent of line endings.

    Parameters
    ----------
    package : Path
        Folder of the package.

    Raises
    ------
    InputError
        Sources are missing.
    """
    hashed = hashlib.sha256()
    for path in digested_files(package):
        content = path.read_bytes().replace(b"\r\n", b"\n")
        hashed.update(f"{path.relative_to(package).as_posix()} {len(content)}\n".encode() + content)
    return hashed.digest()


@cache
def code_digest() -> bytes:
    """Return the SHA-256 of this code, which distinguishes frames computed by different versions.

    It takes about 30 ms of CPU time, once per process, in the computing thread.
    """
    return digest_of(PACKAGE)
