# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of finished frames: a bake that was interrupted goes on there, and several machines can share one."""

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
from ...geometry.mesh import TriangleMesh
from ...sentence import Sentence
from ..motions.guides import Guide
from ..whole_paths import whole_path
from .code_digest import code_digest
from .demands import Demand
from .frame_file import DamagedFrameError, StoredFrame, read_frame, write_frame
from .layouts import Blend
from .morph_problem import MorphFrame
from .morph_settings import MorphSettings
from .part_labels import FaceLabels

# What a file keeps of a frame.
_KEPT = tuple(one.name for one in fields(StoredFrame))


class FrameCache:
    """A folder with one file per frame, named by a hash of all that the frame depends on.

    Files are replaced as a whole, so machines that write the same frame at the same time do no harm. Nothing is ever
    deleted: the folder may be thrown away when the morph is done.

    Parameters
    ----------
    folder : Path
        Made where it is missing.

    Attributes
    ----------
    notices : list of Sentence
        What the user should know: files that could not be used.
    reused : int
        Frames that have been read instead of being computed.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
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

    def of(
        self,
        shapes: Sequence[TriangleMesh],
        names: Sequence[str],
        labels: Sequence[FaceLabels] | None,
        settings: MorphSettings,
        guides: Sequence[Guide] = (),
    ) -> BakeCache:
        """Return the part of the cache that belongs to one bake; for the parameters see :func:`.morph.morph`."""
        return BakeCache(self, _bake_digest(shapes, names, labels, settings, guides))

    def missed(self, error: OSError) -> None:
        """Hear that a frame could not be written.

        Raises
        ------
        ConvwassError
            Always: whoever names a folder wants the frames there.
        """
        raise ConvwassError(
            "A frame could not be written to {folder} ({reason}); make room there, or choose another folder.",
            folder=str(self.folder),
            reason=error.strerror or type(error).__name__,
        ) from error


class SpareFrameCache(FrameCache):
    """A folder of frames for the case that a bake is interrupted, which nobody has asked for.

    It never grows beyond a size for long: the oldest frames are dropped. A bake goes on where it cannot be written to.

    Parameters
    ----------
    folder : Path
        Made where it is missing; everything in it that is a frame belongs to the cache.
    most_bytes : int
        How large it may be when a bake begins.

    Raises
    ------
    InputError
        The folder cannot be made or written to.
    """

    keeps_potentials = False

    def __init__(self, folder: Path, most_bytes: int) -> None:
        super().__init__(folder)
        _drop_oldest(self.folder, most_bytes)

    def missed(self, error: OSError) -> None:
        """Note that a frame could not be written, once."""
        notice = Sentence(
            "Frames are not kept in {folder} for the case of an interruption ({reason}).",
            {"folder": str(self.folder), "reason": error.strerror or type(error).__name__},
        )
        if notice not in self.notices:
            self.notices.append(notice)


def _drop_oldest(folder: Path, most_bytes: int) -> None:
    """Delete the frames that were written first until the others fit; what another program holds open stays."""
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
        What tells the bake from all others.
    """

    def __init__(self, cache: FrameCache, digest: bytes) -> None:
        self._cache = cache
        self._digest = digest

    @property
    def keeps_potentials(self) -> bool:
        """Whether frames are to bring their potentials along."""
        return self._cache.keeps_potentials

    def paths(self, run: Sequence[Blend]) -> list[Path]:
        """Return the files of a run's frames, which may or may not be there."""
        return [self._cache.folder / f"{key}.frame" for key in self._keys(run)]

    def holds(self, run: Sequence[Blend]) -> bool:
        """Whether all frames of a run are there and sound; those that are not are put among the notices."""
        keys = self._keys(run)
        files = zip(self.paths(run), keys, run, strict=True)
        return all(self._read(path, key, blend) is not None for path, key, blend in files)

    def load(self, run: Sequence[Blend]) -> list[MorphFrame]:
        """Return the frames of a run that the cache holds.

        Raises
        ------
        ConvwassError
            A file has been changed or removed since.
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
        """Put all frames of a run into the cache.

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
            # Windows replaces no file that another machine is reading, which then is the same frame.
            if self._read(path, key, frame.blend) is None:
                self._cache.missed(error)

    def load_again(self, run: Sequence[Blend], blend: Blend, demand: Demand) -> MorphFrame | None:
        """Return a blend of a run that was made once more as demanded, if that is there."""
        stored = self._read(*self._again(run, blend, demand), blend)
        if stored is None:
            return None
        self._cache.reused += 1
        return MorphFrame(blend=blend, **vars(stored))

    def save_again(self, run: Sequence[Blend], frame: MorphFrame, demand: Demand) -> None:
        """Put one into the cache; raises ConvwassError where a file cannot be written."""
        self._write(*self._again(run, frame.blend, demand), frame)

    def _again(self, run: Sequence[Blend], blend: Blend, demand: Demand) -> tuple[Path, str]:
        """Return the file and the key of a blend that is made once more."""
        own = self._keys(run)[run.index(blend)]
        key = hashlib.sha256(f"{own} {demand.digest()}".encode()).hexdigest()
        return self._cache.folder / f"{key}.frame", key

    def _keys(self, run: Sequence[Blend]) -> list[str]:
        """Name every frame of a run; it depends on the blends before it, from which its solve was started."""
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
    """Whether a frame is one of moving inputs, which brings no potentials; the record may be of any file."""
    motion = record.get("motion")
    return isinstance(motion, Mapping) and motion.get("kind") in ("guided", "combined", "warp")


def _bake_digest(
    shapes: Sequence[TriangleMesh],
    names: Sequence[str],
    labels: Sequence[FaceLabels] | None,
    settings: MorphSettings,
    guides: Sequence[Guide],
) -> bytes:
    """SHA-256 of all that decides every frame of a bake: the code, the settings, the shapes and their parts."""
    hashed = hashlib.sha256(code_digest())
    description = {"settings": settings.as_dict(), "shapes": len(shapes)}
    description["guides"] = [sorted(guide.items()) for guide in guides]
    arrays = [array for shape in shapes for array in (shape.vertices.astype("<f8"), shape.faces.astype("<i8"))]
    if labels is not None:
        # Only what is said about parts names the shapes.
        description |= {"names": list(names), "parts": [label.names for label in labels]}
        arrays += [label.faces.astype("<i8") for label in labels]
    description["sizes"] = [array.shape for array in arrays]
    hashed.update(json.dumps(description, sort_keys=True).encode())
    for array in arrays:
        hashed.update(np.ascontiguousarray(array).data)
    return hashed.digest()
