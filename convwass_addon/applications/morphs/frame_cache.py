# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of finished frames, from which an interrupted bake continues and which several machines can share."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import fields
from pathlib import Path

import numpy as np

from ...errors import ConvwassError, InputError
from ...sentence import Sentence
from ..whole_paths import whole_path
from .code_digest import code_digest
from .demands import Demand
from .frame_file import DamagedFrameError, StoredFrame, read_frame, write_frame
from .layouts import Blend
from .morph_inputs import MorphInputs
from .morph_problem import MorphFrame
from .morph_settings import MorphSettings

# The fields of a frame that a file stores.
_KEPT = tuple(one.name for one in fields(StoredFrame))


class FrameCache:
    """A folder with one file per frame, named by a hash of everything that the frame depends on.

    Files are replaced atomically, so machines that write the same frame at the same time do no harm. Nothing is ever
    deleted; the folder may be deleted when the morph is finished.

    Parameters
    ----------
    folder : Path
        Created if it does not exist.

    Attributes
    ----------
    notices : list of Sentence
        Warnings for the user about unusable files.
    reused : int
        Number of frames that were read instead of computed.

    Raises
    ------
    InputError
        The folder cannot be created or written to.
    """

    keeps_potentials = True
    """Whether blends between its frames can be had from them; that takes several times the room."""

    def __init__(self, folder: Path) -> None:
        self.folder = whole_path(folder)
        self.notices: list[Sentence] = []
        self.reused = 0
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InputError(
                "The cache folder {folder} cannot be made ({reason}).", folder=str(self.folder), reason=error.strerror
            ) from error
        if not os.access(self.folder, os.R_OK | os.W_OK | os.X_OK):
            raise InputError(
                "The cache folder {folder} cannot be read and written; choose another one.", folder=str(self.folder)
            )

    def of(self, inputs: MorphInputs, settings: MorphSettings, pairs: Sequence[tuple[int, int]] = ()) -> BakeCache:
        """Return the part of the cache that belongs to one bake; parameters as for :func:`.morph.morph`."""
        digest = _bake_digest(inputs, settings, pairs)
        # Blends of animated inputs have none, because every blend is one of other shapes.
        return BakeCache(self, digest, keeps_potentials=self.keeps_potentials and inputs.animation is None)

    def missed(self, error: OSError) -> None:
        """Handle a frame that could not be written.

        Raises
        ------
        ConvwassError
            Always: a user who names a folder wants the frames in it.
        """
        raise ConvwassError(
            "A frame could not be written to {folder} ({reason}); make room there, or choose another folder.",
            folder=str(self.folder),
            reason=error.strerror or type(error).__name__,
        ) from error


class SpareFrameCache(FrameCache):
    """An automatic folder of frames, for the case that a bake is interrupted.

    The oldest frames are deleted when it exceeds its size. If it cannot be written to, the bake continues without it.

    Parameters
    ----------
    folder : Path
        Created if it does not exist; all frames in it belong to the cache.
    most_bytes : int
        Maximum size at the start of a bake.

    Raises
    ------
    InputError
        The folder cannot be created or written to.
    """

    keeps_potentials = False

    def __init__(self, folder: Path, most_bytes: int) -> None:
        super().__init__(folder)
        _drop_oldest(self.folder, most_bytes)

    def missed(self, error: OSError) -> None:
        """Add a notice that a frame could not be written, once."""
        notice = Sentence(
            "Frames are not kept in {folder} for the case of an interruption ({reason}).",
            {"folder": str(self.folder), "reason": error.strerror or type(error).__name__},
        )
        if notice not in self.notices:
            self.notices.append(notice)


def _drop_oldest(folder: Path, most_bytes: int) -> None:
    """Delete the oldest frames until the others fit; files that another program holds open stay."""
    found = []
    for path in folder.glob("*.frame"):
        with suppress(OSError):
            described = path.lstat()
            found.append((described.st_mtime, described.st_size, path))
    room = most_bytes
    for _, size, path in sorted(found, reverse=True):
        room -= size
        if room < 0:
            with suppress(OSError):
                path.unlink()


