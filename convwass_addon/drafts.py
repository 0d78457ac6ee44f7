# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import re
import shutil
import time
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path

from .disk_space import require_whole
from .errors import ConvwassError

_DRAFT = re.compile(r"\.convwass-[0-9a-f]{16}(\.\w+)?")
# Seconds after which nobody writes a draft any more.
_OLD = 86_400.0


def new_draft(target: Path, suffix: str | None = None) -> Path:
    """Return where to write what will take the place of a file or a folder: beside it, so that moving it is at once.

    What a Blender that was killed has left there is removed, once it is a day old.

    Parameters
    ----------
    target : Path
        Its place.
    suffix : str, optional
        Of the draft, with its dot; by default that of the target.
    """
    _drop_old(target.parent)
    return target.with_name(f".convwass-{uuid.uuid4().hex[:16]}{target.suffix.lower() if suffix is None else suffix}")


# Once for each: folders may hold very many files, and what is old was there before.
@lru_cache(maxsize=64)
def _drop_old(folder: Path) -> None:
    """Remove drafts from a folder that nobody will finish."""
    with suppress(OSError), os.scandir(folder) as entries:
        left = [entry for entry in entries if _DRAFT.fullmatch(entry.name) and _is_old(entry)]
        for entry in left:
            if entry.is_dir(follow_symlinks=False):
                shutil.rmtree(entry.path, ignore_errors=True)
            else:
                os.unlink(entry.path)


def _is_old(entry: os.DirEntry[str]) -> bool:
    return time.time() - entry.stat(follow_symlinks=False).st_mtime > _OLD


@contextmanager
def draft_of(path: Path, suffix: str | None = None) -> Iterator[Path]:
    """Give a path beside a file, which takes the file's place when it has been written.

    Where writing fails, the draft is removed, an old file stays as it is, and the error goes on.

    Parameters
    ----------
    path : Path
        The file; one that is there already is replaced. A draft, as of :class:`DraftFiles`, needs none of its own and
        is given as it is; whoever made it puts it into its place.
    suffix : str, optional
        Of the draft, with its dot; by default that of the file.
    """
    if _DRAFT.fullmatch(path.name):
        yield path
        return
    draft = new_draft(path, suffix)
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
        draft = new_draft(target)
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
