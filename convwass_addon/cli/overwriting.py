# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Protect the input files of a command from its output."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from ..applications.whole_paths import share_a_place, whole_path
from ..errors import InputError


def refuse_overwriting(sources: Iterable[Path | None], targets: Iterable[Path | None]) -> None:
    """Check that no file to be written is one of the files that are read.

    Parameters
    ----------
    sources : iterable of Path or None
        The files that are read; None for inputs that were not given.
    targets : iterable of Path or None
        The files to be written; None for outputs that were not requested.

    Raises
    ------
    InputError
        A file is both, however its paths are spelled.
    """
    known = [whole_path(source) for source in sources if source is not None]
    read = [source for source in known if source.is_file()]
    for target in targets:
        if target is not None and share_a_place([whole_path(target)], read):
            raise InputError(
                "{file} is one of the inputs and would be overwritten; write to another file.", file=str(target)
            )
