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
    belong: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.bool_]],
) -> list[NDArray[np.int64]]:
    """Merge groups that belong together, smaller ones first."""
    groups = sorted(groups, key=lambda group: _size(_box(boxes, group)))
    spans = np.array([_box(boxes, group) for group in groups])
    result: list[NDArray[np.int64]] = []
    for index, small in enumerate(groups):
        own = spans[index]
        hosts = index + 1 + np.flatnonzero(belong(spans[index + 1 :], own))
        if not len(hosts):
            result.append(small)
            continue
        host = hosts[np.argmin(_distances(spans[hosts], own))]
        groups[host] = np.sort(np.concatenate([groups[host], small]))
        spans[host] = _box(boxes, groups[host])
    return result


def _size(box: NDArray[np.float64]) -> float:
    return float((box[2] - box[0]) * (box[3] - box[1]))


def _distances(boxes: NDArray[np.float64], other: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.abs(boxes[:, :2] + boxes[:, 2:] - other[:2] - other[2:]).sum(axis=1)


def _holds(large: NDArray[np.float64], small: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a ring's box lies within each of others, as for a hole or something inside a hole."""
    return (large[:, :2] <= small[:2]).all(axis=1) & (large[:, 2:] >= small[2:]).all(axis=1)


def _has_dot(large: NDArray[np.float64], small: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Whether a small box is a dot or an accent of each large one, or both are flat strokes above each other."""
    left, bottom, right, top = large.T
    common = np.minimum(right, small[2]) - np.maximum(left, small[0])
    gap = np.maximum(bottom - small[3], small[1] - top)
    width, height = right - left, top - bottom
    own_width, own_height = small[2:] - small[:2]
    higher, narrower = np.maximum(height, own_height), np.minimum(width, own_width)
    lower = (own_height <= _DOT * height) & (gap < _GAP * height)
    # The dot of an i, or a colon: a square above or below another one.
    square = (own_height <= 1.2 * own_width) & (height <= 1.2 * width) & (gap < 4.0 * higher)
    alike = square & (np.abs(height - own_height) < 0.2 * height) & (gap > 0)
    close = np.where(higher <= _FLAT * narrower, gap < 3.0 * higher, lower | alike)
    return (common >= _OVERLAP * narrower) & close
