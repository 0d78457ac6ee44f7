# SPDX-FileCopyrightText: 2026 Convwass authors
# SPDX-License-Identifier: GPL-3.0-or-later
"""Functional maps by pyFM for the pairs of the soft map benchmark; runs in the peers' environment.

``python -m benchmarks.soft_map_peers CASE OPTIONS`` prints one line of JSON. Imports nothing from the add-on.
"""

from __future__ import annotations

import contextlib
import io
import time
import warnings

import numpy as np

from .processes import run_case

# Numbers of functions of the first fit and of the refined map, as in pyFM's examples.
_FIRST, _LAST, _STEP = 30, 150, 5


def functional_map(path: str, landmarks: int, fitted: str, refined: str) -> dict[str, object]:
    """Fit a functional map to wave kernel signatures and landmarks, refine it by ZoomOut, and write both matches."""
    from pyFM.functional import FunctionalMapping
    from pyFM.mesh import TriMesh

    with np.load(path) as stored:
        data = dict(stored)
    begun = time.process_time()
    with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("ignore")
        # pyFM's maps go from the second mesh to the first.
        meshes = [TriMesh(data[side], data[f"{side}_faces"], area_normalize=True) for side in ("target", "source")]
        for mesh in meshes:
            mesh.process(k=_LAST)
        model = FunctionalMapping(*meshes)
        model.preprocess(
            n_descr=100,
            descr_type="WKS",
            landmarks=data["landmarks"][:landmarks, ::-1],
            subsample_step=5,
            k_process=_LAST,
        )
        model.fit(K=(_FIRST, _FIRST))
        np.save(fitted, model.get_p2p())
        matrix = model.zoomout_refine(nit=(_LAST - _FIRST) // _STEP, step=_STEP)
        np.save(refined, model.get_p2p(matrix))
    return {"seconds": time.process_time() - begun}


if __name__ == "__main__":
    run_case(functional_map)
