# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Blend the skies of worlds in the background, into a sequence of images and a world that shows it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy
import numpy as np
from bpy.app.translations import pgettext_rpt as rpt_
from bpy.props import StringProperty
from numpy.typing import NDArray

from ..applications.skies.sky_settings import SkySettings
from ..applications.whole_paths import share_a_place
from ..bridge.handles import Handle
from ..errors import InputError
from ..progress import UNINTERRUPTED, Control, Progress, Request, Work, within
from ..properties.light import SkyProperties
from ..sentence import Sentence, first_names
from .background import BackgroundOperator, is_idle
from .chosen_inputs import split_names
from .reporting import tell

if TYPE_CHECKING:
    from ..applications.skies.sky_frames import SkyFrame
    from ..bridge.skies.sky_sequence import PlacedSky, SkyFiles

# Share of the work for reading the worlds.
_READING = 0.2


class WorldRequest(Request[NDArray[np.float64]]):
    """Requests the sky of a world, which only the main thread can read.

    Parameters
    ----------
    place : int
        Index of the world.
    """

    def __init__(self, place: int) -> None:
        super().__init__()
        self.place = place


class SkyJob:
    """Blends a sequence of skies. All methods except :meth:`steps` must be called on the main thread.

    Parameters
    ----------
    worlds : list of bpy.types.World
        Two or more, in order. Worlds that are not plain images are rendered when requested.
    height : int
        Height of the skies in pixels.
    files : SkyFiles
        Output files.
    settings : SkySettings
        Settings of the suns.
    """

    def __init__(self, worlds: list[bpy.types.World], height: int, files: SkyFiles, settings: SkySettings) -> None:
        self.names = [world.name for world in worlds]
        self._worlds = [Handle.of("worlds", world) for world in worlds]
        self.files = files
        self._height, self._settings = height, settings
        self.ends: list[SkyFrame] = []

    def steps(self, control: Control = UNINTERRUPTED) -> Work[None]:
        """Request the skies of all worlds, then interpolate between them."""
        from ..bridge.skies.sky_sequence import sky_steps

        count, skies = len(self._worlds), []
        for place in range(count):
            message = Sentence("World {done} of {total}", {"done": place + 1, "total": count})
            request = WorldRequest(place)
            yield Progress(_READING * (place + 1) / count, message, request)
            skies.append(request.value)
        yield from within(sky_steps(skies, len(self.files.paths), self._settings, control), _READING, 1.0)

    def write(self, report: Progress[WorldRequest | PlacedSky]) -> None:
        """Read the requested world, or write a finished sky."""
        from ..bridge.skies.sky_sequence import PlacedSky

        found = report.payload
        if isinstance(found, WorldRequest):
            found.answer(self._sky(found.place))
        elif isinstance(found, PlacedSky):
            self.files.write(found)
            if found.place in (0, len(self.files.paths) - 1):
                self.ends.append(found.frame)

    def _sky(self, place: int) -> NDArray[np.float64]:
        from ..applications.skies.sky_frames import require_light
        from ..bridge.skies.world_skies import world_sky

        world = self._worlds[place].living(InputError("There is no world {name}.", name=self.names[place]))
        sky = world_sky(world, self._height)
        require_light(sky, world.name)
        return sky

    def discard(self) -> None:
        """Remove the files written so far; older files are kept."""
        self.files.discard()

    def notices(self) -> list[Sentence]:
        """Return a notice if only one sky has suns, which then cannot move."""
        if len({bool(end.lamps) for end in self.ends}) < 2:
            return []
        return [Sentence("One of the skies has no sun, so the suns of the other one fade instead of moving.")]


class CONVWASS_OT_blend_skies(SkyProperties, BackgroundOperator, bpy.types.Operator):
    """Blend the skies of two or more worlds: suns move across the sky with their glow, everything else cross-fades. Each frame becomes an image, and a new world shows them. Worlds that are not plain images are rendered, which replaces the Render Result"""  # noqa: E501

    bl_idname = "convwass.blend_skies"
    bl_label = "Blend Skies"
    bl_options = {"REGISTER", "UNDO"}
    _title = Sentence("Blending skies")

    worlds: StringProperty(
        name="Worlds",
        description="Names of two or more worlds in order, one per line or separated by commas; empty for the worlds "
        "chosen in the panel",
        options={"SKIP_SAVE"},
    )

    @classmethod
    def poll(cls, context):
        return is_idle(cls, context)

    def _begin(self, context):
        from ..bridge.skies.sky_sequence import SkyFiles, fitting_height
        from ..bridge.skies.world_skies import shown_files

        worlds = self._chosen(context)
        if self.frame_end <= self.frame_start:
            raise InputError("The last frame must come after the first one.")
        settings = self.sky_settings()
        height = fitting_height(self.width, settings)
        files = SkyFiles(self.folder, self.frame_start, self.frame_end - self.frame_start + 1)
        for world in worlds:
            if share_a_place(files.paths, shown_files(world)):
                raise InputError(
                    "The images of {world} in {folder} would be overwritten; choose another folder.",
                    world=world.name,
                    folder=str(files.paths[0].parent),
                )
        return SkyJob(worlds, height, files, settings)

    def _chosen(self, context: bpy.types.Context) -> list[bpy.types.World]:
        worlds = context.scene.convwass_sky.chosen_worlds
        if self.worlds.strip():
            worlds = [_named(name) for name in split_names(self.worlds, bpy.data.worlds)]
        if len(worlds) < 2:
            raise InputError("Choose at least two worlds, not {count}.", count=len(worlds))
        return worlds

    def _finish(self, context, job):
        from ..bridge.skies.world_skies import sequence_world, shown_files

        job.files.finish()
        name = "{} {}".format(rpt_("Sky"), "-".join(job.names))
        scene = self._own_scene(context)
        world = sequence_world(name, job.files.paths, self.frame_start, scene)
        before, scene.world = scene.world, world
        # Blender does not save worlds without users.
        if before is not None and not before.users:
            before.use_fake_user = True
        text = rpt_("{:s} shows {:d} skies from {:s}")
        paths = job.files.paths
        others = [own for own in bpy.data.worlds if own != world and share_a_place(paths, shown_files(own))]
        warnings = [*job.notices(), *_replaced_notice(others)]
        tell(self, text.format(world.name, len(paths), str(paths[0].parent)), (), warnings)
        return {"FINISHED"}


def _replaced_notice(worlds: Sequence[bpy.types.World]) -> list[Sentence]:
    """Return a notice about worlds that show the new images instead of their own."""
    if not worlds:
        return []
    names = {"worlds": first_names([world.name for world in worlds])}
    return [Sentence("These worlds show the new images, too, which have replaced theirs: {worlds}.", names)]


def _named(name: str) -> bpy.types.World:
    world = bpy.data.worlds.get(name)
    if world is None:
        raise InputError("There is no world {name}.", name=name)
    return world


classes = (CONVWASS_OT_blend_skies,)
