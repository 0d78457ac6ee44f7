# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""The guided motion of flat shapes whose outlines are mapped onto each other completely."""

from __future__ import annotations

from collections.abc import Sequence

from ...geometry.plane.planar_fill import Boundary
from ...progress import Control
from ..motions.guided_settings import GuidedSettings
from ..motions.motion_choice import attempted
from .limb_motion import with_limbs
from .matched_motion import have_few_regions, matched_motion
from .matched_outlines import only_placed
from .moved_sheets import MovedSheets
from .outline_pairs import KnownMatches
from .outlined_shape import OutlinedShape
from .vanishing_limbs import shape_bodies


def outline_motion(
    parts: Sequence[Boundary],
    names: Sequence[str],
    pairs: Sequence[tuple[int, int]],
    settings: GuidedSettings,
    control: Control,
) -> MovedSheets | None:
    """Return the guided motion of flat shapes, or None if one has too many regions, or none.

    Limbs that vanish are cut off, and retract into what is left, unless they would collide. That moves as its outlines
    are matched; see :func:`.matched_motion.matched_motion`.

    Parameters
    ----------
    parts : sequence of Boundary
        The shapes.
    names : sequence of str
        Names of the shapes, for messages.
    pairs : sequence of (int, int)
        Shapes that occur together in a blend.
    settings : GuidedSettings
        Its `coherence` and `mean_stretch` are used.
    control : Control
        Stops the work.

    Returns
    -------
    MovedSheets or None
        If limbs retract, its motion is a :class:`.limb_motion.LimbMotion`.
    """
    shapes, known = [OutlinedShape.of(part) for part in parts], KnownMatches()
    if not have_few_regions(shapes):
        return None
    bodies = attempted(shape_bodies, shapes, pairs, known, control)
    if bodies is not None and any(own.limbs for own in bodies):
        # Limbs were chosen for bodies that stay as they stand.
        left, upright = [own.shape for own in bodies], KnownMatches(only_placed)
        moved = attempted(matched_motion, left, names, pairs, settings, upright, control)
        whole = None if moved is None else attempted(with_limbs, moved, parts, bodies, pairs)
        if whole is not None:
            return whole
    return matched_motion(shapes, names, pairs, settings, known, control)
