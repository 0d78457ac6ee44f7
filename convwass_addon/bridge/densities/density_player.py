# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Play a moving density as one animated attribute, with geometry nodes.

The frames are attributes of the mesh. Depending on its *Density* value, a modifier mixes the two nearest frames into
the attribute that materials, later modifiers and hair read. The file plays without the add-on, in viewports and
renders.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import bpy
import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...errors import InputError
from ..keyframes import channels_of, ease, is_driven, own_action
from ..mesh_checks import writable_mesh
from ..nodes.node_inputs import NodeInput, node_input
from ..unused_data import remove_if_unused
from .density_attributes import checked_frames, remove_color, remove_frames, require_free, write_frames
from .density_nodes import DENSITY_KEY, NAME, VALUE, density_tree, fill
from .density_store import StoredDensity, forget_density, store_density, stored_or_new


@dataclass(frozen=True)
class DensityKey:
    """The value of the density, from 0 to 1, at a possibly fractional scene frame."""

    frame: float
    value: float


def keys_at(frames: Sequence[float]) -> list[DensityKey]:
    """Return the keys with which a density reaches the groups of a path at these scene frames, ascending."""
    first, last = frames[0], frames[-1]
    return [DensityKey(frame, (frame - first) / (last - first)) for frame in frames]


def animate_density(
    obj: bpy.types.Object,
    densities: ArrayLike,
    times: ArrayLike,
    name: str = NAME,
    *,
    keys: Sequence[DensityKey] = (),
    easing: str = "LINEAR",
    description: StoredDensity | None = None,
) -> bpy.types.NodesModifier:
    """Store the frames of a density, and play them as one attribute with the first modifier of an object.

    The maximum over all frames becomes 1, as suits masks; for densities of mass 1, set the modifier's `SCALE` to the
    stored scale. A density of the same name is replaced: its modifier is kept, and its keys unless new ones are given.
    Other objects that play the density on the same mesh play the new one.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh object, not in Edit Mode.
    densities : (f, n) array_like
        At least two frames with one non-negative value per vertex. Values below 1/131072 of the maximum become 0.
    times : (f,) array_like
        Time of each frame, ascending, scaled to 0 ... 1. Frames are interpolated linearly.
    name : str
        Name of the attribute, on points.
    keys : sequence of DensityKey
        The animation; empty for none.
    easing : str
        A key of `keyframes.EASINGS`, for the interpolation between keys.
    description : StoredDensity, optional
        The description to store; times and scale are filled in.

    Returns
    -------
    bpy.types.NodesModifier

    Raises
    ------
    InputError
        The object is not a mesh, is in Edit Mode or linked, or the name belongs to something else.
    """
    mesh = writable_mesh(obj)
    frames = checked_frames(densities, len(mesh.vertices), least=2)
    places = _checked_times(times, len(frames))
    require_free(obj, name)
    peak = float(frames.max())
    known = description or stored_or_new(obj, name)
    write_frames(mesh, name, frames / peak if peak > 0.0 else frames)
    modifier = _play(obj, name, places)
    store_density(obj, name, replace(known, times=places.tolist(), scale=peak if peak > 0.0 else 1.0))
    if keys:
        _key(density_value(obj, name), keys, easing)
    mesh.update()
    return modifier


def remove_density(obj: bpy.types.Object, name: str = NAME) -> None:
    """Remove a density with its modifier, keys and frames; other objects that play it are not affected.

    Raises
    ------
    InputError
        As for `animate_density`, or no density of this name is played.
    """
    mesh = writable_mesh(obj)
    modifier = density_modifier(obj, name)
    _unkey(density_value(obj, name))
    tree = modifier.node_group
    obj.modifiers.remove(modifier)
    remove_if_unused([tree])
    if not _players(mesh, name):
        remove_frames(mesh, name)
        remove_color(mesh, name)
    forget_density(obj, name)
    mesh.update()


