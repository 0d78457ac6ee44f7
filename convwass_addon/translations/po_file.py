# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Read gettext files (``.po``), as far as Blender supports the format."""

from __future__ import annotations

import re
from pathlib import Path

DEFAULT_CONTEXT = "*"
"""Blender's default context, for entries without ``msgctxt``."""

_STRING = r'"[^"\\\n]*(?:\\.[^"\\\n]*)*"'
_STRINGS = rf"({_STRING}(?:\n{_STRING})*)"  # a string may continue on the following lines
_COMMENTS = r"((?:#.*\n|\n)*)"
_ENTRY = re.compile(rf"{_COMMENTS}(?:msgctxt {_STRINGS}\n)?msgid {_STRINGS}\nmsgstr {_STRINGS}\n")
_END = re.compile(rf"{_COMMENTS}\Z")
_FUZZY = re.compile(r"^#,.*\bfuzzy\b", re.MULTILINE)
_BLANK = re.compile(r"\n*")
_ESCAPE = re.compile(r"\\(.)")
_ESCAPED = {"n": "\n", "t": "\t"}


class PoError(ValueError):
    """A ``.po`` file is invalid; the message contains file and line."""


def read_po(path: Path) -> dict[tuple[str, str], str]:
    """Return the translations in a ``.po`` file.

    The header and fuzzy, commented or untranslated entries are left out. Plural forms are not supported by Blender and
    are refused; write a separate message for each number instead.

    Parameters
    ----------
    path : Path
        A file in UTF-8.

    Returns
    -------
    dict
        Translations by ``(context, English text)``, as for `bpy.app.translations.register`. The context is
        `DEFAULT_CONTEXT` if the entry has none.

    Raises
    ------
    PoError
        The file contains invalid entries, or a text is translated twice.
    """
    text = path.read_text(encoding="utf-8") + "\n"
    found: dict[tuple[str, str], str] = {}
    position = 0
    while not _END.match(text, position):
        entry = _ENTRY.match(text, position)
        if entry is None:
            raise PoError(f"{path.name}: no entry can be read from line {_line(text, position)} on")
        comments, context, english, own = entry.groups()
        key = _joined(context) if context else DEFAULT_CONTEXT, _joined(english)
        if key in found:
            raise PoError(f"{path.name}: {key[1]!r} from line {_line(text, position)} on is translated before")
        # A comment above a blank line does not belong to the next entry.
        is_fuzzy = "#," in comments and _FUZZY.search(comments.rpartition("\n\n")[2])
        if key[1] and own != '""' and not is_fuzzy:
            found[key] = _joined(own)
        position = entry.end()
    return found


def _line(text: str, position: int) -> int:
    """Return the number of the first non-empty line from a position."""
    return text.count("\n", 0, position) + len(_BLANK.match(text, position)[0]) + 1


def _joined(strings: str) -> str:
    """Return the joined text of the strings of a keyword, without quotes and escapes."""
    if "\n" in strings:
        strings = '"' + "".join(line[1:-1] for line in strings.split("\n")) + '"'
    text = strings[1:-1]
    return _ESCAPE.sub(lambda match: _ESCAPED.get(match[1], match[1]), text) if "\\" in text else text
