# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Where and when objects and modifiers are shown, and how to show or hide them for a while."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from contextlib import contextmanager
from itertools import compress

import bpy

from .animation_time import returning, show_time
from .keyframes import curves_of, drivers_of, shown_during


def shown_at(objects: Sequence[bpy.types.Object], times: Iterable[float]) -> list[tuple[bpy.types.Object, ...]]:
    """Return which objects are rendered at each of some times of the animation, in their order.

    Their keys are read directly. Only for those that NLA strips or drivers show, the scene goes through all times; its
    current frame is restored.
    """
    times = list(times)
    if all(_has_only_keys(obj) for obj in objects):
        found = [shown_during(obj, times) for obj in objects]
        return [tuple(compress(objects, shown)) for shown in zip(*found, strict=True)] if objects else [()] * len(times)
    scene, found = bpy.context.scene, []
    with shown_objects(objects, scene), returning(scene):
        for time in times:
            show_time(scene, time)
            depsgraph = bpy.context.evaluated_depsgraph_get()
            found.append(tuple(obj for obj in objects if not obj.evaluated_get(depsgraph).hide_render))
    return found


def _has_only_keys(obj: bpy.types.Object) -> bool:
    data = obj.animation_data
    return data is None or not (data.nla_tracks or data.drivers)


@contextmanager
def evaluated_object(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> Iterator[bpy.types.Object]:
    """Provide the evaluated object, even if it is hidden, without changing the scene permanently."""
    if obj.mode == "EDIT":
        obj.update_from_editmode()
    with current_objects([obj], depsgraph):
        yield obj.evaluated_get(depsgraph)


def update_places(objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> None:
    """Update the world matrices of objects, also of hidden ones, without changing the scene permanently."""
    with current_objects(objects, depsgraph):
        pass


@contextmanager
def current_objects(objects: Iterable[bpy.types.Object], depsgraph: bpy.types.Depsgraph) -> Iterator[None]:
    """Keep objects evaluated in their current state during a block of code; hidden ones are shown meanwhile.

    What Blender adds to its graph for them gets the values that its animation has now, which Blender itself only
    computes when the frame changes.
    """
    depsgraph.update()
    hidden = [obj for obj in objects if not is_current(obj, depsgraph)]
    if not hidden:
        yield
        return
    parts = {block for obj in hidden for block in (obj, obj.data, getattr(obj.data, "shape_keys", None))}
    known = {block.original for block in depsgraph.ids} - parts
    with shown_objects(hidden, depsgraph.scene):
        depsgraph.update()
        added = {block.original for block in depsgraph.ids} - known
        animated = [block for block in added if getattr(block, "animation_data", None) is not None]
        for block in animated:
            block.update_tag(refresh={"TIME"})
        if animated:
            depsgraph.update()
        yield


def is_current(obj: bpy.types.Object, depsgraph: bpy.types.Depsgraph) -> bool:
    """Return whether Blender has evaluated an object in its current state.

    It does not evaluate objects that are disabled in all viewports, but keeps those whose visibility changes over time.
    Of those to which only a property or a constraint refers, it evaluates no more than it needs for these.
    """
    evaluated = obj.evaluated_get(depsgraph)
    return evaluated.is_evaluated and not evaluated.hide_viewport and is_enabled(obj, depsgraph.view_layer)


def is_enabled(obj: bpy.types.Object, layer: bpy.types.ViewLayer) -> bool:
    """Return whether the collections of an object let a view layer evaluate it; the eye icon may hide it."""
    if not is_in(layer, obj):
        return False
    return obj.visible_get(view_layer=layer) or _is_within(layer.layer_collection, set(obj.users_collection))


def _is_within(layer_collection: bpy.types.LayerCollection, homes: Container[bpy.types.Collection]) -> bool:
    """Return whether a layer collection, or one inside it, is one of some collections and enabled in viewports."""
    collection = layer_collection.collection
    if collection.hide_viewport:
        return False
    if collection in homes and not layer_collection.exclude:
        return True
    return any(_is_within(child, homes) for child in layer_collection.children)


@contextmanager
def shown_objects(objects: Iterable[bpy.types.Object], scene: bpy.types.Scene) -> Iterator[None]:
    """Show objects in all frames of a scene, also where they, their collections, keys or drivers hide them."""
    objects, linked = list(objects), set(scene.collection.objects)
    curves = [curve for obj in objects for curve in (*curves_of(obj), *drivers_of(obj))]
    muted = [curve for curve in curves if curve.data_path == "hide_viewport" and not curve.mute]
    hidden, others = [obj.hide_viewport for obj in objects], [obj for obj in objects if obj not in linked]
    for curve in muted:
        curve.mute = True
    for obj in objects:
        obj.hide_viewport = False
    for obj in others:
        # Objects in the scene's own collection are always evaluated.
        scene.collection.objects.link(obj)
    try:
        yield
    finally:
        for obj in others:
            scene.collection.objects.unlink(obj)
        for obj, own in zip(objects, hidden, strict=True):
            obj.hide_viewport = own
        for curve in muted:
            curve.mute = False


def layers_with(obj: bpy.types.Object, scenes: Iterable[bpy.types.Scene]) -> list[bpy.types.ViewLayer]:
    """Return the view layers of scenes that contain an object."""
    return [layer for scene in scenes for layer in scene.view_layers if is_in(layer, obj)]


def objects_in_scenes() -> set[bpy.types.Object]:
    """Return the objects of all scenes; `users_scene` of an object searches the file for that object alone."""
    return {obj for scene in bpy.data.scenes for obj in scene.objects}


def is_in(layer: bpy.types.ViewLayer, obj: bpy.types.Object) -> bool:
    """Return whether a view layer has an object; a linked object may share its name with another one."""
    found = layer.objects.get(obj.name)
    return found is not None and (found == obj or obj in set(layer.objects))


@contextmanager
def hidden_modifiers(modifiers: Iterable[bpy.types.Modifier]) -> Iterator[None]:
    """Switch modifiers off in viewports during a block of code."""
    shown = [modifier for modifier in modifiers if modifier.show_viewport]
    for modifier in shown:
        modifier.show_viewport = False
    try:
        yield
    finally:
        for modifier in shown:
            modifier.show_viewport = True
