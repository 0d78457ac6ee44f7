# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Letters of words in reading order, and the correspondence of letters between words."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...errors import InputError
from .flat_shapes import FlatImage, FlatInput, FlatShape

# A dot or accent has at most the first fraction of its letter's height, and at most the second as its distance. Two
# flat strokes above each other, as in an equals sign, also belong together.
_DOT, _GAP, _FLAT = 0.45, 0.6, 0.4
# Fraction of its width, or of its height in a line, in which a letter overlaps another.
_OVERLAP = 0.5


def matched_letters(shapes: Sequence[FlatInput], names: Sequence[str]) -> list[list[NDArray[np.int64]]]:
    """Return the indices of the rings of every part of every shape: letters in reading order.

    If the numbers of letters differ, neighboring letters of the longer words are combined to match a letter of the
    shortest word, which splits on its way.

    Raises
    ------
    InputError
        A shape has no letters.
    """
    found = []
    for shape, name in zip(shapes, names, strict=True):
        if isinstance(shape, FlatImage):
            raise InputError("'{name}' is an image and has no letters; let it travel as one mass.", name=name)
        if not shape.rings:
            raise InputError("'{name}' has no closed curve, so there is nothing to move.", name=name)
        found.append(letters_of(shape))
    count = min(map(len, found))
    return [_grouped(letters, count) for letters in found]


def _grouped(letters: list[NDArray[np.int64]], count: int) -> list[NDArray[np.int64]]:
    """Combine neighbors as evenly as possible until there are `count` groups."""
    bounds = np.rint(np.linspace(0, len(letters), count + 1)).astype(int)
    return [np.concatenate(letters[low:high]) for low, high in pairwise(bounds)]


def letters_of(shape: FlatShape) -> list[NDArray[np.int64]]:
    """Return the indices of the rings of every letter in reading order: lines from the top, letters from the left."""
    if shape.letters is not None:
        numbers = np.array(shape.letters)
        return [np.flatnonzero(numbers == letter) for letter in np.unique(numbers)]
    boxes = np.array([[*ring.min(axis=0), *ring.max(axis=0)] for ring in shape.rings])
    groups = _merged(boxes, [np.array([i]) for i in range(len(boxes))], _holds)
    groups = _merged(boxes, groups, _has_dot)
    lines: list[list[int]] = []
    spans = [_box(boxes, group) for group in groups]
    for index in sorted(range(len(groups)), key=lambda i: spans[i][1] - spans[i][3]):
        own = spans[index]
        for line in lines:
            first = spans[line[0]]
            common = min(own[3], first[3]) - max(own[1], first[1])
            if common >= _OVERLAP * (own[3] - own[1]):
                line.append(index)
                break
        else:
            lines.append([index])
    lines.sort(key=lambda line: -(spans[line[0]][1] + spans[line[0]][3]))
    return [groups[i] for line in lines for i in sorted(line, key=lambda i: spans[i][0] + spans[i][2])]


def _box(boxes: NDArray[np.float64], group: NDArray[np.int64]) -> NDArray[np.float64]:
    return np.concatenate([boxes[group, :2].min(axis=0), boxes[group, 2:].max(axis=0)])


def _merged(
    boxes: NDArray[np.float64],
    groups: list[NDArray[np.int64]],
    belong: Callable[[NDArray[np.float64], NDArray[np.float64]], bool],
) -> list[NDArray[np.int64]]:
    """Merge groups that belong together, smaller ones first."""
    groups = sorted(groups, key=lambda group: _size(_box(boxes, group)))
    result: list[NDArray[np.int64]] = []
    while groups:
        small = groups.pop(0)
        own = _box(boxes, small)
        hosts = [i for i, group in enumerate(groups) if belong(_box(boxes, group), own)]
        if not hosts:
            result.append(small)
            continue
        host = min(hosts, key=lambda i: _distance(_box(boxes, groups[i]), own))
        groups[host] = np.sort(np.concatenate([groups[host], small]))
    return result


def _size(box: NDArray[np.float64]) -> float:
    return float((box[2] - box[0]) * (box[3] - box[1]))


def _distance(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    return float(np.abs(one[:2] + one[2:] - other[:2] - other[2:]).sum())


def _holds(large: NDArray[np.float64], small: NDArray[np.float64]) -> bool:
    """Whether a ring's box lies within another's, as for a hole or something inside a hole."""
    return bool((large[:2] <= small[:2]).all() and (large[2:] >= small[2:]).all())


def _has_dot(large: NDArray[np.float64], small: NDArray[np.float64]) -> bool:
    """Whether a small box is a dot or an accent of a large one, or both are flat strokes above each other."""
    common = min(large[2], small[2]) - max(large[0], small[0])
    gap = max(large[1] - small[3], small[1] - large[3])
    width, height = large[2:] - large[:2]
    own_width, own_height = small[2:] - small[:2]
    if common < _OVERLAP * min(width, own_width):
        return False
    if max(height, own_height) <= _FLAT * min(width, own_width):
        return bool(gap < 3.0 * max(height, own_height))
    lower = own_height <= _DOT * height and gap < _GAP * height
    # The dot of an i, or a colon: a square above or below another one.
    square = own_height <= 1.2 * own_width and height <= 1.2 * width and gap < 4.0 * max(height, own_height)
    return bool(lower or (square and abs(height - own_height) < 0.2 * height and gap > 0))
