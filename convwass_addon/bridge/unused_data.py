# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Remove data-blocks that nothing uses any more, or that could not be completed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager

import bpy


def remove_if_unused(blocks: Iterable[bpy.types.ID | None]) -> None:
    """Remove those of some data-blocks that nothing uses; None stands for one that is missing."""
    bpy.data.batch_remove({block for block in blocks if block is not None and not block.users})


@contextmanager
def removed_on_errors(blocks: Iterable[bpy.types.ID]) -> Iterator[None]:
    """Remove data-blocks if the context ends with an error; a list may grow until then."""
    try:
        yield
    except BaseException:
        bpy.data.batch_remove(list(blocks))
        raise


def remove_with_data(objects: Sequence[bpy.types.Object]) -> None:
    """Remove objects, with the data and actions that nothing else uses."""
    data = [obj.data for obj in objects]
    keys = [getattr(own, "shape_keys", None) for own in data]
    actions = _actions_of([*objects, *data, *keys])
    bpy.data.batch_remove(objects)
    remove_if_unused(data)
    remove_if_unused(actions)


def remove_mesh(mesh: bpy.types.Mesh) -> None:
    """Remove a mesh, with the actions of its own and of its shape keys that nothing else uses."""
    actions = _actions_of([mesh, mesh.shape_keys])
    bpy.data.meshes.remove(mesh)
    remove_if_unused(actions)


def _actions_of(blocks: Iterable[bpy.types.ID | None]) -> list[bpy.types.Action | None]:
    """Return the action of each data-block that is animated; None stands for one that is missing."""
    return [block.animation_data.action for block in blocks if block is not None and block.animation_data]
