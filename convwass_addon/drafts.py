# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Files that are either written completely or not at all."""

from __future__ import annotations

import os
import re
import shutil
import time
import uuid
from collections.abc import Iterator, Mapping
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
    with _told(path), draft_of(path) as draft:
        yield draft
        require_whole(draft, path)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Report errors of the system and of Blender as ConvwassErrors that name a file."""
    try:
        yield
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

    @contextmanager
    def written(self, target: Path) -> Iterator[Path]:
        """Provide the draft path for a file, and report errors as :func:`written_whole` does."""
        with _told(target):
            draft = self.draft_of(target)
            yield draft
            require_whole(draft, target)

    def keep(self) -> list[Path]:
        """Move all files into place, and return their paths.

        Raises
        ------
        ConvwassError
            A draft is incomplete, or a file could not be moved; all files are as before.
        """
        for target, draft in self._drafts.items():
            require_whole(draft, target)
        replace_together(self._drafts)
        done = list(self._drafts)
        self._drafts, self._folders = {}, []
        return done

    def discard(self) -> None:
        """Remove all drafts and the folders created for them."""
        for draft in self._drafts.values():
            draft.unlink(missing_ok=True)
        for folder in self._folders:
            with suppress(OSError):
                folder.rmdir()
        self._drafts, self._folders = {}, []


@contextmanager
def written_together() -> Iterator[DraftFiles]:
    """Provide drafts that are moved into place together at the end of the context; on an error, none is.

    Raises
    ------
    ConvwassError
        As :meth:`DraftFiles.keep`.
    """
    drafts = DraftFiles()
    try:
        yield drafts
        drafts.keep()
    finally:
        drafts.discard()


def replace_together(drafts: Mapping[Path, Path]) -> None:
    """Move drafts to their targets, the keys; if that fails or is interrupted, all existing files are kept.

    Raises
    ------
    ConvwassError
        A file could not be moved.
    """
    old = {target: new_draft(target) for target in drafts}
    try:
        for target, draft in drafts.items():
            with _told(target):
                if os.path.lexists(target) and not target.is_dir():
                    _set_aside(target, old[target])
                os.replace(draft, target)
    except BaseException:
        for target, draft in drafts.items():
            _restore(target, old[target], draft)
        raise
    for kept in old.values():
        kept.unlink(missing_ok=True)


def _set_aside(target: Path, old: Path) -> None:
    """Give a file a second name, under which it survives; where the file system allows only one, it is moved."""
    try:
        os.link(target, old, follow_symlinks=False)
    except (OSError, NotImplementedError):
        os.replace(target, old)


def _restore(target: Path, old: Path, draft: Path) -> None:
    """Undo moving a draft to a target, as far as it was done."""
    if os.path.lexists(old):
        os.replace(old, target)
        # Nothing is moved where both are names of one file.
        old.unlink(missing_ok=True)
    elif not draft.exists():
        target.unlink(missing_ok=True)
