# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake images of the looks of all shapes for a mesh with shape keys, with a material that mixes them."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_erosion, distance_transform_edt

from ...applications.one_mesh.texture_settings import TextureSettings
from ...errors import ConvwassError, InputError
from ...progress import UNINTERRUPTED, Control, Progress, Work
from ...sentence import Sentence
from ..color_spaces import DATA, SRGB, color_space
from ..element_values import element_values
from ..files.image_files import opaque_pixels
from ..files.output_paths import creatable_folder, create_folder, file_stem
from ..handles import Handle
from ..mesh_checks import writable_mesh
from ..morphs.disk.disk_output import for_blender
from ..scene_colors import srgb_of_scene
from ..unused_data import removed_on_errors
from .baked_keys import SWAP_KEY
from .earlier_baking import (
    BAKED,
    assign_baked_material,
    earlier_images,
    earlier_material,
    made_uv_map,
    mesh_before_baking,
    reload_files,
    replace_data,
)
from .records import key_records
from .texture_baking import TextureSize, baked_pixels
from .texture_channels import BASE_COLOR, EMISSION, NORMAL, VALUES, Channel, has_normals, missing_images, shown_channel
from .texture_looks import Look, end_look, start_look
from .texture_material import ChannelImages, baked_material
from .texture_uvs import baked_uv_map, loop_uvs, share_outside, texture_pixels

# Distances between mesh and shape that are tried one after the other: multiples of the typical distance, and at least
# fractions of the diagonal.
_REACHES = ((3.0, 0.002), (12.0, 0.01), (48.0, 0.05))
# Width of the margin around islands relative to the image: mipmaps of 1/32 of the size do not show what is beyond.
_MARGIN = 1.0 / 64.0
# What is beyond it, instead of the mean.
_AROUND = {NORMAL: NORMAL.default}
# A further distance is tried, and in the end a notice given, if more than this share of the texture has no surface;
# another notice if more than this share of the mesh has no place in the texture.
_MISSED = 0.001


@dataclass(frozen=True)
class BakedTextures:
    """Result of a baking.

    Attributes
    ----------
    images : list of bpy.types.Image
        All images.
    material : bpy.types.Material
        Shows them.
    files : list of Path
        The images on disk.
    uv_map : str
        The UV map of the images.
    notices : list of Sentence
        Messages for the user.
    """

    images: list[bpy.types.Image]
    material: bpy.types.Material
    files: list[Path]
    uv_map: str
    notices: list[Sentence]


@dataclass
class _Baked:
    """What has been baked of a look.

    Attributes
    ----------
    reaches : list of float
        The distances that were tried.
    attempt : (size, size) int64
        The index among them at which each pixel found the shape; -1 where there is nothing.
    shown : (size, size) bool
        Whether a face covers the pixel.
    pixels : dict of Channel to (size, size, 3) float32
        The channels.
    """

    reaches: list[float] = field(default_factory=list)
    attempt: NDArray[np.int64] | None = None
    shown: NDArray[np.bool_] | None = None
    pixels: dict[Channel, NDArray[np.float32]] = field(default_factory=dict)


