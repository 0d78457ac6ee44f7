# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Readable messages from the errors of Blender's operators."""

from __future__ import annotations

from ..sentence import Sentence


def reason(error: Exception) -> str | Sentence:
    """Return the message of an operator's error, without the traceback that it may contain."""
    lines = [line for line in str(error).splitlines() if line.strip() and not line.startswith("Location:")]
    if not lines:
        return Sentence("no reason given")
    return (lines[-1] if "Traceback" in str(error) else lines[0]).removeprefix("Error: ").strip()