def density_modifier(obj: bpy.types.Object, name: str = NAME) -> bpy.types.NodesModifier:
    """Return the modifier that plays a density.

    Raises
    ------
    InputError
        There is no such modifier.
    """
    found = next((modifier for modifier in obj.modifiers if _plays(modifier, name)), None)
    if found is None:
        raise InputError("{object} does not play a density {name}; animate it first.", object=obj.name, name=name)
    return found


def density_value(obj: bpy.types.Object, name: str = NAME) -> NodeInput:
    """Return the animatable value of a density; draw it with ``layout.prop(value.owner, value.path)``."""
    return node_input(density_modifier(obj, name), VALUE)


def takes_keys(obj: bpy.types.Object, name: str) -> bool:
    """Return whether keys of a density, which need not exist yet, have an effect and may be replaced.

    A driver takes precedence over keys, and those of a locked curve are to stay as they are.
    """
    if name not in played_densities(obj):
        return True
    value = density_value(obj, name)
    curve = value.curve()
    return not is_driven(obj, value.data_path) and (curve is None or not curve.lock)


def played_densities(obj: bpy.types.Object) -> list[str]:
    """Return the names of the densities that an object plays, in modifier order."""
    trees = (modifier.node_group for modifier in obj.modifiers if modifier.type == "NODES")
    return [tree[DENSITY_KEY] for tree in trees if tree and isinstance(tree.get(DENSITY_KEY), str)]


def _checked_times(times: ArrayLike, count: int) -> NDArray[np.float64]:
    """Scale times to 0 ... 1."""
    places = np.asarray(times, dtype=np.float64)
    if places.shape != (count,) or not np.isfinite(places).all() or not (np.diff(places) > 0.0).all():
        raise ValueError(f"times are not {count} ascending numbers")
    return (places - places[0]) / (places[-1] - places[0])


def _play(obj: bpy.types.Object, name: str, times: NDArray[np.float64]) -> bpy.types.NodesModifier:
    """Set the frames for all objects that play this density on this mesh, and for `obj`."""
    players = _players(obj.data, name)
    if not any(player.id_data == obj for player in players):
        modifier = obj.modifiers.new(f"Play {name}", "NODES")
        obj.modifiers.move(len(obj.modifiers) - 1, 0)
        # Moving a modifier invalidates references to it.
        modifier = obj.modifiers[0]
        modifier.node_group = players[0].node_group if players else density_tree(name, times)
        players = _players(obj.data, name)
    tree = density_modifier(obj, name).node_group
    # Copies of the object with their own mesh keep their frames and times.
    if tree.users > sum(player.node_group == tree for player in players):
        tree = tree.copy()
    fill(tree, name, times)
    for player in players:
        player.node_group = tree
    return density_modifier(obj, name)


def _players(mesh: bpy.types.Mesh, name: str) -> list[bpy.types.NodesModifier]:
    objects = [obj for obj in bpy.data.objects if obj.data == mesh and obj.is_editable]
    return [modifier for obj in objects for modifier in obj.modifiers if _plays(modifier, name)]


def _plays(modifier: bpy.types.Modifier, name: str) -> bool:
    return modifier.type == "NODES" and bool(modifier.node_group) and modifier.node_group.get(DENSITY_KEY) == name


def _key(value: NodeInput, keys: Sequence[DensityKey], easing: str) -> None:
    _unkey(value)
    for key in keys:
        value.set(float(key.value))
        value.owner.keyframe_insert(value.path, frame=key.frame)
    ease(value.curve(), easing)


def _unkey(value: NodeInput) -> None:
    """Remove the keys of a value; other animation of the object, and that of its linked duplicates, is kept."""
    if value.curve() is None:
        return
    own_action(value.modifier.id_data)
    data = value.modifier.id_data.animation_data
    bag, action = channels_of(value.modifier.id_data), data.action
    bag.fcurves.remove(value.curve())
    if not bag.fcurves:
        data.action = None
        remove_if_unused([action])
