# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are either written completely or not at all."""

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

# Blender adds @ to the name of a .blend file while it writes it.
_DRAFT = re.compile(r"\.convwass-[0-9a-f]{16}(\.\w+)?@?")
# Age in seconds at which a draft counts as abandoned.
_OLD = 86_400.0


def new_draft(target: Path, suffix: str | None = None) -> Path:
    """Return a draft path for a file or folder, in the same folder so that moving it into place is atomic.

    Drafts that a killed Blender left there are removed after a day.

    Parameters
    ----------
    target : Path
        The final path.
    suffix : str, optional
        Extension of the draft, with its dot; by default that of the target.
    """
    _drop_old(target.parent)
    return target.with_name(f".convwass-{uuid.uuid4().hex[:16]}{target.suffix.lower() if suffix is None else suffix}")


# Cached: a folder may contain very many files, and new abandoned drafts are unlikely.
@lru_cache(maxsize=64)
def _drop_old(folder: Path) -> None:
    """Remove abandoned drafts from a folder."""
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
    """Provide a draft path, which replaces the file at the end of the context.

    On an error, the draft is removed, an existing file is kept, and the error is raised again.

    Parameters
    ----------
    path : Path
        The file to write or replace. If it is a draft itself, as of :class:`DraftFiles`, it is returned unchanged, and
        its creator moves it into place.
    suffix : str, optional
        Extension of the draft, with its dot; by default that of the file.
    """
    if _DRAFT.fullmatch(path.name):
        yield path
        return
    draft = new_draft(path, suffix)
    try:
        yield draft
        os.replace(draft, path)
    except OSError as error:
        if error.filename == str(draft):
            # Users know only the file.
            error.filename = str(path)
        raise
    finally:
        draft.unlink(missing_ok=True)


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Provide a draft path as :func:`draft_of` does, and report errors.

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
    """Files that are written as drafts and moved into place together once all are complete.

    If the work fails or is stopped, existing files are kept.
    """

    def __init__(self) -> None:
        self._drafts: dict[Path, Path] = {}
        self._folders: list[Path] = []

    def draft_of(self, target: Path) -> Path:
        """Return the draft path for a file; a missing folder is created."""
        if not target.parent.is_dir():
            # Another process may create it at the same time.
            target.parent.mkdir(exist_ok=True)
            self._folders.append(target.parent)
        draft = new_draft(target)
        self._drafts[target] = draft
        return draft

    def keep(self) -> list[Path]:
        """Move all files into place, and return their paths.

        Raises
        ------
        ConvwassError
            A file could not be moved.
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
        """Remove all drafts and the folders created for them."""
        for draft in self._drafts.values():
            draft.unlink(missing_ok=True)
        for folder in self._folders:
            with suppress(OSError):
                folder.rmdir()
        self._drafts, self._folders = {}, []
