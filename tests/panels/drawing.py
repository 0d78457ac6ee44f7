# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draw panels into recording layouts, and find things in what they have drawn."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace

import bpy

from .fake_layout import FakeLayout


def panels(start="CONVWASS_PT_"):
    names = sorted(name for name in dir(bpy.types) if name.startswith(start))
    return [getattr(bpy.types, name) for name in names if name != "CONVWASS_PT_solver_presets"]


def draw(panel, context=None):
    """Return what a panel draws; nothing if it is not shown."""
    context = context or bpy.context
    if hasattr(panel, "poll") and not panel.poll(context):
        return []
    layout = FakeLayout()
    shown = SimpleNamespace(layout=layout)
    for name in ("draw_settings", "draw_tools"):
        if hasattr(panel, name):
            setattr(shown, name, partial(getattr(panel, name), shown))
    if hasattr(panel, "draw_header_preset"):
        panel.draw_header_preset(shown, context)
    panel.draw(shown, context)
    return layout.drawn


def named(drawn, kind):
    """Return the names of everything of one kind, such as "prop" or "operator"."""
    return {name for own, name in drawn if own == kind}


def texts(drawn):
    """Return all texts in order; long sentences consist of several."""
    return " ".join(text for kind, text in drawn if kind in ("label", "text"))


def forbid(monkeypatch, *places):
    """Make functions of the add-on fail that drawing must not call."""

    def refuse(*_arguments, **_options):
        raise AssertionError("drawing asked for work")

    for place in places:
        monkeypatch.setattr(f"convwass_addon.{place}", refuse)
