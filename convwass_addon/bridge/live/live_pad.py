# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The pad of a live morph: a line, triangle or square in the scene, with a handle and names at its corners."""

from __future__ import annotations

from collections.abc import Sequence

import bpy
import numpy as np
from numpy.typing import NDArray

from ...applications.live.pad_places import pad_corners, pad_middle, pad_points
from ..handles import Handle
from ..pad_handles import OUTLINES, pad_handle, pad_labels, pad_lines

# Side of a pad and distance from the shapes, relative to the largest shape; lengths on the pad, relative to its side.
_SIDE, _GAP = 1.5, 0.3
_HANDLE, _TEXT = 0.04, 0.06


class LivePad:
    """The objects of a pad.

    Parameters
    ----------
    collection : bpy.types.Collection
        Collection for the objects.
    names : sequence of str
        Names of the two to four shapes.
    bounds : (2, 3) float64
        Bounds of all shapes, world space.
    size : float
        Size of the largest shape.
    """

    def __init__(
        self, collection: bpy.types.Collection, names: Sequence[str], bounds: NDArray[np.float64], size: float
    ) -> None:
        self.count, self.side = len(names), _SIDE * size
        points = self._local(pad_corners(self.count))
        self._low, self._high = points.min(axis=0), points.max(axis=0)
        pad = pad_lines("Live Pad", points, OUTLINES[self.count])
        pad.hide_select = True
        pad.location = self._location(bounds, size)
        handle = pad_handle("Live Handle", _HANDLE * self.side, points, pad)
        handle.hide_render = True
        labels = pad_labels(names, points, _TEXT * self.side, pad, called="Live Label {}")
        for obj in (pad, handle, *labels):
            collection.objects.link(obj)
        self._pad, self._handle = Handle.of("objects", pad), Handle.of("objects", handle)
        self.move_to(*pad_middle(self.count))

    @property
    def handle(self) -> bpy.types.Object | None:
        """The handle to drag; None if it was deleted."""
        return self._handle.find()

    @property
    def pad(self) -> bpy.types.Object | None:
        """The visible pad; None if it was deleted."""
        return self._pad.find()

    @property
    def place(self) -> tuple[float, float] | None:
        """Position of the handle, across and up, from 0 to 1; None if it was deleted."""
        handle = self.handle
        return None if handle is None else self.place_at(handle.location)

    def place_at(self, point: Sequence[float]) -> tuple[float, float]:
        """Return the position of a point in local space of the pad, (3,)."""
        extent = np.maximum(self._high - self._low, 1e-9 * self.side)
        place = (np.asarray(point, np.float64) - self._low) / extent
        across, _, up = np.clip(np.nan_to_num(place), 0.0, 1.0)
        return float(across), float(up) if self.count > 2 else 0.0

    def move_to(self, across: float, up: float) -> None:
        """Move the handle."""
        handle = self.handle
        if handle is not None:
            (point,) = self._local(np.clip([[across, up]], 0.0, 1.0))
            handle.location = point

    def _local(self, places: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return positions in local space of the pad, in its XZ plane, (n, 3)."""
        return self.side * pad_points(self.count, places)

    def _location(self, bounds: NDArray[np.float64], size: float) -> NDArray[np.float64]:
        """Return the origin of the pad: a line is below the shapes, other pads are to their left."""
        middle, (low, _) = bounds.mean(axis=0), bounds
        if self.count == 2:
            return np.array([middle[0], middle[1], low[2] - _GAP * size])
        return np.array([low[0] - _GAP * size - self.side / 2.0, middle[1], low[2] - self._low[2]])
