# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""What a bake hides, remembered with its morph so that only this is shown when it is deleted: shapes and players."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import bpy

from ....errors import ConvwassError
from ....sentence import Sentence, first_names
from ...keyframes import is_animated_property
from ...object_names import ObjectName, objects_named
from ...shape_sources import OBJECTS, shape_sources, shows_collection
from ...visibility import layers_with, objects_in_scenes
from ..stored import MORPH_KEY, copied_inputs, stored_morph

HIDDEN_KEY = "convwass_hidden"
"""Custom property of a morph's collection or of an object with shape keys: JSON of what its bake has hidden."""


@dataclass(frozen=True)
class HiddenObject:
    """Where an object is hidden.

    Attributes
    ----------
    name : ObjectName
        The object.
    in_renders : bool
        Whether it is hidden in renders.
    layers : tuple of (str, str)
        Names of the scenes and view layers in which it is hidden.
    in_viewports : bool
        Whether it is disabled in viewports, too.
    """

    name: ObjectName
    in_renders: bool
    layers: tuple[tuple[str, str], ...]
    in_viewports: bool = False

    def without(self, other: HiddenObject) -> HiddenObject:
        """Return where the object is hidden here but not there."""
        left = tuple(layer for layer in self.layers if layer not in other.layers)
        disabled = self.in_viewports and not other.in_viewports
        return HiddenObject(self.name, self.in_renders and not other.in_renders, left, disabled)

    def also(self, other: HiddenObject) -> HiddenObject:
        """Return where the object is hidden here or there."""
        in_renders, in_viewports = self.in_renders or other.in_renders, self.in_viewports or other.in_viewports
        return HiddenObject(self.name, in_renders, (*self.layers, *other.layers), in_viewports)


def hide_shapes(morph: bpy.types.ID, objects: Iterable[bpy.types.Object], scene: bpy.types.Scene) -> None:
    """Hide objects in renders and in the view layers of a scene while a morph shows them.

    What is hidden already stays so when the morph is deleted, unless other morphs have hidden it.

    Parameters
    ----------
    morph : bpy.types.ID
        The morph, with which the objects are remembered.
    objects : iterable of bpy.types.Object
        The objects of its shapes; none if they are to stay visible.
    scene : bpy.types.Scene
        The scene that shows the morph.
    """
    found = _to_hide(morph, objects)
    layers = {obj: layers_with(obj, [scene]) for obj in found}
    _store(morph, [_in_layers(own, layers[obj]) for obj, own in found.items()])
    for obj in found:
        obj.hide_render = True
        for layer in layers[obj]:
            obj.hide_set(True, view_layer=layer)


def disable_player(morph: bpy.types.ID, player: bpy.types.Object) -> None:
    """Disable a player in viewports and renders while a morph shows the frames that were made from it."""
    own = _to_hide(morph, [player])[player]
    _store(morph, [*_hidden_by(morph), replace(own, layers=())])
    player.hide_viewport = player.hide_render = True


def still_in_renders(morph: bpy.types.ID) -> list[str]:
    """Return the names of objects that a morph hides, but that may be rendered because their visibility is animated."""
    hidden = objects_named([own.name for own in _hidden_by(morph)])
    return [obj.name for obj in hidden if obj is not None and is_animated_property(obj, "hide_render")]


def shown_when_opened(morph: bpy.types.ID) -> list[str]:
    """Return the names of linked objects that a morph hides in renders, which Blender forgets when it saves the file.

    Library overrides stay hidden.
    """
    return [obj.name for obj in _lost_in_renders(morph) if obj.library is not None]


def missed_in_renders(morph: bpy.types.ID) -> dict[str, list[str]]:
    """Return the scenes without a morph whose renders lack objects that it hides: names of objects by name of scene.

    Blender hides objects in the renders of all scenes.
    """
    others = [scene for scene in bpy.data.scenes if not _is_in(scene, morph)]
    objects = _lost_in_renders(morph)
    missed = {scene.name: [obj.name for obj in objects if scene in obj.users_scene] for scene in others}
    return {scene: names for scene, names in missed.items() if names}


def instances_without(morph: bpy.types.ID) -> tuple[list[str], list[str]]:
    """Return which instances of collections lack objects in renders that a morph hides.

    Blender hides objects in all of their instances.

    Returns
    -------
    instances : list of str
        Names of Empties in scenes, except for hidden ones, such as shapes of the morph.
    objects : list of str
        Names of the objects that they lack.
    """
    hidden = set(_lost_in_renders(morph))
    if not hidden:
        return [], []
    empties = [obj for obj in bpy.data.objects if shows_collection(obj) and not obj.hide_render]
    in_scenes = objects_in_scenes() if empties else set()
    shown = {obj.name: obj.instance_collection for obj in empties if obj in in_scenes}
    lacking = {collection: hidden & _instanced(collection) for collection in set(shown.values())}
    lost = {obj.name for objects in lacking.values() for obj in objects}
    return [name for name, collection in shown.items() if lacking[collection]], sorted(lost)


