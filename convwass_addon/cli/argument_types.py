# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Converters for command-line arguments."""

from __future__ import annotations

import math
import re
from argparse import ArgumentTypeError

WORKERS = {"type": int, "metavar": "N", "help": "threads that compute frames (default: one per processor)"}
"""The ``--workers`` option, which several commands share."""


def numbers(text: str) -> list[float]:
    """Parse a list of numbers such as 0.2,0.3,0.5."""
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a list of numbers such as 0.2,0.3,0.5") from None


def frame_range(text: str) -> range:
    """Parse a range of frames such as 0-23, or a single frame."""
    found = re.fullmatch(r"(\d{1,9})(?:-(\d{1,9}))?", text, re.ASCII)
    first, last = (int(number) for number in (found[1], found[2] or found[1])) if found else (1, 0)
    if first > last:
        raise ArgumentTypeError(f"{text!r} is not a range of frames such as 0-23, or a frame such as 7")
    return range(first, last + 1)


def named_numbers(text: str) -> dict[str, float]:
    """Parse named numbers such as A=0.3,B=0.7; names may contain commas."""
    found = re.findall(r"(.+?)=([^=,]+)(?:,|$)", text)
    try:
        named = {name: float(number) for name, number in found}
    except ValueError:
        named = {}
    if not named or ",".join(f"{name}={number}" for name, number in found) != text:
        raise ArgumentTypeError(f"{text!r} is not a list of names and numbers such as A=0.3,B=0.7")
    return named


def place_pair(text: str) -> tuple[str, str]:
    """Parse an edge between two places, such as Head=x."""
    first, equals, second = text.partition("=")
    if not (first and equals and second) or "=" in second:
        raise ArgumentTypeError(f"{text!r} is not a pair of places such as Head=x")
    return first, second


def vertex_pair(text: str) -> tuple[int, int]:
    """Parse a pair of vertices such as 12:40."""
    found = re.fullmatch(r"(\d{1,9}):(\d{1,9})", text, re.ASCII)
    if found is None:
        raise ArgumentTypeError(f"{text!r} is not a pair of vertices such as 12:40")
    return int(found[1]), int(found[2])


def joint_place(text: str) -> tuple[str, tuple[float, float, float]]:
    """Parse a joint and its position, such as Arm.L.tail=0.5,0,1.2."""
    name, _, place = text.rpartition("=")
    try:
        x, y, z = (float(number) for number in place.split(","))
        if not all(map(math.isfinite, (x, y, z))):
            raise ValueError(place)
    except ValueError:
        raise ArgumentTypeError(f"{text!r} is not a joint and a place such as Arm.L.tail=0.5,0,1.2") from None
    if not name:
        raise ArgumentTypeError(f"{text!r} names no joint before the place")
    return name, (x, y, z)


def pinned_joint(text: str) -> tuple[str, tuple[float, float, float] | None]:
    """Parse a joint, optionally with a position: Arm.L.tail or Arm.L.tail=0.5,0,1.2."""
    return joint_place(text) if "=" in text else (text, None)
