# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Parts of shapes, and which of them correspond."""

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
    """The part of every triangle of a shape.

    Attributes
    ----------
    names : tuple of str
        Names of the parts, without duplicates.
    faces : (m,) int64
        Indices in `names`; -1 for triangles in no part.
    """

    names: tuple[str, ...]
    faces: NDArray[np.int64]

    def renumbered(self, names: Sequence[str]) -> NDArray[np.int64]:
        """Return indices in other names, (m,); ``len(names)`` for parts not among them."""
        places = {name: index for index, name in enumerate(names)}
        table = np.array([*(places.get(name, len(names)) for name in self.names), len(names)])
        return table[self.faces]


@dataclass(frozen=True)
class PartNotice:
    """A message to the user about the parts.

    Attributes
    ----------
    kind : str
        A key of `NOTICES`.
    name : str
        The part that it is about.
    """

    kind: str
    name: str

    @property
    def sentence(self) -> Sentence:
        """The message."""
        return Sentence(NOTICES[self.kind], {"name": self.name})

    def __str__(self) -> str:
        return str(self.sentence)


@dataclass(frozen=True)
class Matching:
    """The corresponding parts of all shapes.

    Attributes
    ----------
    names : tuple of str
        Parts that all shapes have.
    faces : tuple of (m,) int64
        For every shape the part of every triangle; ``len(names)`` is the rest.
    notices : tuple of PartNotice
        Messages to the user.
    """

    names: tuple[str, ...]
    faces: tuple[NDArray[np.int64], ...]
    notices: tuple[PartNotice, ...] = ()

    @property
    def count(self) -> int:
        """Number of parts, including the rest."""
        return len(self.names) + 1


def part_notices(record: Mapping[str, object]) -> list[PartNotice]:
    """Return the notices in the record of a frame, which may come from a file; invalid ones are left out."""
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
    """Return a matching in which each of `count` shapes is one part, the rest."""
    return Matching((), tuple(np.zeros(0, np.int64) for _ in range(count)))


def matching_of(labels: Sequence[FaceLabels] | None, shape_names: Sequence[str]) -> Matching:
    """Match the parts of shapes as :func:`matched` does; without labels, each shape is one part."""
    return unparted(len(shape_names)) if labels is None else matched(labels, shape_names)


def matched(labels: Sequence[FaceLabels], shape_names: Sequence[str]) -> Matching:
    """Match parts of the same name.

    Parameters
    ----------
    labels : sequence of FaceLabels
        One per shape.
    shape_names : sequence of str
        Names of the shapes, for messages.

    Raises
    ------
    InputError
        No part name is on all shapes.
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
