# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""List user interface texts without a translation, and translations whose text no longer exists.

python3 run.py translations [LANGUAGE ...]

Missing texts are printed as empty entries, ready to be pasted into the ``.po`` file of the language and filled in.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Iterator, Mapping

from convwass_addon import register, translations

from .ui_texts import all_texts


def main(arguments: list[str] | None = None) -> int:
    """Print missing and unused texts of the requested languages; return the exit code."""
    known = translations.languages()
    parser = argparse.ArgumentParser(prog="run.py translations", description=__doc__.splitlines()[0])
    parser.add_argument("languages", nargs="*", metavar="LANGUAGE", help=f"{', '.join(known)} (default: all of them)")
    options = parser.parse_args(arguments)
    if unknown := [language for language in options.languages if language not in known]:
        parser.error(f"there is no {unknown[0]}.po in {translations.FOLDER}; copy the header of another file to begin")
    register()
    texts = all_texts()
    for language in options.languages or known:
        own = {english for _, english in translations.catalog(language)}
        print("\n".join(report(language, texts, own)))
    return 0


def report(language: str, texts: Mapping[str, str], translated: Iterable[str]) -> Iterator[str]:
    """Yield the report on one language.

    Parameters
    ----------
    language : str
        Name of the language.
    texts : mapping
        Every English text with one place where it occurs, or an empty string.
    translated : iterable of str
        The English texts that have a translation.
    """
    translated = set(translated)
    missing = sorted(texts.keys() - translated)
    unused = sorted(translated - texts.keys())
    yield f"# {language}.po: {len(missing)} missing, {len(unused)} unused"
    for english in missing:
        yield ""
        if texts[english]:
            yield f"#: {texts[english]}"
        yield f"msgid {quoted(english)}"
        yield 'msgstr ""'
    if unused:
        yield "\n# Unused:"
        yield from (f"#~ msgid {quoted(english)}" for english in unused)


def quoted(text: str) -> str:
    """Return a text in the quoting of ``.po`` files."""
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", "\\t")
    return f'"{escaped}"'


if __name__ == "__main__":
    sys.exit(main())
