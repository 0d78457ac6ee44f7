# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The API pages are up to date, complete, and correctly generated from docstrings."""

from __future__ import annotations

import importlib
import re

import bpy
import pytest

from convwass_addon import transport
from convwass_addon.cli import program
from tools import api_pages
from tools.api_entries import APPLICATIONS
from tools.docstrings import parsed, plain, signature

_ATTRIBUTES = re.compile(r'^    Attributes\n    -+\n(.*?)(?:\n\n|""")', re.MULTILINE | re.DOTALL)


@pytest.fixture(scope="module")
def pages(registered_addon):
    return api_pages.pages_of_registered()


def test_pages_are_up_to_date(pages, project):
    stale = [name for name, text in pages.items() if (project / name).read_text(encoding="utf-8") != text]
    assert not stale, f"{stale}: run python3 run.py api"


def test_everything_public_is_included(pages):
    headings = set(re.findall(r"^## (?:class )?(.+)$", pages["docs/api/transport.md"], re.MULTILINE))
    assert headings == set(transport.__all__)
    made = set(re.findall(r"^## bpy\.ops\.convwass\.(\w+)$", pages["docs/api/operators.md"], re.MULTILINE))
    # Called only by Blender's own preset menu.
    assert made == set(dir(bpy.ops.convwass)) - {"add_solver_preset"}
    commands = re.findall(r"^## (\w+)$", pages["docs/api/command_line.md"], re.MULTILINE)
    assert commands == [command.name for command in program.COMMANDS]


def test_every_application_has_its_entries(project):
    packages = {path.parent.name for path in (project / "convwass_addon/applications").glob("*/__init__.py")}
    assert packages == set(APPLICATIONS)


def test_every_entry_has_a_summary(pages):
    for name, text in pages.items():
        empty = re.findall(r"^#+ (.+)\n+(?:`from [^`]+`\n+)?(?:```text\n[^`]*```\n+)?(?=#|\Z)", text, re.MULTILINE)
        assert not empty, f"{name}: {empty}"


def test_imports_on_the_pages_work(pages):
    found = re.findall(r"^`from (\S+) import (\w+)`$", pages["docs/api/applications.md"], re.MULTILINE)
    assert len(found) > 40
    for module, name in found:
        assert hasattr(importlib.import_module(module), name)


def test_docstrings_are_parsed():
    found = parsed("""Do it.

    More.

    Parameters
    ----------
    a, b : int
        First,
        second.

    Returns
    -------
    float
        A number.
    """)
    assert found.text == "Do it.\n\nMore."
    assert found.summary == "Do it."
    assert [(section.title, section.entries) for section in found.sections] == [
        ("Parameters", (("a, b : int", "First, second."),)),
        ("Returns", (("float", "A number."),)),
    ]


def test_attributes_of_records_have_names_and_types(project):
    """Also of private classes, which have no page."""
    wrong = []
    for path in sorted((project / "convwass_addon").rglob("*.py")):
        for section in _ATTRIBUTES.findall(path.read_text(encoding="utf-8")):
            heads = re.findall(r"^    (\S.*)$", section, re.MULTILINE)
            wrong += [(path.name, head) for head in heads if not re.fullmatch(r"[\w*, ]+( : .+)?", head)]
    assert not wrong


def test_text_becomes_markdown():
    found = plain("As :func:`.other.thing` of ``a * b``, a * b and mus[0]")
    assert found == r"As `thing` of `a * b`, a \* b and mus\[0\]"


def test_signatures_have_defaults_and_no_types():
    def thing(a: int, *, b: float = 1.5, c: object = object()):
        """Nothing."""

    assert signature("thing", thing) == "thing(a, *, b=1.5, c=…)"
