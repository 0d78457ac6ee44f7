# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The mesh of the command ``density``, and the distributions that its arguments name."""

from __future__ import annotations

import re
from dataclasses import dataclass

import bpy
import numpy as np
from numpy.typing import NDArray

from ..applications.densities.density_settings import DensitySettings
from ..applications.densities.density_tools import unit_mass
from ..applications.densities.surface_densities import Surface, blur_notice, blur_of, density_surface
from ..bridge.files.blend_files import open_blend, open_empty, several_meshes
from ..bridge.files.imports import BLEND, Source, import_objects, parse_source
from ..bridge.frame_range import play_among_others, play_whole
from ..bridge.surfaces import SurfaceReading, ignored_notices, read_surface
from ..bridge.vertex_groups import group_names, read_group
from ..errors import InputError
from ..sentence import Sentence

_VERTICES = re.compile(r"vertex:(\d{1,9}(?:,\d{1,9})*)", re.ASCII)


@dataclass(frozen=True)
class DensityScene:
    """An object of the open file and its surface.

    Attributes
    ----------
    object : bpy.types.Object
        Its vertex groups are the distributions.
    surface : Surface
        In scene units; vertices as in the object's mesh.
    reading : SurfaceReading
        What it was made from.
    """

    object: bpy.types.Object
    surface: Surface
    reading: SurfaceReading

    @property
    def notices(self) -> list[Sentence]:
        """Messages about the blur and the modifiers."""
        notice = blur_notice(self.surface)
        return [*([] if notice is None else [notice]), *ignored_notices([self.reading])]

    @property
    def blur(self) -> float:
        """The blur used, in scene units."""
        return blur_of(self.surface)

    @property
    def first_frame(self) -> int:
        """First frame of the animation."""
        return bpy.context.scene.frame_start

    def play_to(self, last: int) -> None:
        """Set the last frame of a new scene to the end of the animation; the scene of a .blend is only extended."""
        fit = play_among_others if bpy.data.filepath else play_whole
        fit(bpy.context.scene, self.first_frame, last)

    def stands_for_weights(self, name: str) -> bool:
        """Whether a name is an existing group or a list of vertices."""
        return name in group_names(self.object) or _VERTICES.fullmatch(name) is not None

    def weights(self, name: str) -> NDArray[np.float64]:
        """Return the distribution named by a group or by ``vertex:1,2``: weights or a density, (n,).

        Raises
        ------
        InputError
            There is no such group, or the vertices cannot hold mass.
        """
        if name not in group_names(self.object):
            found = _VERTICES.fullmatch(name)
            if found:
                # The surface's own kernel spreads the mass by exactly the blur.
                return self.surface.apply(unit_mass([int(number) for number in found[1].split(",")], self.surface))
        return read_group(self.object, name)


def open_mesh(text: str, settings: DensitySettings) -> DensityScene:
    """Open a file given on the command line and build the surface of its mesh.

    A .blend is opened unchanged, without running its scripts; any other file is imported into an empty scene.

    Raises
    ------
    InputError
        The file or object cannot be used, or the blur does not suit it.
    ResourceError
        The mesh needs more memory than available.
    """
    source = parse_source(text)
    if source.path.suffix.lower() == BLEND and source.path.is_file():
        obj = opened_object(source)
    else:
        open_empty()
        (obj,) = import_objects(source.path, source.names)
    read = read_surface(obj, bpy.context.evaluated_depsgraph_get())
    surface = density_surface(read.mesh, settings.blur, settings.substeps)
    return DensityScene(obj, surface, read)


def opened_object(source: Source) -> bpy.types.Object:
    """Open a .blend and return the named object, or the only mesh.

    Raises
    ------
    InputError
        The file cannot be opened, the object does not exist, or there are several meshes and none is named.
    """
    open_blend(source.path)
    if source.object_name is not None:
        return object_in_scene(source)
    meshes = _meshes_in_scene()
    if len(meshes) != 1:
        raise several_meshes(source.path, len(meshes), ", ".join(meshes) or "none")
    return bpy.context.scene.objects[meshes[0]]


def object_in_scene(source: Source) -> bpy.types.Object:
    """Return the named object of the open file; raises InputError if there is none."""
    found = bpy.context.scene.objects.get(source.object_name or "")
    if found is None:
        raise InputError(
            "{file} has no object {name} in its scene; its meshes are {available}.",
            file=source.path.name,
            name=source.object_name or "-",
            available=", ".join(_meshes_in_scene()) or "none",
        )
    return found


def _meshes_in_scene() -> list[str]:
    return sorted(obj.name for obj in bpy.context.scene.objects if obj.type == "MESH")
