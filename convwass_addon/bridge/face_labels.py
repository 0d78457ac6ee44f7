# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assign the triangles of an object to parts by vertex groups or materials."""

from __future__ import annotations

from collections import Counter

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..applications.morphs.part_labels import FaceLabels
from .element_values import triangle_corners, triangle_materials
from .object_names import without_number
from .vertex_groups import mesh_weights


def vertex_group_labels(evaluated: bpy.types.Object, mesh: bpy.types.Mesh) -> FaceLabels:
    """Label triangles with the vertex group of the largest weight on their corners.

    If the weights of a vertex sum to less than one, the remainder counts as unlabeled.

    Parameters
    ----------
    evaluated : bpy.types.Object
        Provides the names of the groups.
    mesh : bpy.types.Mesh
        Its mesh, with all data layers, in the file.
    """
    names = tuple(group.name for group in evaluated.vertex_groups)
    weights = mesh_weights(mesh, names, range(len(names)))
    groups, vertices = np.nonzero(weights)
    given = weights[groups, vertices].astype(np.float64)
    lacking = 1.0 - np.bincount(vertices, given, minlength=len(mesh.vertices))
    everything = np.arange(len(mesh.vertices))
    of_vertices = csr_array(
        (
            np.concatenate([given, np.maximum(lacking, 0.0)]),
            (np.concatenate([vertices, everything]), np.concatenate([groups, np.full(len(everything), len(names))])),
        ),
        shape=(len(mesh.vertices), len(names) + 1),
    )
    corners = triangle_corners(mesh, "vertices").ravel()
    incidence = csr_array(
        (np.ones(len(corners)), corners, np.arange(0, len(corners) + 1, 3)),
        shape=(len(corners) // 3, len(mesh.vertices)),
    )
    heaviest = _heaviest(incidence @ of_vertices)
    return FaceLabels(names, np.where(heaviest < len(names), heaviest, -1))


def _heaviest(weights: csr_array) -> NDArray[np.int64]:
    """Return the first column of the largest weight in every row; each has a positive one.

    SciPy goes through the rows one by one, and takes seconds for a million.
    """
    weights.sum_duplicates()
    starts = weights.indptr[:-1]
    largest = np.repeat(np.maximum.reduceat(weights.data, starts), np.diff(weights.indptr))
    columns = np.where(weights.data == largest, weights.indices, weights.shape[1])
    return np.minimum.reduceat(columns, starts).astype(np.int64)


def material_labels(evaluated: bpy.types.Object, mesh: bpy.types.Mesh) -> FaceLabels:
    """Label triangles with the material of their slot.

    Blender numbers duplicate material names, so "Head.001" of one object matches "Head" of another, unless an object
    has both.

    Parameters
    ----------
    evaluated, mesh
        As for :func:`vertex_group_labels`.
    """
    slots = [slot.material.name if slot.material else "" for slot in evaluated.material_slots]
    plain = {name: without_number(name) for name in slots if name}
    counts = Counter(plain.values())
    called = {name: own if counts[own] == 1 else name for name, own in plain.items()}
    names = tuple(called.values())
    places = {name: index for index, name in enumerate(called)}
    table = np.array([*(places.get(name, -1) for name in slots), -1])
    index = triangle_materials(mesh)
    # A face may have an invalid slot index; Blender then uses the last slot.
    return FaceLabels(names, table[np.minimum(index, max(len(slots) - 1, 0))])


LABELS = {"vertex-groups": vertex_group_labels, "materials": material_labels}
"""The labeling functions, by the name of the option."""
