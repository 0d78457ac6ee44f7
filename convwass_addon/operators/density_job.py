# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work on the surface of an object: reads, hands arrays over, and finds the object again when it is done."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Generic, TypeVar

import bpy

from ..applications.densities.density_settings import DensitySettings
from ..bridge.mesh_checks import other_vertices
from ..bridge.surfaces import read_surface
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Work, within
from ..sentence import Sentence
from .background import BackgroundOperator
from .mesh_writing import MeshWritingOperator
from .object_job import ObjectJob

if TYPE_CHECKING:
    from ..applications.densities.density_frames import DensityFrames
    from ..applications.densities.surface_densities import Surface

Result = TypeVar("Result")

# Share of a job that making the surface takes, as the progress tells it.
_SURFACE_SHARE = 0.1


class DensityJob(ObjectJob, Generic[Result]):
    """One piece of long work. Everything but :meth:`steps` belongs on the main thread.

    Attributes
    ----------
    found : Result or None
        What the work has returned, once it has.

    Parameters
    ----------
    context : bpy.types.Context
        For the object as modifiers leave it.
    obj : bpy.types.Object
        Whose surface it is.
    settings : DensitySettings
        For the blur and the substeps.
    solve : callable
        ``solve(surface, control)`` returns the work; it touches nothing of Blender.

    Raises
    ------
    InputError
        No mesh, or one without a surface.
    """

    def __init__(
        self,
        context: bpy.types.Context,
        obj: bpy.types.Object,
        settings: DensitySettings,
        solve: Callable[[Surface, Control], Work[Result]],
    ) -> None:
        gone = InputError("The object was deleted, or undone, while its densities were computed; start again.")
        super().__init__(obj, gone)
        reading = read_surface(obj, context.evaluated_depsgraph_get())
        self.ignored = reading.ignored
        self.warnings: list[Sentence] = []
        self._mesh, self._settings, self._solve = reading.mesh, settings, solve
        self._count = len(obj.data.vertices)
        self.found: Result | None = None

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Do the work, the first part of which is to make the surface, and keep what it finds."""
        from ..applications.densities.surface_densities import blur_notice, density_surface

        yield Progress(0.0, Sentence("Measuring the surface"))
        surface = density_surface(self._mesh, self._settings.blur, self._settings.substeps, control)
        notice = blur_notice(surface)
        self.warnings += [] if notice is None else [notice]
        self.found = yield from within(self._solve(surface, control), _SURFACE_SHARE, 1.0)

    def write(self, report: Progress[object]) -> None:
        """Leave the file as it is until the end."""

    def discard(self) -> None:
        """Forget what has been found."""
        self.found = None

    def target(self) -> bpy.types.Object:
        """Return the object; raises InputError where it is gone or has other vertices than it had."""
        obj = super().target()
        if len(obj.data.vertices) != self._count:
            raise other_vertices(obj)
        return obj


class DensityOperator(BackgroundOperator):
    """An operator of such work."""

    _job: DensityJob

    def _steps(self):
        return self._job.steps


class WritingDensityOperator(DensityOperator, MeshWritingOperator):
    """An operator of such work that ends with something written to the mesh."""


def slack_notices(frames: DensityFrames) -> list[Sentence]:
    """Say how many frames are less exact than asked for."""
    slack = [record for record in frames.records if not record["converged"]]
    if not slack:
        return []
    worst = max(record["marginal_error"] or 0.0 for record in slack)
    return [
        Sentence(
            "Frames that are less exact than asked for: {count} (marginal error up to {worst:.1%}); try more blur.",
            {"count": len(slack), "worst": worst},
        )
    ]
