# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Convert numpydoc docstrings and signatures to Markdown."""

from __future__ import annotations

import dataclasses
import inspect
import re
from collections.abc import Callable
from dataclasses import dataclass

_ROLE = re.compile(r":\w+:`~?\.?([^`]+)`")
_CODE = re.compile(r"(`[^`]+`)")
_MARKUP = re.compile(r"([*<\[\]])")
# Page width; longer signatures get one line per parameter.
_WIDTH = 100


@dataclass(frozen=True)
class Section:
    """A titled part of a docstring.

    Attributes
    ----------
    title : str
        For example "Parameters".
    entries : tuple of (str, str)
        Unindented line (a name with its type, or a type) and its indented description.
    """

    title: str
    entries: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Docstring:
    """A parsed docstring.

    Attributes
    ----------
    text : str
        Everything before the first section: summary and further paragraphs.
    sections : tuple of Section
        In order of appearance.
    """

    text: str
    sections: tuple[Section, ...] = ()

    @property
    def summary(self) -> str:
        """The first paragraph, on one line."""
        return " ".join(self.text.partition("\n\n")[0].split())


def parsed(docstring: str) -> Docstring:
    """Parse a docstring; a section begins with a title underlined with hyphens."""
    lines = inspect.cleandoc(docstring).splitlines()
    rules = [place for place, line in enumerate(lines) if place and re.fullmatch(r"-{3,}", line)]
    starts = [place - 1 for place in rules]
    ends = [*starts[1:], len(lines)][: len(starts)]
    text = "\n".join(lines[: starts[0]] if starts else lines).strip()
    sections = [
        Section(lines[start], _entries(lines[start + 2 : end])) for start, end in zip(starts, ends, strict=True)
    ]
    return Docstring(text, tuple(sections))


def _entries(lines: list[str]) -> tuple[tuple[str, str], ...]:
    found: list[tuple[str, list[str]]] = []
    for line in lines:
        if line and not line.startswith(" "):
            found.append((line.strip(), []))
        elif found:
            found[-1][1].append(line.strip())
    return tuple((head, " ".join(" ".join(body).split())) for head, body in found)


def plain(text: str) -> str:
    """Return a docstring's text as Markdown: roles and double backticks become code."""
    text = _ROLE.sub(lambda match: f"`{match[1].rpartition('.')[2]}`", text).replace("``", "`")
    parts = _CODE.split(text)
    return "".join(part if part.startswith("`") else _MARKUP.sub(r"\\\1", part) for part in parts)


def markdown(docstring: str) -> list[str]:
    """Return the lines of a docstring as Markdown, with sections as lists."""
    found = parsed(docstring)
    lines = [_paragraphs(found.text)]
    for section in found.sections:
        lines += ["", f"*{section.title}*", ""]
        lines += [_entry(head, body) for head, body in section.entries]
    return lines


def _paragraphs(text: str) -> str:
    # Indented blocks are formulas or examples, which Markdown shows verbatim.
    blocks = re.split(r"\n{2,}", text)
    return "\n\n".join(block if block.startswith("    ") else plain(block) for block in blocks)


def _entry(head: str, body: str) -> str:
    name, colon, kind = head.partition(" : ")
    # A long unnamed entry is a sentence about the return value.
    title = f"`{name}`" if re.fullmatch(r"[\w.*, ()\[\]]+", name) else plain(name)
    typed = f" ({plain(kind)})" if colon else ""
    return f"- {title}{typed}" + (f": {plain(body)}" if body else "")


def signature(name: str, function: Callable[..., object], *, is_method: bool = False) -> str:
    """Return a call with its parameters and defaults; types are in the docstring."""
    parameters = list(inspect.signature(function).parameters.values())[1 if is_method else 0 :]
    words, starred = [], False
    for parameter in parameters:
        if parameter.kind is parameter.KEYWORD_ONLY and not starred:
            words.append("*")
        starred |= parameter.kind in (parameter.KEYWORD_ONLY, parameter.VAR_POSITIONAL)
        words.append(_word(parameter))
    line = f"{name}({', '.join(words)})"
    return line if len(line) <= _WIDTH else f"{name}(\n    " + ",\n    ".join(words) + ",\n)"


def _word(parameter: inspect.Parameter) -> str:
    prefix = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(parameter.kind, "")
    if parameter.default is parameter.empty:
        return prefix + parameter.name
    shown = repr(parameter.default)
    # Uninformative representations: objects and factories of dataclasses.
    return f"{parameter.name}=…" if "<" in shown else f"{parameter.name}={shown}"


def described(name: str, thing: object) -> list[str]:
    """Return the Markdown of a function or class: signature, docstring and methods."""
    lines = []
    if not inspect.isclass(thing) or _is_made_by_users(thing):
        lines += ["```text", signature(name, thing), "```", ""]
    lines += markdown(inspect.getdoc(thing) or "")
    if inspect.isclass(thing):
        own = [_member(key, value) for key, value in vars(thing).items() if not key.startswith("_")]
        told = [line for line in own if line]
        lines += ["", "*Members*", "", *told] if told else []
    return lines


def _is_made_by_users(kind: type) -> bool:
    """Tell classes that users construct from protocols, errors and returned records."""
    if getattr(kind, "_is_protocol", False) or issubclass(kind, Exception):
        return False
    if not dataclasses.is_dataclass(kind):
        return "__init__" in vars(kind)
    return kind.__name__.endswith(("Settings", "Mesh", "Side", "Picture", "Blend", "Graph", "Shape", "Image"))


def _member(name: str, value: object) -> str | None:
    """Return a line about a method or property; None for plain values."""
    if isinstance(value, classmethod | staticmethod):
        call = signature(name, value.__func__, is_method=isinstance(value, classmethod))
    elif inspect.isfunction(value):
        call = signature(name, value, is_method=True)
    elif isinstance(value, property) or hasattr(value, "attrname"):
        call = name
    else:
        return None
    doc = inspect.getdoc(value)
    return f"- `{' '.join(call.split())}`: {plain(parsed(doc).summary)}" if doc else None
