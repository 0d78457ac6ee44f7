# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Write a morph of gray images as a sequence of picture files and a plane that shows it."""

from __future__ import annotations

import glob
import shutil
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self

import bpy
import numpy as np
from mathutils import Matrix
from numpy.typing import NDArray

from ...applications.flat.flat_frames import FlatFrame
from ...applications.morphs.layouts import Blend
from ...drafts import DraftFiles
from ...errors import InputError
from ..color_spaces import SRGB, color_space
from ..edited_materials import remember_made
from ..files.image_files import image_path
from ..files.numbered_files import file_number, numbered_paths
from ..handles import Handle, found
from ..morphs.bake import MorphBake, alone_in, check_frames
from ..morphs.disk.disk_output import for_blender, output_folder, remember_folder
from ..morphs.disk.written_files import drop_surplus, store_written
from ..morphs.inputs.frozen_inputs import FrozenInput
from ..morphs.looks.materials import input_color, is_carrying, mark_as_frames
from ..morphs.stored import frame_objects
from ..nodes.node_trees import own_tree
from ..palettes.image_files import save_pixels
from ..unused_data import remove_if_unused
from .gray_inputs import GrayInput


@dataclass(frozen=True)
class PictureFrame(FlatFrame):
    """A finished blend with its picture, (height, width, 4), rows from the bottom."""

    pixels: NDArray[np.float32] | None = None


class PictureBake(MorphBake):
    """A morph being written as pictures; files are moved into place at the end."""

    @classmethod
    def begin_pictures(
        cls,
        inputs: Sequence[bpy.types.Object],
        blends: Sequence[Blend],
        settings: dict[str, object],
        first_frame: int,
        grays: Sequence[GrayInput],
        replaces: bpy.types.Collection | None,
        folder_of: Callable[[str, bpy.types.Collection], Path],
    ) -> Self:
        """Create the collection and the output folder in `folder` of `settings`.

        `folder_of` is asked for the folder of the morph `replaces`, if there is one, which gives the files their name.

        Raises
        ------
        InputError
            Blender does not support the first or the last frame, the layout is a sheet, or the folder cannot be used;
            nothing is created then.
        """
        check_frames(first_frame, blends)
        if blends[0].frame is None and len(blends) > 1:
            raise InputError("Pictures require an animation or a single blend; choose another layout, or other frames.")
        shapes = [_described(obj, gray) for obj, gray in zip(inputs, grays, strict=True)]
        bake = cls._opened(inputs, shapes, blends, settings, first_frame)
        bake._grays, bake._drafts = tuple(grays), DraftFiles()
        bake._replaces = None if replaces is None else Handle.of("collections", replaces)
        try:
            folder = str(settings.get("folder") or "//")
            target = folder_of(folder, replaces or bake._living(bake._collection))
            bake._new_folders = [own for own in (target, *target.parents) if not own.exists()]
            bake._folder = output_folder(target)
        except InputError:
            bake.discard()
            raise
        return bake

    _grays: tuple[GrayInput, ...]
    _folder: Path
    # Folders created for the files, innermost first.
    _new_folders: Sequence[Path] = ()
    _drafts: DraftFiles
    _replaces: Handle | None
    _count: int = 0
    _plane: Handle | None = None

    def _shown_object(self, frame: PictureFrame, index: int) -> bpy.types.Object:
        """Write the picture of a frame; the first frame creates the plane."""
        collection = self._living(self._collection)
        drafts = [self._drafts.draft_of(self._path(number)) for number in self._numbers(index)]
        _save(frame.pixels, drafts[0])
        for draft in drafts[1:]:
            shutil.copyfile(drafts[0], draft)
        self._count += len(drafts)
        if self._plane is None:
            obj = _plane_object(collection.name, frame, self._grays[0].plane.matrix)
            obj.data.materials.append(_picture_material(collection.name))
            self._plane = alone_in(collection, obj, frame.blend)
        return self._living(self._plane)

    def _path(self, number: int) -> Path:
        """Return the file of a scene frame, with the same number of digits for all frames."""
        last = self._numbers(len(self._blends) - 1)[-1]
        numbers = [file_number(frame, self._stored.first_frame) for frame in (number, last)]
        return numbered_paths(self._folder, f"{self._folder.name}_", ".png", numbers)[0]

    def _numbers(self, index: int) -> range:
        """Return the scene frames that show a blend, up to the next blend."""
        if self._blends[index].frame is None:
            return range(self._stored.first_frame, self._stored.first_frame + 1)
        own = self._scene_frame(index)
        return range(own, self._scene_frame(index + 1) if index + 1 < len(self._blends) else own + 1)

    def finish(self, hide_inputs: bool) -> bpy.types.Collection:
        """Move the files into place, and finish the morph; see :class:`.MorphBake`.

        Surplus pictures of a replaced morph are removed.
        """
        collection, files = self._living(self._collection), []
        if self._plane is not None and self._plane.find() is not None:
            files = self._drafts.keep()
            image = self._picture_node().image = bpy.data.images.load(str(min(files)))
            image.colorspace_settings.name = color_space(SRGB)
            image.filepath = for_blender(min(files))
            store_written(collection, files)
            remember_folder(collection, self._folder)
        super().finish(hide_inputs)
        replaced = None if self._replaces is None else self._replaces.find()
        if replaced is not None and files:
            drop_surplus(replaced, self._folder, self._folder.name, files)
        return collection

    def _picture_node(self) -> bpy.types.Node:
        nodes = self._living(self._plane).data.materials[0].node_tree.nodes
        return next(node for node in nodes if node.bl_idname == "ShaderNodeTexImage")

    def _show_in_time(self, collection: bpy.types.Collection, frames: dict[int, bpy.types.Object]) -> None:
        """Show the files as an image sequence that holds its first and last picture."""
        node = self._picture_node()
        node.image.source = "SEQUENCE"
        user, first = node.image_user, self._stored.first_frame
        user.frame_start, user.frame_offset = first, file_number(first, first) - 1
        user.frame_duration = self._count
        user.use_auto_refresh, user.use_cyclic = True, False

    def discard(self) -> None:
        """Remove everything this bake has made, including drafts and empty folders."""
        super().discard()
        self._drafts.discard()
        for folder in self._new_folders:
            with suppress(OSError):
                folder.rmdir()

    def _drop_unused(self) -> None:
        super()._drop_unused()
        remove_if_unused(found([shape.mesh for shape in self._inputs]))