class TextureJob:
    """Bakes images for a mesh with shape keys; all methods must be called on the main thread.

    Parameters
    ----------
    obj : bpy.types.Object
        A mesh with shape keys to other shapes.
    settings : TextureSettings
        What is baked.

    Raises
    ------
    InputError
        A shape was deleted, the mesh does not reach it or is linked or one of two, its own UV map was asked for, but
        there is none or all of it is outside of the image, or the folder cannot be used.
    """

    def __init__(self, obj: bpy.types.Object, settings: TextureSettings) -> None:
        writable_mesh(obj)
        if SWAP_KEY in obj and settings.texture_looks != "START":
            raise InputError(
                "{name} is one of two meshes, each of which has its own look; set Looks to First Shape.", name=obj.name
            )
        self._folder = creatable_folder(settings.texture_folder) if settings.texture_folder else None
        self._obj, self._settings = Handle.of("objects", obj), settings
        self._looks: list[Look] = []
        self._baked: list[_Baked] = []
        self.notices: list[Sentence] = []
        sliders = [record["name"] for record in key_records(obj)]
        made, prepared = made_uv_map(obj.data), mesh_before_baking(obj)
        try:
            self._uv_map = baked_uv_map(prepared, obj.name, settings.texture_uvs, made)
            self._made = made or (self._uv_map if self._uv_map not in obj.data.uv_layers else "")
            self._uvs = loop_uvs(prepared, self._uv_map)
            self._note_outside(prepared, obj.name)
            if settings.texture_looks != "END":
                self._looks.append(start_look(obj, prepared, self._made))
            for slider in {"ALL": sliders, "START": [], "END": sliders[-1:]}[settings.texture_looks]:
                self._looks.append(end_look(obj, slider, prepared))
            for look in self._looks:
                self._note_missing_images(look)
            self._values = {channel: [_value_of(look, channel) for look in self._looks] for channel in VALUES}
        except BaseException:
            self.discard()
            raise
        finally:
            bpy.data.meshes.remove(prepared)

    def _note_outside(self, mesh: bpy.types.Mesh, name: str) -> None:
        """Add a notice for what the UV map places outside of the image; raises InputError if that is all of a mesh."""
        share = share_outside(mesh, self._uv_map)
        values = {"name": name, "uv_map": self._uv_map}
        if share > 1.0 - _MISSED:
            raise InputError(
                "All of {name} is outside of the image in the UV map {uv_map}; set UV Map to New.", **values
            )
        if share > _MISSED:
            values["share"] = f"{share:.0%}"
            self.notices.append(
                Sentence(
                    "{share} of {name} are outside of the image in the UV map {uv_map}, as on other UDIM tiles, and "
                    "repeat the look of what is inside; set UV Map to New",
                    values,
                )
            )

    def _note_missing_images(self, look: Look) -> None:
        """Add a notice for images of a look that Cycles shows in magenta."""
        for image in missing_images(_materials(look), look.scene.frame):
            values = {"image": image.name, "name": look.name}
            self.notices.append(
                Sentence("The file of the image {image} of {name} is missing; it is baked in magenta", values)
            )

    def _is_common(self, channel: Channel) -> bool:
        """Return whether a channel is the same everywhere on all shapes."""
        first = self._values[channel][0]
        return first is not None and all(own == first for own in self._values[channel])

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Bake one image after the other."""
        channels = [BASE_COLOR, *(own for own in VALUES[1:] if not self._is_common(own))]
        if any(has_normals(_materials(look)) for look in self._looks):
            channels.append(NORMAL)
        done, count = 0, len(channels) * len(self._looks)
        for number, look in enumerate(self._looks):
            baked = _Baked()
            self._baked.append(baked)
            for channel in channels:
                control.check()
                values = {"channel": channel.name, "name": look.name}
                yield Progress(done / count, Sentence("{channel} of {name}", values), None)
                value = self._values[channel][number] if channel != NORMAL else None
                if value is not None:
                    baked.pixels[channel] = self._uniform(value)
                else:
                    baked.pixels[channel] = self._pixels(look, channel, baked)
                done += 1

    def _uniform(self, value: tuple[float, float, float]) -> NDArray[np.float32]:
        size = self._settings.texture_size
        return np.broadcast_to(np.array(value, np.float32), (size, size, 3))

    def _pixels(self, look: Look, channel: Channel, baked: _Baked) -> NDArray[np.float32]:
        """Bake a channel; the first one that is baked decides how far every pixel has to reach."""
        size = TextureSize(self._settings.texture_size, self._settings.texture_samples, self._uv_map)
        if baked.attempt is None:
            found = self._first(look, channel, baked, size)
        else:
            found = np.zeros((size.pixels, size.pixels, 3), np.float32)
            for number, reach in enumerate(baked.reaches):
                own = baked_pixels(look, channel, size, reach)[..., :3]
                found[baked.attempt == number] = own[baked.attempt == number]
        known = baked.attempt >= 0
        return _filled(found, known, baked.shown, _AROUND.get(channel))

    def _first(self, look: Look, channel: Channel, baked: _Baked, size: TextureSize) -> NDArray[np.float32]:
        found = np.zeros((size.pixels, size.pixels, 3), np.float32)
        baked.attempt = np.full((size.pixels, size.pixels), -1)
        mesh = look.onto.found()
        shown = np.zeros(size.pixels**2, dtype=bool)
        shown[texture_pixels(mesh, self._uv_map, size.pixels).places] = True
        # Cycles treats borders of islands slightly differently.
        baked.shown = shown.reshape(size.pixels, size.pixels)
        inside = binary_erosion(baked.shown)
        for number, reach in enumerate(self._reaches(look, mesh)):
            own = baked_pixels(look, channel, size, reach)
            new = (own[..., 3] > 0.0) & (baked.attempt < 0)
            # Samples beyond the border of an island have no color.
            found[new] = own[new][:, :3] / own[new][:, 3:]
            baked.attempt[new] = number
            baked.reaches.append(reach)
            missed = np.count_nonzero(inside & (baked.attempt < 0)) / max(1, np.count_nonzero(inside))
            if missed <= _MISSED:
                return found
        values = {"share": f"{missed:.1%}", "name": look.name}
        self.notices.append(
            Sentence("{share} of the texture of {name} have no surface of it within reach, and are filled in.", values)
        )
        return found

    def _reaches(self, look: Look, mesh: bpy.types.Mesh) -> list[float]:
        if look.shape is None:
            return [0.0]
        points = element_values(mesh.vertices, "co", 3)
        world = points @ look.onto.world[:3, :3].T
        diagonal = float(np.linalg.norm(np.ptp(world, axis=0)))
        return [max(times * look.reach, least * diagonal) for times, least in _REACHES]

    def write(self, report: Progress[object]) -> None:
        """Do nothing: the file is only changed at the end."""

    def discard(self) -> None:
        """Remove the copies of the shapes."""
        for look in self._looks:
            look.discard()

    def finish(self) -> BakedTextures:
        """Create the images and the material, and assign it to the mesh.

        They take the place and the names of those of an earlier baking, unless another mesh still shows these.

        Raises
        ------
        ConvwassError
            The mesh was deleted, or its faces have changed; or an image could not be written. The mesh is not changed.
        """
        obj = self._obj.find()
        if obj is None or len(obj.data.loops) != len(self._uvs):
            raise ConvwassError("The mesh was deleted or changed during the baking; start again.")
        self.discard()
        made = {channel: self._images(obj.name, channel) for channel in self._baked[0].pixels}
        images = [image for own in made.values() for image in own.images]
        earlier = earlier_material(obj.data)
        before = earlier_images(images, earlier)
        with removed_on_errors(images):
            files = [self._stored(image, before.get(image, image).name) for image in images if self._folder]
        for image, old in before.items():
            replace_data(old, image)
        reload_files(files, images)
        constants = {own: ChannelImages((), values[0]) for own, values in self._values.items() if own not in made}
        sliders = [look.slider for look in self._looks]
        material = baked_material(f"{obj.name} Baked", constants | made, sliders, self._uv_map)
        material[BAKED] = self._made
        assign_baked_material(obj.data, material, self._uv_map, self._uvs)
        if earlier is not None and not earlier.users:
            replace_data(earlier, material)
        return BakedTextures(images, material, files, self._uv_map, self.notices)

    def _images(self, name: str, channel: Channel) -> ChannelImages:
        """Create the images of a channel, or a value if it turns out to be the same everywhere."""
        pixels = [baked.pixels[channel] for baked in self._baked]
        first = pixels[0][0, 0]
        if channel != NORMAL and all(np.allclose(own, first, atol=1e-4) for own in pixels):
            return ChannelImages((), tuple(map(float, first)))
        strength = max(1.0, *(float(own.max()) for own in pixels)) if channel == EMISSION else 1.0
        images = tuple(
            _image(
                f"{name} {look.name} {channel.name}" if look.slider else f"{name} {channel.name}",
                own / strength,
                channel,
            )
            for look, own in zip(self._looks, pixels, strict=True)
        )
        for image in images:
            if self._folder is None:
                image.pack()
        return ChannelImages(images, channel.default, strength)

    def _stored(self, image: bpy.types.Image, name: str) -> Path:
        """Write an image to the folder, under a name."""
        create_folder(self._folder)
        file = self._folder / f"{file_stem(name)}.png"
        image.filepath_raw, image.file_format = for_blender(file), "PNG"
        try:
            image.save()
        except RuntimeError as error:
            raise InputError("{file} could not be written.", file=str(file)) from error
        return file


def _value_of(look: Look, channel: Channel) -> tuple[float, float, float] | None:
    """Return a channel of a look if it is the same everywhere; None if it is not."""
    found = set()
    for material in _materials(look):
        shown = shown_channel(material, channel)
        found.add(shown.value)
        bpy.data.batch_remove([shown.material, *shown.groups])
    return found.pop() if len(found) == 1 else None


def _materials(look: Look) -> list[bpy.types.Material | None]:
    """Return the materials that the faces of a look have."""
    mesh = look.source.found()
    slots = element_values(mesh.polygons, "material_index", kind=np.int32)
    count = len(mesh.materials)
    return [mesh.materials[slot] if count else None for slot in np.unique(np.minimum(slots, max(count - 1, 0)))]


def _filled(
    pixels: NDArray[np.float32],
    known: NDArray[np.bool_],
    shown: NDArray[np.bool_],
    around: tuple[float, float, float] | None,
) -> NDArray[np.float32]:
    """Give unknown pixels of faces and of the margin around them the closest known value, and others `around`.

    By default, `around` is the mean of the known values, which is no seam even in the smallest mipmaps.
    """
    if known.all() or not known.any():
        return pixels
    distances, (rows, columns) = distance_transform_edt(~known, return_indices=True)
    near = shown | (distances <= max(1.0, _MARGIN * len(pixels)))
    beyond = pixels[known].mean(axis=0) if around is None else np.array(around, np.float32)
    return np.where(near[..., None], pixels[rows, columns], beyond)


def _image(name: str, pixels: NDArray[np.float32], channel: Channel) -> bpy.types.Image:
    """Create an image of bytes from scene linear values, (size, size, 3)."""
    size = len(pixels)
    image = bpy.data.images.new(name, size, size, alpha=False)
    image.colorspace_settings.name = color_space(SRGB if channel.is_color else DATA)
    values = srgb_of_scene(pixels) if channel.is_color else np.clip(pixels, 0.0, 1.0)
    image.pixels.foreach_set(opaque_pixels(values).ravel())
    image.update()
    return image
