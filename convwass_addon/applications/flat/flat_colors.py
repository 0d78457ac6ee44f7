# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Colors of flat blends: those at the origins of their matter on the inputs, mixed with the weights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from ...errors import InputError
from ...geometry.arrays.integer_ranges import integer_ranges
from ...geometry.plane.planar_fill import Boundary
from .flat_frames import FlatFrame
from .flat_pieces import filled_layer, layers_of
from .flat_shapes import FlatImage, FlatInput, FlatShape

# Samples of an outline for colors, along its longest side.
_SAMPLES = 512.0
# Pixels of lower opacity have no color.
_OPAQUE = 0.5


def carried_colors(
    points: NDArray[np.float64], frame: FlatFrame, shapes: Sequence[FlatInput]
) -> NDArray[np.float64] | None:
    """Return the colors of points of a blend.

    Parameters
    ----------
    points : (n, 2)
        In or on the blend, scene units.
    frame : FlatFrame
        The blend, computed with the setting `carry`.
    shapes : sequence of FlatShape or FlatImage
        The inputs.

    Returns
    -------
    (n, 4) float64 or None
        Red, green, blue, opacity, linear; None if no input with weight has colors.

    Raises
    ------
    InputError
        The blend has no origins.
    """
    weights = np.array(frame.blend.weights)
    known = [index for index in np.flatnonzero(weights) if shapes[index].colors is not None]
    if not known:
        return None
    if frame.blend.source is not None:
        return colors_at(points, shapes[frame.blend.source])
    if frame.origins is None:
        raise InputError("These frames do not know where their matter comes from; make them again with colors carried.")
    places = frame.origins.at(points)
    mixed = sum(weights[index] * colors_at(places[index], shapes[index]) for index in known)
    return mixed / weights[known].sum()


def colors_at(points: NDArray[np.float64], shape: FlatInput) -> NDArray[np.float64]:
    """Return the colors of an input at points, (n, 4); outside it, those of the nearest colored point."""
    return _of_image(points, shape) if isinstance(shape, FlatImage) else _of_layers(points, shape)


def _of_image(points: NDArray[np.float64], image: FlatImage) -> NDArray[np.float64]:
    cells = np.floor((points - np.asarray(image.corner)) / image.pixel).astype(np.int64)
    cells = np.clip(cells, 0, np.subtract(image.values.shape, 1))
    opaque = image.colors[..., 3] >= _OPAQUE
    if opaque.any():
        nearest = distance_transform_edt(~opaque, return_distances=False, return_indices=True)
        cells = np.stack([nearest[axis][tuple(cells.T)] for axis in range(2)], axis=1)
    return np.asarray(image.colors, dtype=np.float64)[tuple(cells.T)]


def _of_layers(points: NDArray[np.float64], shape: FlatShape) -> NDArray[np.float64]:
    """Return the color of the top layer that contains each point, or of the nearest layer."""
    layers = layers_of(shape)
    colors = np.stack([shape.colors[layer[0]] for layer in layers]).astype(np.float64)
    if len(layers) == 1:
        return np.repeat(colors, len(points), axis=0)
    boundaries = [filled_layer(shape, layer) for layer in layers]
    found = np.full(len(points), -1)
    for index, boundary in enumerate(boundaries):
        found[boundary.contains(points)] = index
    outside = np.flatnonzero(found < 0)
    if len(outside):
        samples = [_samples(boundary) for boundary in boundaries]
        owners = np.repeat(np.arange(len(samples)), [len(own) for own in samples])
        found[outside] = owners[cKDTree(np.concatenate(samples)).query(points[outside])[1]]
    return colors[found]


def _samples(boundary: Boundary) -> NDArray[np.float64]:
    """Return points along a boundary."""
    if not len(boundary.starts):
        return np.zeros((0, 2))
    along = boundary.ends - boundary.starts
    step = float(np.ptp(boundary.bounds, axis=0).max()) / _SAMPLES
    counts = np.ceil(np.linalg.norm(along, axis=1) / step).astype(np.int64)
    edge, place = integer_ranges(0, counts)
    return boundary.starts[edge] + (place / counts[edge])[:, None] * along[edge]
