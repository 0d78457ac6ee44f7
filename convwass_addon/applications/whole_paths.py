# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Paths as people write them: whole ones, or a message that says what is wrong with them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path

from ..errors import InputError

# Of a path that is refused for being too long, the beginning will do.
_SHOWN = 200


def whole_path(path: str | Path) -> Path:
    """Return the absolute path that is meant, with a user's folder in the place of ``~``.

    Whether there is anything is not looked at, only whether there could be: the path may then be asked for its parents
    and for what is there.

    Raises
    ------
    InputError
        A path that no file of this system can have: too long, with a user who is unknown, or in a circle of links.
    """
    try:
        whole = Path(path).expanduser().absolute()
        with suppress(FileNotFoundError, NotADirectoryError, PermissionError):
            os.lstat(whole)
    except (OSError, RuntimeError, ValueError) as error:
        raise InputError("{path} is no path of a file: {reason}.", path=_short(path), reason=_reason(error)) from error
    return whole


def path_with_suffix(path: str | Path, suffix: str) -> Path:
    """Return a path that ends in `suffix`, such as ``.blend``, instead of what it ends in.

    Raises
    ------
    InputError
        It names no file, such as ``.`` or ``/``.
    """
    try:
        return Path(path).with_suffix(suffix)
    except ValueError as error:
        raise InputError("{target} is a folder; add a file name to it.", target=_short(path)) from error


def share_a_place(paths: Iterable[Path], others: Iterable[Path]) -> bool:
    """Tell whether one of some paths leads to where one of the others does.

    Dots, links and, where the system makes no difference, small letters do not hide it.
    """
    return not {_place(path) for path in paths}.isdisjoint({_place(path) for path in others})


def _place(path: Path) -> object:
    """Return what the system knows a file or a folder by, or a path without links to what is not there yet."""
    with suppress(OSError):
        status = os.stat(path)
        # Some file systems number nothing.
        if status.st_ino:
            return status.st_dev, status.st_ino
    return os.path.normcase(os.path.realpath(path))


def _short(path: str | Path) -> str:
    text = str(path)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…"


def _reason(error: Exception) -> str:
    reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return reason.rstrip(".")
