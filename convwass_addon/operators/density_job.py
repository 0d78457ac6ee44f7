# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work on the surface of an object."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, TypeVar

import bpy

from ..applications.densities.density_settings import DensitySettings
from ..bridge.mesh_checks import other_vertices
from ..bridge.surfaces import ignored_notices, read_surface
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work, within
from ..sentence import Sentence
from .object_job import ObjectJob

if TYPE_CHECKING:
    from ..applications.densities.density_frames import DensityFrames
    from ..applications.densities.surface_densities import Surface

Result = TypeVar("Result")

# Share of the progress bar for building the surface.
_SURFACE_SHARE = 0.1


class DensityJob(ObjectJob, Generic[Result]):
    """A computation on a surface. All methods except :meth:`steps` must be called on the main thread.

    Attributes
    ----------
    found : Result or None
        The result of the work, once finished.

    Parameters
    ----------
    obj : bpy.types.Object
        The object with the surface.
    settings : DensitySettings
        Blur and substeps.
    solve : callable
        ``solve(surface, control)`` returns the work; it does not access Blender's data.

    Raises
    ------
    InputError
        The object is not a mesh, or has no surface.
    """

    def __init__(
        self,
        obj: bpy.types.Object,
        settings: DensitySettings,
        solve: Callable[[Surface, Control], Work[Result]],
    ) -> None:
        gone = InputError("The object was deleted, or its creation undone, during the computation; start again.")
        super().__init__(obj, gone)
        reading = read_surface(obj, bpy.context.evaluated_depsgraph_get())
        self.remarks = ignored_notices([reading])
        self.warnings: list[Sentence] = []
        self._mesh, self._settings, self._solve = reading.mesh, settings, solve
        self._count = len(obj.data.vertices)
        self.found: Result | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Build the surface, compute the result and keep it."""
        from ..applications.densities.surface_densities import blur_notice, density_surface

        yield Progress(0.0, Sentence("Building the surface"))
        surface = density_surface(self._mesh, self._settings.blur, self._settings.substeps, control)
        notice = blur_notice(surface)
        self.warnings += [] if notice is None else [notice]
        self.found = yield from within(self._solve(surface, control), _SURFACE_SHARE, 1.0)

    def discard(self) -> None:
        """Discard the result."""
        self.found = None

    def target(self) -> bpy.types.Object:
        """Return the object; raises InputError if it was deleted or its vertices have changed."""
        obj = super().target()
        if len(obj.data.vertices) != self._count:
            raise other_vertices(obj)
        return obj


def slack_notices(frames: DensityFrames) -> list[Sentence]:
    """Return a notice if frames are less exact than requested."""
    slack = [record for record in frames.records if not record["converged"]]
    if not slack:
        return []
    worst = max(record["marginal_error"] or 0.0 for record in slack)
    return [
        Sentence(
            "Frames less exact than requested: {count} (marginal error up to {worst:.1%}); try more blur.",
            {"count": len(slack), "worst": worst},
        )
    ]
