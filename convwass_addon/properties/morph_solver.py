# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings of what solves morphs."""

from __future__ import annotations

from ..applications.flat.flat_settings import FlatSettings
from ..applications.morphs.morph_settings import MorphSettings
from ..schema import settings_of
from .from_schema import values_of, with_properties

OF_FLAT = ("resolution", "words")
"""The settings of flat shapes that those of solid ones do not hold."""


@with_properties(FlatSettings, only=OF_FLAT)
@with_properties(MorphSettings)
class SolverProperties:
    """What the solver of a morph is asked for."""

    def solver_settings(self) -> MorphSettings:
        """Return the settings of the application; raises InputError where they make no sense."""
        return MorphSettings(**values_of(self, MorphSettings))

    def flat_settings(self) -> FlatSettings:
        """Return the settings of the application where all shapes are flat; raises InputError as above."""
        return FlatSettings(**values_of(self, FlatSettings) | {"parts": "none"})

    def begin_preset(self) -> None:
        """Give all that a preset sets its default; shipped presets only say what they change."""
        for name in (name for one in settings_of(MorphSettings) if one.preset for name in one.properties):
            setattr(self, name, self.bl_rna.properties[name].default)
