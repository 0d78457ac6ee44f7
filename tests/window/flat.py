# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""First steps with flat shapes: type two words, morph them letter by letter, draw them, and make some mistakes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import bpy

if TYPE_CHECKING:
    from inside import Window

# The typed words, and the color of every letter.
_WORDS = {"SUN": ("d8a020", "d86020", "c03028"), "ICE": ("2050b0", "3090c8", "207070")}
_FRAMES = 8


def flat(window: Window) -> Iterator[float]:
    """Do everything in order; failures raise AssertionError."""
    yield from _types(window)
    yield from _bakes(window)
    yield from _draws(window)
    yield from _goes_wrong(window)


def _types(window: Window) -> Iterator[float]:
    yield from window.empty_scene()
    for number, word in enumerate(_WORDS):
        with window.override():
            bpy.ops.object.select_all(action="DESELECT")
            bpy.ops.object.text_add(location=(0.0, -1.2 * number, 0.0))
            bpy.ops.view3d.view_axis(type="TOP")
            bpy.ops.view3d.view_all()
        yield from window.into_view()
        yield from window.key("Tab")
        yield from window.key(*["BackSpace"] * len("Text"))
        yield from window.key(*(f"shift+{sign.lower()}" for sign in word))
        yield from window.key("Tab")
        yield 0.5
        obj = bpy.context.view_layer.objects.active
        assert obj.data.body == word, f"typing {word} made {obj.data.body!r}"
        obj.name = word
    window.say("two words are typed with keys")


def _color(obj: bpy.types.Object, colors: tuple[str, ...]) -> None:
    """Give every letter of a text a material."""
    for number, code in enumerate(colors):
        material = bpy.data.materials.new(f"{obj.name} {number}")
        if material.node_tree is None:
            material.use_nodes = True
        channels = [(int(code[place : place + 2], 16) / 255) ** 2.2 for place in (0, 2, 4)]
        material.diffuse_color = (*channels, 1.0)
        material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*channels, 1.0)
        obj.data.materials.append(material)
        obj.data.body_format[number].material_index = number


def _choose(window: Window) -> Iterator[float]:
    """Select everything with a key."""
    for word in _WORDS:
        bpy.data.objects[word].hide_set(False)
    # Outside the area that a message covers.
    yield from window.into_view(0.3, 0.95)
    yield 1.0
    yield from window.into_view(0.3, 0.9)
    yield from window.key("a")
    yield 0.5


def _morphs() -> list[bpy.types.Collection]:
    return [collection for collection in bpy.data.collections if collection.name.startswith("Morph")]


def _baked(window: Window, count: int) -> Iterator[float]:
    """Press the button, and wait until there are this many morphs."""
    yield from window.press("convwass.bake_morph")
    yield from window.wait(lambda: len(_morphs()) == count and not window.progress.running, 120, "the words are baked")
    yield 1.0


def _bakes(window: Window) -> Iterator[float]:
    settings = bpy.context.scene.convwass_morph
    settings.frames, settings.words, settings.flat_resolution = _FRAMES, "LETTERS", 256
    # Maps of three letters take a minute, and several while the window is drawn by software.
    settings.motion = "TRANSPORT"
    for word, colors in _WORDS.items():
        _color(bpy.data.objects[word], colors)
    yield from window.open_tab("Convwass")
    yield from window.open_panel("CONVWASS_PT_morph")
    yield from _choose(window)
    yield from window.picture("50 two words")
    yield from _baked(window, 1)
    frames = sorted(_morphs()[0].objects, key=lambda obj: obj["convwass_index"])
    kinds = [obj.type for obj in frames]
    assert kinds == ["FONT", *["CURVE"] * (_FRAMES - 1), "FONT"], f"the frames are {kinds}"
    window.area.spaces.active.shading.type = "MATERIAL"
    bpy.context.scene.frame_set(1 + _FRAMES // 2)
    with window.override():
        bpy.ops.object.select_all(action="DESELECT")
    # The first view compiles shaders.
    yield 30.0
    yield from window.picture("51 letters halfway")
    window.say(f"the words become each other letter by letter, in {len(kinds)} frames, each letter in its color")


def _draws(window: Window) -> Iterator[float]:
    settings = bpy.context.scene.convwass_morph
    settings.flat_output = "DRAWING"
    _morphs()[0].hide_viewport = True
    yield from _choose(window)
    yield from _baked(window, 2)
    (obj,) = _morphs()[1].objects
    assert obj.type == "GREASEPENCIL", f"the morph is a {obj.type}"
    drawn = [frame.frame_number for frame in obj.data.layers[0].frames]
    assert drawn == list(range(1, _FRAMES + 2)), f"there are drawings at {drawn}"
    with window.override():
        bpy.ops.object.select_all(action="DESELECT")
    for number in (1, 4, 6, 9):
        bpy.context.scene.frame_set(number)
        yield 2.0
        yield from window.picture(f"52 drawing {number}")
    window.area.spaces.active.shading.type = "SOLID"
    window.say(f"one drawing has {len(drawn)} keyframes")


def _goes_wrong(window: Window) -> Iterator[float]:
    settings = bpy.context.scene.convwass_morph
    settings.flat_output = "CURVE"
    _morphs()[1].hide_viewport = True
    text = bpy.data.objects["ICE"]
    text.data.body = ""
    yield from _choose(window)
    yield from window.press("convwass.bake_morph")
    yield 1.5
    yield from window.picture("53 an empty text")
    assert len(_morphs()) == 2, "an empty text is baked"
    text.data.body = "ICE"
    with window.override():
        bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-2.0, 0.0, 0.0))
    # The message consumes the first key and the mouse.
    yield from window.key("Escape")
    yield from _choose(window)
    yield from window.press("convwass.bake_morph")
    yield 1.5
    yield from window.picture("54 flat and solid")
    assert len(_morphs()) == 2, "flat and solid shapes are baked together"
    window.say("an empty text, and flat shapes beside a solid one, are refused")