def take_hidden(old: bpy.types.ID, new: bpy.types.ID) -> None:
    """Store with a morph what its new bake has hidden, or else what its last one has and is hidden still."""
    found = _hidden_by(new)
    if not found:
        before = _hidden_by(old)
        objects = objects_named([one.name for one in before])
        found = [one.without(_shown(obj)) for one, obj in zip(before, objects, strict=True) if obj is not None]
    _store(old, found)


def copy_hidden(source: bpy.types.ID, target: bpy.types.ID) -> None:
    """Store with a morph that it needs the same objects hidden as another one."""
    _store(target, _hidden_by(source))


def hidden_only_by(morph: bpy.types.ID) -> list[HiddenObject]:
    """Return what a morph hides and no other morph does."""
    claims = _claims(_others(morph))
    return [reduce(HiddenObject.without, claims.get(own.name, ()), own) for own in _hidden_by(morph)]


def show_again(hidden: Sequence[HiddenObject]) -> None:
    """Show objects where they are hidden; those that no longer exist are left out."""
    for own, obj in zip(hidden, objects_named([one.name for one in hidden]), strict=True):
        if obj is None:
            continue
        if own.in_renders:
            obj.hide_render = False
        if own.in_viewports:
            obj.hide_viewport = False
        for layer in layers_with(obj, bpy.data.scenes):
            if _names(layer) in own.layers:
                obj.hide_set(False, view_layer=layer)


def unfound_notices(hidden: Sequence[HiddenObject]) -> list[Sentence]:
    """Return a notice about objects that cannot be shown in renders again, since none of a scene has their names."""
    objects = objects_named([own.name for own in hidden])
    lost = [own for own, obj in zip(hidden, objects, strict=True) if obj is None and own.in_renders]
    # A player that no longer exists was deleted with its morph.
    names = [own.name.name for own in lost if not own.in_viewports]
    if not names:
        return []
    return [
        Sentence(
            "No object is named {names}; if you have renamed such a shape, enable it in renders yourself",
            {"names": first_names(names)},
        )
    ]


def _instanced(collection: bpy.types.Collection) -> set[bpy.types.Object]:
    """Return the objects that an instance of a collection shows, also by instances in it."""
    seen, waiting = set(), [collection]
    while waiting:
        new = set(waiting.pop().all_objects) - seen
        seen |= new
        waiting += [obj.instance_collection for obj in new if shows_collection(obj)]
    return seen


def _is_in(scene: bpy.types.Scene, morph: bpy.types.ID) -> bool:
    """Return whether a scene has a morph, which is a collection or an object with shape keys."""
    if isinstance(morph, bpy.types.Object):
        return scene in morph.users_scene
    return morph in scene.collection.children_recursive


def _lost_in_renders(morph: bpy.types.ID) -> list[bpy.types.Object]:
    """Return the objects that a morph hides in renders."""
    hidden = [own.name for own in _hidden_by(morph) if own.in_renders]
    return [obj for obj in objects_named(hidden) if obj is not None]


def _to_hide(morph: bpy.types.ID, objects: Iterable[bpy.types.Object]) -> dict[bpy.types.Object, HiddenObject]:
    """Return where a morph could hide objects: where they are shown, or hidden by other morphs, but not by the user."""
    shown = {obj: _shown(obj) for obj in objects}
    others = _others(morph)
    _release({now.name: now for now in shown.values()}, others)
    claims = _claims(others)
    return {obj: reduce(HiddenObject.also, claims.get(now.name, ()), now) for obj, now in shown.items()}


def _in_layers(own: HiddenObject, layers: Iterable[bpy.types.ViewLayer]) -> HiddenObject:
    """Return where an object is hidden in renders and in some view layers, but not disabled in viewports."""
    kept = tuple(names for names in map(_names, layers) if names in own.layers)
    return replace(own, layers=kept, in_viewports=False)


def _claims(morphs: Iterable[bpy.types.ID]) -> Mapping[ObjectName, list[HiddenObject]]:
    """Return where morphs hide each object."""
    claims = defaultdict(list)
    for one in (one for morph in morphs for one in _hidden_by(morph)):
        claims[one.name].append(one)
    return claims