def pictures_of(collection: bpy.types.Collection) -> list[Path]:
    """Return the picture files of a morph; empty if it has none."""
    materials = [one for obj in frame_objects(collection) if obj.data for one in obj.data.materials if is_carrying(one)]
    nodes = [node for one in materials if one.node_tree for node in one.node_tree.nodes if node.type == "TEX_IMAGE"]
    first = [image_path(node.image) for node in nodes if node.image]
    return sorted(path for one in first for path in _alike(one))


def _alike(path: Path) -> list[Path]:
    """Return the files that differ from a file only in the number at the end."""
    before, _, number = path.stem.rpartition("_")
    return list(path.parent.glob(f"{glob.escape(before)}_{len(number) * '[0-9]'}{path.suffix}"))


def _described(obj: bpy.types.Object, gray: GrayInput) -> FrozenInput:
    """Describe an input without copying it."""
    mesh = Handle.of("meshes", bpy.data.meshes.new(obj.name))
    return FrozenInput(Handle.of("objects", obj), obj.name, input_color(obj), mesh, 1.0, gray.plane.origin)


def _save(pixels: NDArray[np.float32], path: Path) -> None:
    like = bpy.data.images.new("Picture", 1, 1, alpha=True)
    like.colorspace_settings.name = color_space(SRGB)
    try:
        save_pixels(pixels, like, path)
    finally:
        bpy.data.images.remove(like)


def _plane_object(name: str, frame: PictureFrame, place: NDArray[np.float64]) -> bpy.types.Object:
    """Create a rectangle of the size of the pictures, with a UV map."""
    density = frame.density
    low = np.asarray(density.corner)
    high = low + density.pixel * np.array(density.values.shape)
    mesh = bpy.data.meshes.new(name)
    corners = [(low[0], low[1], 0.0), (high[0], low[1], 0.0), (high[0], high[1], 0.0), (low[0], high[1], 0.0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.uv_layers.new().uv.foreach_set("vector", [0.0, 0.0, 1.0, 0.0, 1.0, 1.0, 0.0, 1.0])
    obj = bpy.data.objects.new(name, mesh)
    obj.matrix_world = Matrix(place)
    return obj


def _picture_material(name: str) -> bpy.types.Material:
    """Create an emissive material that shows a picture, transparent where the picture is transparent or missing."""
    material = bpy.data.materials.new(name)
    mark_as_frames(material)
    tree = own_tree(material)
    tree.nodes.clear()
    kinds = ("OutputMaterial", "MixShader", "BsdfTransparent", "Emission", "TexImage")
    output, mixed, clear, shine, picture = (tree.nodes.new(f"ShaderNode{kind}") for kind in kinds)
    for place, node in enumerate((output, mixed, clear, shine, picture)):
        node.location = (-220.0 * place, 0.0)
    picture.extension = "CLIP"
    tree.links.new(picture.outputs["Color"], shine.inputs["Color"])
    tree.links.new(picture.outputs["Alpha"], mixed.inputs[0])
    tree.links.new(clear.outputs[0], mixed.inputs[1])
    tree.links.new(shine.outputs[0], mixed.inputs[2])
    tree.links.new(mixed.outputs[0], output.inputs["Surface"])
    remember_made(material)
    return material
