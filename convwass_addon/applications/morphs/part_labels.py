# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which parts shapes have, and which of them belong together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from ...sentence import Sentence

NOTICES: dict[str, str] = {
    "NOT_ON_ALL": "{name} is not on every shape and travels with the rest.",
    "TOO_SMALL": "{name} is too small at this resolution and travels with the rest.",
    "NO_REST": "Too little is in no part on some of the shapes; it travels with {name}.",
}
"""A template for every kind of notice."""


@dataclass(frozen=True)
class FaceLabels:
    """To which part every triangle of a shape belongs.

    Attributes
    ----------
    names : tuple of str
        Parts of the shape, each once.
    faces : (m,) int64
        Indices in `names`; -1 in no part.
    """

    names: tuple[str, ...]
    faces: NDArray[np.int64]

    def renumbered(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Return indices in other names, (m,); ``len(names)`` for what has none of them."""
        places = {name: index for index, name in enumerate(names)}
        table = np.array([*(places.get(name, len(names)) for name in self.names), len(names)])
        return table[self.faces]


@dataclass(frozen=True)
class PartNotice:
    """One thing that the user should know about the parts.

    Attributes
    ----------
    kind : str
        A key of `NOTICES`.
    name : str
        Of the part that it is about.
    """

    kind: str
    name: str

    @property
    def sentence(self) -> Sentence:
        """What to tell."""
        return Sentence(NOTICES[self.kind], {"name": self.name})

    def __str__(self) -> str:
        return str(self.sentence)


@dataclass(frozen=True)
class Matching:
    """Which triangles of all shapes belong together.

    Attributes
    ----------
    names : tuple of str
        Parts that all shapes have.
    faces : tuple of (m,) int64
        For every shape the part of every triangle; ``len(names)`` is the rest.
    notices : tuple of PartNotice
        What the user should know about it.
    """

    names: tuple[str, ...]
    faces: tuple[NDArray[np.int64], ...]
    notices: tuple[PartNotice, ...] = ()

    @property
    def count(self) -> int:
        """Number of parts, with the rest."""
        return len(self.names) + 1


def part_notices(record: Mapping[str, object]) -> list[PartNotice]:
    """Return the notices in the record of a frame, which may come from a file; what is none is left out."""
    found = record.get("notices")
    entries = found if isinstance(found, (list, tuple)) else ()
    return [
        PartNotice(*entry)
        for entry in entries
        if isinstance(entry, (list, tuple))
        and len(entry) == 2
        and all(isinstance(word, str) for word in entry)
        and entry[0] in NOTICES
    ]


def unparted(count: int) -> Matching:
    """All of `count` shapes is the rest: one part."""
    return Matching((), tuple(np.zeros(0, np.int64) for _ in range(count)))


def matched(labels: Sequence[FaceLabels], shape_names: Sequence[str]) -> Matching:
    """Match parts of the same name.

    Parameters
    ----------
    labels : sequence of FaceLabels
        One per shape.
    shape_names : sequence of str
        What messages call the shapes.

    Raises
    ------
    InputError
        No name is on all shapes.
    """
    found = [{label.names[i] for i in np.unique(label.faces) if i >= 0} for label in labels]
    common = set.intersection(*found)
    if not common:
        raise InputError(
            "No part is on all shapes under the same name ({has}). Rename them alike, or turn parts off.",
            has=reduce(_listed, map(_parts_of, shape_names, found)),
        )
    notices = tuple(PartNotice("NOT_ON_ALL", name) for name in sorted(set.union(*found) - common))
    names = tuple(name for name in labels[0].names if name in common)
    return Matching(names, tuple(label.renumbered(names) for label in labels), notices)


def _parts_of(shape: str, parts: set[str]) -> Sentence:
    if not parts:
        return Sentence("{shape} has none", {"shape": shape})
    return Sentence("{shape} has {parts}", {"shape": shape, "parts": ", ".join(sorted(parts))})


def _listed(first: Sentence, second: Sentence) -> Sentence:
    return Sentence("{first}; {second}", {"first": first, "second": second})
