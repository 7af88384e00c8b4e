# SPDX-License-Identifier: Apache-2.0
"""Pictures of one material as each host shows it, for the page on which hosts stand together."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

import mxeon
from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.conformance.probes.pictures import Mask, PictureProbe, picture_pairs
from mxeon.conformance.probes.probe import Probe
from mxeon.conformance.probes.rendered import RenderedSamples
from mxeon.conformance.probes.renderer_nodes import FacetPairProbe, FacetProbe
from mxeon.conformance.results import PORTRAIT, Picture
from mxeon.conformance.samples.batch import Array, Batch, Values, rounded
from mxeon.shaders.facets import facet_points
from mxeon.shaders.scene import BACK, SIDE, Scene, sphere

INPUTS: Values = {"color": (0.8, 0.4, 0.1), "roughness": 1.0}
SIZE = 96
SCENES = tuple(replace(scene, size=SIZE) for scene in (SIDE, BACK))


def comparison_pictures(probe: Probe) -> tuple[Picture, ...]:
    """Pictures of a rough node in light from the side and from behind, each beside its model's.

    None for a surface shader's lobe, and on a renderer without exact mirror pairs. Rim and
    terminator are black in both.
    """
    if not isinstance(probe.subject, DiffuseSubject) or isinstance(probe, RenderedSamples):
        return ()
    points = ((scene, *_points(probe, scene)) for scene in SCENES)
    return tuple(_comparison(probe, *each) for each in points if len(each[1].wo))


def _comparison(probe: Probe, scene: Scene, batch: Batch, where: Mask) -> Picture:
    subject, host = probe.subject, probe.host
    names = (PORTRAIT, subject.title, host.name, probe.library, scene.name)
    keys = ("document", "element", "host", "library", "scene")
    metadata = dict(zip(keys, names, strict=True)) | {"version": mxeon.__version__}
    metadata |= {"points": host.name}  # which differ where a host has its model in part
    image = _picture(probe.direct(batch), where)
    return Picture(*names, image, _picture(batch.expected(subject.model), where), metadata)


def _picture(values: Array, where: Mask) -> NDArray[np.float32]:
    picture = np.zeros((*where.shape, 3), dtype=np.float32)
    picture[where] = values
    return picture


def _points(probe: Probe, scene: Scene) -> tuple[Batch, Mask]:
    """The pairs of a picture, and the pixels where they are, (size, size)."""
    if isinstance(probe, PictureProbe) and not isinstance(probe, FacetPairProbe):
        wo, wi, judged = probe.points(scene)
    else:
        wo, wi, judged = picture_pairs(scene)
        wo, wi = rounded(wo.T), rounded(wi.T)
    faceted = isinstance(probe, FacetProbe) and not isinstance(probe, FacetPairProbe)
    where = (facet_points(scene.size) if faceted else sphere(scene.size)).mask.copy()
    where[where] = judged
    return Batch(wo[judged], wi[judged], INPUTS, scene), where
