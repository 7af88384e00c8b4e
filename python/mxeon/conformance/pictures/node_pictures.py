# SPDX-License-Identifier: Apache-2.0
"""Pictures of one material as each host shows it, for the page on which hosts stand together."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import mxeon
from mxeon.conformance.backends import Mask, Rendered
from mxeon.conformance.case import Case
from mxeon.conformance.results import PORTRAIT, Picture
from mxeon.conformance.samples import Array, Batch, Values
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, SurfaceLobe, model_value
from mxeon.shaders.scene import BACK, SIDE, Scene

INPUTS: Values = {"color": (0.8, 0.4, 0.1), "roughness": 1.0}
SIZE = 96
SCENES = tuple(replace(scene, size=SIZE) for scene in (SIDE, BACK))


def comparison_pictures(case: Case) -> tuple[Picture, ...]:
    """Pictures of a rough node in light from the side and from behind, each beside its model's.

    None for a surface shader's lobe, and on a renderer without exact mirror pairs. Rim and
    terminator are black in both.
    """
    rough = isinstance(case.spec, DiffuseModelSpec) and not isinstance(case.spec, SurfaceLobe)
    if not rough or isinstance(case.backend, Rendered):
        return ()
    pictures = []
    for scene in SCENES:
        wo, wi, judged, mask = case.backend.portrait(scene)
        where = mask.copy()
        where[where] = judged
        if judged.any():
            batch = Batch(wo[judged], wi[judged], INPUTS, scene)
            pictures.append(_comparison(case, scene, batch, where))
    return tuple(pictures)


def _comparison(case: Case, scene: Scene, batch: Batch, where: Mask) -> Picture:
    names = (PORTRAIT, case.spec.title, case.host.name, case.library, scene.name)
    keys = ("document", "element", "host", "library", "scene")
    metadata = dict(zip(keys, names, strict=True)) | {"version": mxeon.__version__}
    metadata |= {"points": case.host.name}  # which differ where a host has its model in part
    image = _picture(case.direct(batch), where)
    expected = _picture(model_value(batch, case.spec.model), where)
    return Picture(*names, image, expected, metadata)


def _picture(values: Array, where: Mask) -> NDArray[np.float32]:
    picture = np.zeros((*where.shape, 3), dtype=np.float32)
    picture[where] = values
    return picture
