# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Make skies between worlds, beside the user's work: a sequence of images, and a world that shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from numpy.typing import NDArray

from ..applications.skies.sky_settings import SkySettings
from ..bridge.handles import Handle
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Request, Work, within
from ..properties.light import SkyProperties
from ..sentence import Sentence
from .background import BackgroundOperator, is_idle
from .chosen_inputs import split_names
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.skies.sky_frames import SkyFrame
    from ..bridge.skies.sky_sequence import PlacedSky, SkyFiles

# Share of the work that reading the worlds takes.
_READING = 0.2


class WorldRequest(Request[NDArray[np.float64]]):
    """Asks for the sky of a world, which only the main thread can read.

    Parameters
    ----------
    place : int
        Place of the world.
    """

    def __init__(self, place: int) -> None:
        super().__init__()
        self.place = place


class SkyJob:
    """One sequence. Everything but :meth:`steps` belongs on the main thread.

    Parameters
    ----------
    worlds : list of bpy.types.World
        Two or more, in turn. Those that show no plain image are rendered, one for each request.
    height : int
        Of the skies, in pixels.
    files : SkyFiles
        Where they go.
    settings : SkySettings
        How.
    """

    def __init__(self, worlds: list[bpy.types.World], height: int, files: SkyFiles, settings: SkySettings) -> None:
        self.names = [world.name for world in worlds]
        self._worlds = [Handle.of("worlds", world) for world in worlds]
        self.files = files
        self._height, self._settings = height, settings
        self.ends: list[SkyFrame] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Ask for the skies of all worlds, then make those between them."""
        from ..bridge.skies.sky_sequence import sky_steps

        count, skies = len(self._worlds), []
        for place in range(count):
            message = Sentence("World {done} of {total}", {"done": place + 1, "total": count})
            request = WorldRequest(place)
            yield Progress(_READING * (place + 1) / count, message, request)
            skies.append(request.value)
        yield from within(sky_steps(skies, len(self.files.paths), self._settings, control), _READING, 1.0)

    def write(self, report: Progress[WorldRequest | PlacedSky]) -> None:
        """Read the world that is asked for, or write the sky that has been made."""
        from ..bridge.skies.sky_sequence import PlacedSky

        found = report.payload
        if isinstance(found, WorldRequest):
            found.answer(self._sky(found.place))
        elif isinstance(found, PlacedSky):
            self.files.write(found)
            if found.place in (0, len(self.files.paths) - 1):
                self.ends.append(found.frame)

    def _sky(self, place: int) -> NDArray[np.float64]:
        from ..bridge.skies.world_skies import world_sky

        world = self._worlds[place].find()
        if world is None:
            raise InputError("There is no world {name}.", name=self.names[place])
        return world_sky(world, self._height)

    def discard(self) -> None:
        """Remove what has been written; older files stay."""
        self.files.discard()

    def notices(self) -> list[Sentence]:
        """Say where no sun was found: there is nothing to move then."""
        if all(end.lamps for end in self.ends):
            return []
        return [Sentence("One of the skies has no sun that could move; what shines in the other one fades.")]


class CONVWASS_OT_blend_skies(SkyProperties, BackgroundOperator, bpy.types.Operator):
    """Make the skies between two worlds or more: suns move across the sky with their glow, the rest fades. Each frame becomes an image, and a new world shows them. Worlds that are not just an image are rendered, in the place of the last rendering"""  # noqa: E501

    bl_idname = "convwass.blend_skies"
    bl_label = "Blend Skies"
    bl_options = {"REGISTER", "UNDO"}

    worlds: StringProperty(
        name="Worlds",
        description="Names of two worlds or more to go through, one per line or with commas between them; empty for "
        "those that are chosen in the panel",
        options={"SKIP_SAVE"},
    )

    _job: SkyJob

    @classmethod
    def poll(cls, context):
        return is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.skies.sky_sequence import SkyFiles, fitting_height

        worlds = self._chosen(context)
        if self.frame_end <= self.frame_start:
            raise InputError("The last frame must come after the first one.")
        settings = self.sky_settings()
        height = fitting_height(self.width, settings)
        files = SkyFiles(self.folder, self.frame_start, self.frame_end - self.frame_start + 1)
        return SkyJob(worlds, height, files, settings)

    def _chosen(self, context: bpy.types.Context) -> list[bpy.types.World]:
        worlds = context.scene.convwass_sky.chosen_worlds
        if self.worlds.strip():
            worlds = [_named(name) for name in split_names(self.worlds)]
        if len(worlds) < 2:
            raise InputError("Choose two worlds or more, not {count}.", count=len(worlds))
        return worlds

    def _steps(self):
        return self._job.steps

    def _title(self):
        return rpt_("Blending skies")

    def _finish(self, context, job):
        from ..bridge.skies.world_skies import sequence_world

        job.files.finish()
        name = "{} {}".format(rpt_("Sky"), "-".join(job.names))
        world = sequence_world(name, job.files.paths, self.frame_start)
        self._own_scene(context).world = world
        text = rpt_("{:s} shows {:d} skies from {:s}")
        paths = job.files.paths
        tell(self, text.format(world.name, len(paths), str(paths[0].parent)), (), job.notices())
        return {"FINISHED"}


def _named(name: str) -> bpy.types.World:
    world = bpy.data.worlds.get(name)
    if world is None:
        raise InputError("There is no world {name}.", name=name)
    return world


classes = (CONVWASS_OT_blend_skies,)
