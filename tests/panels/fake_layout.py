# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""A layout that records what is drawn into it, and refuses what Blender would not draw."""

from __future__ import annotations

from types import SimpleNamespace

import bpy

_BLOCKS = ("row", "column", "box", "split", "grid_flow")
_ICONS = set(bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items.keys())


class FakeLayout:
    """A fake of bpy.types.UILayout; nested layouts share its list of what has been drawn."""

    def __init__(self, drawn=None) -> None:
        self.drawn = [] if drawn is None else drawn
        for name in _BLOCKS:
            setattr(self, name, self._block)

    def _block(self, heading="", **_options):
        self._text(heading)
        return FakeLayout(self.drawn)

    def _text(self, text) -> None:
        if text:
            self.drawn.append(("text", text))

    def label(self, text="", icon="NONE", translate=True):
        assert icon in _ICONS
        self.drawn.append(("label", text))

    def prop(self, data, name, text=None, icon="NONE", **_options):
        assert icon in _ICONS
        # The inputs of a modifier were custom properties until Blender 5.2.
        assert name in data.bl_rna.properties or data.path_resolve(name) is not None, name
        self._text(text)
        self.drawn.append(("prop", name))

    def operator(self, name, text=None, icon="NONE", **_options):
        assert icon in _ICONS
        module, own = name.split(".")
        assert hasattr(bpy.types, f"{module.upper()}_OT_{own}"), name
        self._text(text)
        self.drawn.append(("operator", name))
        properties = getattr(getattr(bpy.ops, module), own).get_rna_type().properties
        return _Arguments(set(properties.keys()))

    def operator_menu_enum(self, name, prop, text=None, icon="NONE"):
        arguments = self.operator(name, text, icon)
        assert prop in arguments.names

    def prop_search(self, data, name, search_data, search_property, text=None, icon="NONE", **_options):
        assert search_property in search_data.bl_rna.properties
        self.prop(data, name, text, icon)

    def progress(self, factor=0.0, text="", **_options):
        assert 0.0 <= factor <= 1.0
        self.drawn.append(("progress", text))

    def popover(self, panel, icon="NONE", **_options):
        assert hasattr(bpy.types, panel)
        self.drawn.append(("popover", panel))

    def template_list(self, kind, _name, data, collection, active_data, active, **_options):
        draw = getattr(bpy.types, kind).draw_item
        for index, item in enumerate(getattr(data, collection)):
            own = SimpleNamespace(layout=self)
            draw(own, bpy.context, self, data, item, "NONE", active_data, active, index)

    def separator(self, **_options):
        pass


class _Arguments:
    """Accepts only the arguments that an operator has."""

    def __init__(self, names) -> None:
        object.__setattr__(self, "names", names)

    def __setattr__(self, name, value) -> None:
        assert name in self.names, name
