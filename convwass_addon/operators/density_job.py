# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Long work on the surface of an object: reads, hands arrays over, and finds the object again when it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import bpy

from ..applications.densities.density_frames import DensityFrames, DensityStep, joined_frames
from ..applications.densities.density_settings import DensitySettings
from ..applications.densities.surface_densities import Surface, blur_notice, density_surface
from ..bridge.mesh_checks import other_vertices
from ..bridge.surfaces import read_surface
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control
from ..sentence import Sentence
from .background import BackgroundOperator
from .mesh_writing import MeshWritingOperator
from .object_job import ObjectJob

# Share of a job that making the surface takes, as the progress tells it.
_SURFACE_SHARE = 0.1


@dataclass(frozen=True)
class FoundStep(DensityStep):
    """A step that ends with something else than frames.

    Attributes
    ----------
    found : object
        What has been found out.
    """

    found: object = None


class DensityJob(ObjectJob):
    """One piece of long work. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    context : bpy.types.Context
        For the object as modifiers leave it.
    obj : bpy.types.Object
        Whose surface it is.
    settings : DensitySettings
        For the blur and the substeps.
    solve : callable
        ``solve(surface, control)`` yields the steps; it touches nothing of Blender.

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
        solve: Callable[[Surface, Control], Iterator[DensityStep]],
    ) -> None:
        gone = InputError("The object was deleted, or undone, while its densities were computed; start again.")
        super().__init__(obj, gone)
        reading = read_surface(obj, context.evaluated_depsgraph_get())
        self.ignored = reading.ignored
        self.warnings: list[Sentence] = []
        self._mesh, self._settings, self._solve = reading.mesh, settings, solve
        self._count = len(obj.data.vertices)
        self._steps: list[DensityStep] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Iterator[DensityStep]:
        """Yield the steps of the work, the first one of which is to make the surface."""
        yield DensityStep(0.0, Sentence("Measuring the surface"))
        surface = density_surface(self._mesh, self._settings.blur, self._settings.substeps, control)
        notice = blur_notice(surface)
        self.warnings += [] if notice is None else [notice]
        for step in self._solve(surface, control):
            share = _SURFACE_SHARE + (1.0 - _SURFACE_SHARE) * step.fraction
            yield FoundStep(share, step.message, step.frames, getattr(step, "found", None))

    def write(self, step: DensityStep) -> None:
        """Take what a step has brought; the file stays as it is until the end."""
        self._steps.append(step)

    def discard(self) -> None:
        """Forget it."""
        self._steps.clear()

    @property
    def frames(self) -> DensityFrames:
        """The frames that have been made."""
        return joined_frames(self._steps)

    @property
    def found(self) -> object:
        """What has been found out."""
        return self._steps[-1].found

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
