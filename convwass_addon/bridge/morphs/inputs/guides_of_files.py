# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Guides for shapes of files, which may have lost their groups, bones and Empties when they were imported."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

import bpy

from ....applications.whole_paths import whole_path
from ....errors import InputError
from ....geometry.meshes.mesh import TriangleMesh
from ...files.blend_files import appended_objects
from ...files.imports import BLEND, only_kept_data, parse_source
from ...files.scratch_scene import scratch_scene
from ...surfaces import surface_mesh
from .morph_guides import (
    NamedGuide,
    check_guide_names,
    guides_from_bones,
    guides_from_empties,
    guides_from_groups,
    guides_now,
    parsed_guides,
    vertex_of_shape,
)


def guides_asked_for(
    word: str | None, texts: Sequence[str], inputs: Sequence[bpy.types.Object], depsgraph: bpy.types.Depsgraph
) -> list[NamedGuide]:
    """Return the guides requested on the command line.

    Parameters
    ----------
    word : str or None
        "groups", "empties", "bones", or the path of a JSON file; None for no guides.
    texts : sequence of str
        The shapes as they were named on the command line.
    inputs : sequence of bpy.types.Object
        The inputs of the morph, which were imported from these shapes.
    depsgraph : bpy.types.Depsgraph
        The dependency graph of the scene.

    Returns
    -------
    list of NamedGuide
        With vertices of the inputs. Those in a JSON file are vertices of the meshes in the files, as in Blender: of
        objects of a .blend before modifiers, of other files and collections as they are imported.

    Raises
    ------
    InputError
        The file cannot be read or refers to other objects or vertices, or no names match.
    """
    if word is None:
        return []
    meshes = {obj.name: surface_mesh(obj, depsgraph) for obj in inputs if obj.type == "MESH"}
    with _originals(texts, inputs) as originals:
        solid = {name: obj for name, obj in originals.items() if name in meshes}
        if word in ("groups", "empties", "bones"):
            found = _guides_by_names(word, solid)
        else:
            found = _read_guides(word)
            check_guide_names(found, inputs)
        used = {name for guide in found for name in guide.points if name in solid}
        own = {name: surface_mesh(solid[name], bpy.context.evaluated_depsgraph_get()) for name in used}
    return guides_now([_on_inputs(index, guide, own, meshes) for index, guide in enumerate(found, start=1)], inputs)


def _on_inputs(
    index: int, guide: NamedGuide, own: Mapping[str, TriangleMesh], meshes: Mapping[str, TriangleMesh]
) -> NamedGuide:
    """Convert a guide from vertices of the originals, `own`, to those of the inputs, `meshes`."""
    label, points = guide.name or str(index), dict(guide.points)
    for name in points.keys() & own.keys():
        points[name] = vertex_of_shape(label, name, points[name], own[name], meshes[name])
    return NamedGuide(guide.name, points)


@contextmanager
def _originals(texts: Sequence[str], inputs: Sequence[bpy.types.Object]) -> Iterator[dict[str, bpy.types.Object]]:
    """Provide the objects that the inputs were made of, by the names of the inputs, in a scene with all Empties.

    Inputs that are not a single mesh with faces of a .blend are used themselves.
    """
    files: dict[Path, dict[str, bpy.types.Object]] = {}
    with only_kept_data(), scratch_scene() as scene:
        originals = {}
        for text, shape in zip(texts, inputs, strict=True):
            source = parse_source(text)
            if source.path.suffix.lower() == BLEND:
                file = source.path.resolve()
                if file not in files:
                    files[file] = appended_objects(file, None)
                originals[shape.name] = _mesh_of(files[file], source.object_name) or shape
            else:
                originals[shape.name] = shape
        empties = [obj for objects in files.values() for obj in objects.values() if obj.type == "EMPTY"]
        for obj in dict.fromkeys([*originals.values(), *empties]):
            scene.collection.objects.link(obj)
        yield originals


def _mesh_of(objects: Mapping[str, bpy.types.Object], name: str | None) -> bpy.types.Object | None:
    """Return a mesh with faces of a file by its name, or the only one; None if there is none."""
    meshes = {known: obj for known, obj in objects.items() if obj.type == "MESH" and obj.data.polygons}
    return meshes.get(name) if name is not None else next(iter(meshes.values()), None)


def _guides_by_names(kind: str, originals: Mapping[str, bpy.types.Object]) -> list[NamedGuide]:
    """Return the guides that marks of the same name define, with vertices of the originals, by the names of inputs."""
    objects, depsgraph = list(dict.fromkeys(originals.values())), bpy.context.evaluated_depsgraph_get()
    if kind == "empties":
        found = guides_from_empties(objects, depsgraph, list(bpy.context.scene.objects))
    else:
        found = {"groups": guides_from_groups, "bones": guides_from_bones}[kind](objects, depsgraph)
    if not found:
        raise InputError("No {word} have the same name on several shapes, so --guides finds nothing.", word=kind)
    return [
        NamedGuide(
            guide.name,
            {name: guide.points[obj.name] for name, obj in originals.items() if obj.name in guide.points},
        )
        for guide in found
    ]


def _read_guides(path: str) -> list[NamedGuide]:
    """Read the guides of a JSON file."""
    file = whole_path(path)
    if not file.exists():
        raise InputError(
            "--guides {word}: there is no such file; name groups, empties, bones or a JSON file.", word=path
        )
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError("The guides in {path} cannot be read ({reason}).", path=path, reason=str(error)) from error
    try:
        found = parsed_guides(text)
    except InputError as error:
        raise InputError("--guides {path}: {problem}", path=path, problem=error.sentence) from error
    if not found:
        raise InputError("{path} contains no guides.", path=path)
    return found
