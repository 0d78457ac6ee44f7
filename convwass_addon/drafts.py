# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from .errors import ConvwassError


@contextmanager
def draft_of(path: Path, suffix: str | None = None) -> Iterator[Path]:
    """Give a path beside a file, which takes the file's place when it has been written.

    Where writing fails, the draft is removed, an old file stays as it is, and the error goes on.

    Parameters
    ----------
    path : Path
        The file; one that is there already is replaced.
    suffix : str, optional
        Of the draft, with its dot; by default that of the file.
    """
    draft = path.with_name(f".{uuid.uuid4().hex}{path.suffix.lower() if suffix is None else suffix}")
    try:
        yield draft
        os.replace(draft, path)
    finally:
        draft.unlink(missing_ok=True)


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Give a draft, as :func:`draft_of` does, and tell of what goes wrong.

    Raises
    ------
    ConvwassError
        The system or Blender (RuntimeError) could not write it.
    """
    try:
        with draft_of(path) as draft:
            yield draft
    except (RuntimeError, OSError) as error:
        reason = str(error).strip()
        raise ConvwassError("{file} could not be written: {reason}", file=str(path), reason=reason) from error