class BakeCache:
    """The frames of one bake in a cache.

    Parameters
    ----------
    cache : FrameCache
        The folder.
    digest : bytes
        Hash that identifies the bake.
    keeps_potentials : bool
        Whether frames of inputs that do not move are stored with their potentials.
    """

    def __init__(self, cache: FrameCache, digest: bytes, *, keeps_potentials: bool) -> None:
        self._cache = cache
        self._digest = digest
        self.keeps_potentials = keeps_potentials

    def paths(self, run: Sequence[Blend]) -> list[Path]:
        """Return the files of a run's frames, whether or not they exist."""
        return [self._cache.folder / f"{key}.frame" for key in self._keys(run)]

    def holds(self, run: Sequence[Blend]) -> bool:
        """Whether all frames of a run exist and are valid; a notice is added for damaged ones."""
        keys = self._keys(run)
        files = zip(self.paths(run), keys, run, strict=True)
        return all(self._read(path, key, blend) is not None for path, key, blend in files)

    def load(self, run: Sequence[Blend]) -> list[MorphFrame]:
        """Return the frames of a run from the cache.

        Raises
        ------
        ConvwassError
            A file has since been changed or removed.
        """
        frames = []
        for blend, path, key in zip(run, self.paths(run), self._keys(run), strict=True):
            stored = self._read(path, key, blend)
            if stored is None:
                raise ConvwassError(
                    "The cache folder {folder} lost a frame meanwhile; bake again.", folder=str(self._cache.folder)
                )
            frames.append(MorphFrame(blend=blend, **vars(stored)))
        self._cache.reused += len(frames)
        return frames

    def save(self, run: Sequence[Blend], frames: Sequence[MorphFrame]) -> None:
        """Store all frames of a run.

        Raises
        ------
        ConvwassError
            A file cannot be written.
        """
        for frame, path, key in zip(frames, self.paths(run), self._keys(run), strict=True):
            self._write(path, key, frame)

    def _write(self, path: Path, key: str, frame: MorphFrame) -> None:
        try:
            write_frame(path, key, StoredFrame(**{name: vars(frame)[name] for name in _KEPT}))
        except OSError as error:
            # On Windows, a file that another machine is reading cannot be replaced; if so, it holds the same frame.
            if self._read(path, key, frame.blend) is None:
                self._cache.missed(error)

    def load_again(self, run: Sequence[Blend], blend: Blend, demand: Demand) -> MorphFrame | None:
        """Return a blend of a run that was computed again for a demand, if it is stored."""
        stored = self._read(*self._again(run, blend, demand), blend)
        if stored is None:
            return None
        self._cache.reused += 1
        return MorphFrame(blend=blend, **vars(stored))

    def save_again(self, run: Sequence[Blend], frame: MorphFrame, demand: Demand) -> None:
        """Store a blend that was computed again; raises ConvwassError if a file cannot be written."""
        self._write(*self._again(run, frame.blend, demand), frame)

    def _again(self, run: Sequence[Blend], blend: Blend, demand: Demand) -> tuple[Path, str]:
        """Return the file and the key of a blend that is computed again."""
        own = self._keys(run)[run.index(blend)]
        key = hashlib.sha256(f"{own} {demand.digest()}".encode()).hexdigest()
        return self._cache.folder / f"{key}.frame", key

    def _keys(self, run: Sequence[Blend]) -> list[str]:
        """Return a key for every frame of a run; it depends on earlier blends of the run, which were its starts."""
        hashed = hashlib.sha256(self._digest)
        keys = []
        for blend in run:
            hashed.update(json.dumps(blend.weights).encode() + b"\n")
            keys.append(hashed.copy().hexdigest())
        return keys

    def _read(self, path: Path, key: str, blend: Blend) -> StoredFrame | None:
        try:
            stored = read_frame(path, key)
            suiting = all(part.suit(part.inside.shape, blend.weights) for part in stored.potentials)
            if blend.source is not None:
                suiting = not stored.potentials
            elif self.keeps_potentials and not _is_moved(stored.record):
                suiting = suiting and bool(stored.potentials)
            if not suiting:
                raise DamagedFrameError("its potentials are of another blend")
            if stored.origins is not None and len(stored.origins) != len(blend.weights):
                raise DamagedFrameError("its origins are of another blend")
            return stored
        except FileNotFoundError:
            return None
        except DamagedFrameError as error:
            reason = str(error)
        except OSError as error:
            reason = error.strerror or type(error).__name__
        values = {"path": str(path), "reason": reason}
        self._cache.notices.append(Sentence("{path} cannot be used and is made again: {reason}.", values))
        return None


def _is_moved(record: Mapping[str, object]) -> bool:
    """Whether a frame is one of moving inputs, which has no potentials; the record may come from any file."""
    motion = record.get("motion")
    return isinstance(motion, Mapping) and motion.get("kind") in ("guided", "combined", "warp")


def _bake_digest(inputs: MorphInputs, settings: MorphSettings, pairs: Sequence[tuple[int, int]]) -> bytes:
    """SHA-256 of everything that determines the frames of a bake: code, settings, shapes and their parts."""
    hashed = hashlib.sha256(code_digest())
    description = {"settings": settings.as_dict(), "shapes": len(inputs.shapes)}
    if settings.motion != "transport":
        # One motion suits all pairs.
        description["guides"] = [sorted(guide.items()) for guide in inputs.guides]
        description["pairs"] = [list(pair) for pair in pairs]
    followed, animation, matching = [], inputs.animation, inputs.matching
    if animation is not None:
        description["times"] = [*(list(shape.times) for shape in animation.shapes), list(animation.stations)]
        followed = animation.meshes
    arrays = [mesh.vertices.astype("<f8") for mesh in (*inputs.shapes, *followed)]
    arrays += [mesh.faces.astype("<i8") for mesh in (*inputs.shapes, *followed)]
    if matching.names:
        # Names of shapes occur only in messages about parts.
        notices = [vars(notice) for notice in matching.notices]
        description |= {"names": list(inputs.names), "parts": list(matching.names), "notices": notices}
        arrays += [faces.astype("<i8") for faces in matching.faces]
    description["sizes"] = [array.shape for array in arrays]
    hashed.update(json.dumps(description, sort_keys=True).encode())
    for array in arrays:
        hashed.update(np.ascontiguousarray(array).data)
    return hashed.digest()
