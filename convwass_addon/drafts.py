# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from .disk_room import require_whole
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
            require_whole(draft, path)
    except (RuntimeError, OSError) as error:
        reason = str(error).strip()
        raise ConvwassError("{file} could not be written: {reason}", file=str(path), reason=reason) from error


class DraftFiles:
    """Files that are written beside those they replace, and take their places together, once all of them are there.

    A work that is stopped, or fails, leaves whatever was there.
    """

    def __init__(self) -> None:
        self._drafts: dict[Path, Path] = {}
        self._folders: list[Path] = []

    def draft_of(self, target: Path) -> Path:
        """Return where to write what will become a file; a folder that is missing is made."""
        if not target.parent.is_dir():
            target.parent.mkdir()
            self._folders.append(target.parent)
        draft = target.with_name(f".{uuid.uuid4().hex}{target.suffix}")
        self._drafts[target] = draft
        return draft

    def keep(self) -> list[Path]:
        """Put all of them into their places, and return these.

        Raises
        ------
        ConvwassError
            The system refused.
        """
        done = []
        try:
            for target, draft in self._drafts.items():
                require_whole(draft, target)
            for target, draft in self._drafts.items():
                os.replace(draft, target)
                done.append(target)
        except OSError as error:
            raise ConvwassError(
                "{file} could not be written: {reason}", file=str(target), reason=str(error).strip()
            ) from error
        finally:
            for target in done:
                del self._drafts[target]
        self._folders = []
        return done

    def discard(self) -> None:
        """Remove what was written, and folders that were made for it."""
        for draft in self._drafts.values():
            draft.unlink(missing_ok=True)
        for folder in self._folders:
            with suppress(OSError):
                folder.rmdir()
        self._drafts, self._folders = {}, []