def _release(shown: Mapping[ObjectName, HiddenObject], morphs: Iterable[bpy.types.ID]) -> None:
    """Let morphs forget that they hide objects where these are shown, since the user wanted to see them."""
    for morph in morphs:
        before = _hidden_by(morph)
        after = [own.without(shown[own.name]) if own.name in shown else own for own in before]
        if after != before:
            _store(morph, after)


def _shown(obj: bpy.types.Object) -> HiddenObject:
    """Return where an object is shown now, and can be hidden."""
    layers = [layer for layer in layers_with(obj, bpy.data.scenes) if not obj.hide_get(view_layer=layer)]
    return HiddenObject(ObjectName.of(obj), not obj.hide_render, tuple(map(_names, layers)), not obj.hide_viewport)


def _names(layer: bpy.types.ViewLayer) -> tuple[str, str]:
    """Return the names of a view layer's scene and of the layer; most files have a layer of one name in every scene."""
    return layer.id_data.name, layer.name


def _present(scene: str, layer: str) -> list[tuple[str, str]]:
    """Return the names of a scene and a view layer; if none of these has a name, as after renaming, of all of them."""
    found = []
    for other in [own for own in bpy.data.scenes if own.name == scene] or bpy.data.scenes:
        names = list(map(_names, other.view_layers))
        found += [own for own in names if own[1] == layer] or names
    return found


def _others(morph: bpy.types.ID) -> list[bpy.types.ID]:
    """Return all other morphs in the scenes of the file."""
    # Deleted ones may still exist if something refers to them; two meshes that replace each other always do.
    collections = {own for scene in bpy.data.scenes for own in scene.collection.children_recursive}
    objects = (obj for obj in bpy.data.objects if MORPH_KEY in obj and obj.users_scene)
    morphs = [*(own for own in collections if MORPH_KEY in own), *objects]
    return [other for other in morphs if other != morph]


def _hidden_by(morph: bpy.types.ID) -> list[HiddenObject]:
    """Return what a morph hides; all of its shapes if that is damaged, or was not stored by an earlier version."""
    if morph.library is not None:
        # Its shapes are in another file, where they may have the names of objects of this one.
        return []
    try:
        return _in_scenes([_read(entry) for entry in json.loads(morph[HIDDEN_KEY])], morph)
    except (LookupError, TypeError, ValueError, RecursionError):
        layers = {_names(layer) for scene in bpy.data.scenes for layer in scene.view_layers}
        return [HiddenObject(ObjectName.of(part), True, tuple(layers)) for part in _parts(morph)]


def _in_scenes(hidden: list[HiddenObject], morph: bpy.types.ID) -> list[HiddenObject]:
    """Return what a morph hides in its scenes, which may be full copies of the one in which it was baked."""
    copies = copied_inputs(morph, [own.name for own in hidden])
    return [_of_copy(own, copies[own.name]) if own.name in copies else own for own in hidden]


def _of_copy(own: HiddenObject, copy: bpy.types.Object) -> HiddenObject:
    """Return where the copy of an object in a full copy of its scene is hidden: in view layers of the same names."""
    layers = {layer for _, layer in own.layers}
    names = (_names(layer) for layer in layers_with(copy, copy.users_scene))
    kept = tuple(both for both in names if both[1] in layers)
    return HiddenObject(ObjectName.of(copy), own.in_renders, kept, own.in_viewports)


def _parts(morph: bpy.types.ID) -> list[bpy.types.Object]:
    """Return the objects of the shapes of a morph that still exist; none if its description is damaged."""
    try:
        stored = stored_morph(morph)
    except ConvwassError:
        return []
    roots = [root for root in stored.objects if root is not None]
    sources = shape_sources(roots, stored.settings.get("grouping", OBJECTS))
    return [part for source in sources for part in source.parts]


def _read(entry: dict[str, object]) -> HiddenObject:
    name, library, layers = entry["name"], entry["library"], entry["layers"]
    if not (isinstance(name, str) and isinstance(library, str) and isinstance(layers, list)):
        raise TypeError("not a hidden object")
    places = (place for scene, layer in layers for place in _present(str(scene), str(layer)))
    # Earlier versions did not store players.
    disabled = bool(entry.get("in_viewports", False))
    return HiddenObject(ObjectName(name, library), bool(entry["in_renders"]), tuple(places), disabled)


def _store(morph: bpy.types.ID, hidden: Sequence[HiddenObject]) -> None:
    morph[HIDDEN_KEY] = json.dumps([_entry(one) for one in hidden])


def _entry(hidden: HiddenObject) -> dict[str, object]:
    values = {"in_renders": hidden.in_renders, "layers": list(hidden.layers), "in_viewports": hidden.in_viewports}
    return {**vars(hidden.name), **values}
