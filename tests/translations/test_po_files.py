# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""``.po`` files are read like by Blender's own tool, and invalid ones are refused with the line."""

from __future__ import annotations

import importlib.util

import pytest

from convwass_addon.translations import FOLDER, catalog, languages
from convwass_addon.translations.po_file import PoError, read_po
from tools.translations import quoted, report

HEADER = 'msgid ""\nmsgstr ""\n"Language: de\\n"\n\n'


@pytest.fixture
def read(tmp_path):
    """Return the entries read from a text."""

    def read(text: str) -> dict[tuple[str, str], str]:
        path = tmp_path / "de.po"
        path.write_text(text, encoding="utf-8")
        return read_po(path)

    return read


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", {}),
        (HEADER, {}),
        ('msgid "a"\nmsgstr "1"', {("*", "a"): "1"}),
        ('msgid "a"\nmsgstr "1"\nmsgid "b"\nmsgstr "2"\n', {("*", "a"): "1", ("*", "b"): "2"}),
        ('msgctxt "Operator"\nmsgid "a"\nmsgstr "1"\n', {("Operator", "a"): "1"}),
        (
            'msgctxt "Operator"\nmsgid "a"\nmsgstr "1"\n\nmsgid "a"\nmsgstr "2"\n',
            {("Operator", "a"): "1", ("*", "a"): "2"},
        ),
        ('msgid ""\n"a "\n"b"\nmsgstr ""\n"1 "\n"2"\n', {("*", "a b"): "1 2"}),
        (r'msgid "\"a\" \\n"' + "\n" + r'msgstr "\t1\n"', {("*", '"a" \\n'): "\t1\n"}),
        ('#: file.py:3\n#, python-format\nmsgid "a"\nmsgstr "1"\n', {("*", "a"): "1"}),
        ('#: file.py:3\n#, python-format, fuzzy\nmsgid "a"\nmsgstr "1"\n\nmsgid "b"\nmsgstr "2"\n', {("*", "b"): "2"}),
        ('#, fuzzy\n#~ msgid "a"\n#~ msgstr "1"\n\nmsgid "b"\nmsgstr "2"\n', {("*", "b"): "2"}),
        ('msgid "a"\nmsgstr ""\n\n# The end.\n', {}),
        ('msgid "é"\nmsgstr "ü „Text“"\n', {("*", "é"): "ü „Text“"}),
    ],
)
def test_valid_entries(read, text, expected):
    assert read(text) == expected


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('msgid "a"\nmsgstr "1"\n\nmsgid "a"\nmsgstr "2"\n', "de.po: 'a' from line 4 on is translated before"),
        ('msgid "a"\nmsgstr "1"\n\n\nmsgid "b"\n', "de.po: no entry can be read from line 5 on"),
        ('msgid "a\nmsgstr "1"\n', "line 1"),
        ('msgid "a"\nmsgstr "1" x\n', "line 1"),
        ('msgid "a"\nmsgid_plural "b"\nmsgstr[0] "1"\n', "line 1"),
        ("a\n", "line 1"),
    ],
)
def test_invalid_entries_are_refused(read, text, message):
    with pytest.raises(PoError, match=message):
        read(text)


@pytest.mark.parametrize("language", languages())
def test_agrees_with_blenders_own_tool(language):
    names = [name for name in ("_bl_i18n_utils", "bl_i18n_utils") if importlib.util.find_spec(name)]
    own_tool = importlib.import_module(f"{names[0]}.utils")
    messages = own_tool.I18nMessages(uid=language, kind="PO", src=str(FOLDER / f"{language}.po"))
    assert messages.parsing_errors == []
    texts = {key: message.msgstr for key, message in messages.msgs.items() if key[1] and message.msgstr}
    assert texts == read_po(FOLDER / f"{language}.po")
    assert texts.items() <= catalog(language).items()


def test_missing_and_unused_texts_are_listed(read):
    lines = list(report("de", {"known": "", 'a "new"\n': "bridge/files.py:3"}, ["known", "gone"]))
    assert lines[0] == "# de.po: 1 missing, 1 unused"
    assert lines[1:5] == ["", "#: bridge/files.py:3", r'msgid "a \"new\"\n"', 'msgstr ""']
    assert lines[-1] == '#~ msgid "gone"'
    assert read("\n".join(lines)) == {}


@pytest.mark.parametrize("text", ["plain", '"', "\\", "a\nb\tc", "\\n"])
def test_a_printed_text_is_read_back(read, text):
    assert read(f"msgid {quoted(text)}\nmsgstr {quoted(text)}") == {("*", text): text}
