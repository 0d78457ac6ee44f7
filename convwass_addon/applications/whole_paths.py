# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Resolve paths entered by users, or explain what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from ..errors import InputError

# Overlong paths are truncated to this many characters in messages.
_SHOWN = 200


def whole_path(path: str | Path) -> Path:
    """Return the absolute form of a path, with ``~`` replaced by the home folder.

    Only checks that such a path can exist, not that it does, so that later queries about it or its parents do not fail.

    Raises
    ------
    InputError
        A path that cannot exist on this system: too long, with an unknown user, or with circular links; or one that
        Blender cannot use, because its bytes are not UTF-8.
    """
    try:
        str(path).encode()
        whole = Path(path).expanduser().absolute()
        if whole.root == "//":
            # In Blender, this would be relative to the open file; for the system, it is the root.
            whole = Path("/", *whole.parts[1:])
        with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
            os.lstat(whole)
    except UnicodeEncodeError as error:
        shown = _short(path).encode(errors="backslashreplace").decode()
        raise InputError("{path} is not UTF-8, as Blender requires of paths; rename it.", path=shown) from error
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError("{path} is no path of a file: {reason}.", path=_short(path), reason=_reason(error)) from error
    return whole


def path_with_suffix(path: str | Path, suffix: str) -> Path:
    """Return a path that ends in a suffix such as ``.blend``, which is added if it is missing, as Blender does.

    Raises
    ------
    InputError
        A path without a file name, such as ``.``, ``..`` or ``/``.
    """
    target = Path(path)
    if target.name in ("", ".."):
        raise InputError("{target} is a folder; add a file name to it.", target=_short(path))
    # Other suffixes are kept: they may tell files apart, as in horse.v001 and horse.v002.
    return target if target.suffix.lower() == suffix else target.with_name(target.name + suffix)


def share_a_place(paths: Iterable[Path], others: Iterable[Path]) -> bool:
    """Return whether any of some paths refers to the same file as any of the others.

    Resolves dots, links and, on case-insensitive systems, case.
    """
    return not {_place(path) for path in paths}.isdisjoint({_place(path) for path in others})


def _place(path: Path) -> object:
    """Return a path's file identity, or the resolved path if it does not exist yet."""
    with suppress(OSError):
        status = os.stat(path)
        # Some file systems have no inode numbers.
        if status.st_ino:
            return status.st_dev, status.st_ino
    return os.path.normcase(os.path.realpath(path))


def _short(path: str | Path) -> str:
    text = str(path)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


def _reason(error: Exception) -> str:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return reason.rstrip(".")
