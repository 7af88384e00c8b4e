# SPDX-License-Identifier: Apache-2.0
"""Figures in the sentences of pages that a shader on OpenGL shows."""

from contextlib import closing
from functools import cache
from pathlib import Path

import numpy as np

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.probes.bsdf import MicrofacetProbe
from mxeon.conformance.samples.batch import Batch
from mxeon.hosts import open_host
from mxeon.models.media.subsurface import diffusion_blur
from mxeon.shaders.library import eonlib_folder

REACHES = (0.1, 0.2, 0.6)  # of the profile; between them and beyond errors are smaller
COSINES = np.linspace(-1.0, 1.0, 401).astype(np.float32).astype(np.float64)
CHANGES = {"color82": 0.3, "exponent": 1.0}  # of the default node, color82 1 and exponent 5


@cache
def blur_error():
    """Largest error of eonlib's blur of subsurface scattering against that of the profile."""
    source = Path(eonlib_folder(), "genglsl", "subsurface_blur.glsl").read_text(encoding="utf-8")
    with closing(open_host("gl")) as host:
        errors = [
            host.execute(source, "subsurface_blur", COSINES, np.full_like(COSINES, reach))[:, 0]
            - diffusion_blur(COSINES, reach)
            for reach in REACHES
        ]
    return np.abs(errors).max()


def throughput_changes():
    """Changes of stock's throughput of generalized Schlick, color0 0.6, by color82 and the exponent."""
    [subject] = [
        each
        for each in BSDFS
        if each.node == "generalized_schlick_bsdf" and "film" not in each.title
    ]
    with closing(open_host("gl")) as host:
        probe = MicrofacetProbe(host, subject, "stock")
        return {
            f"{name}_{branch}": _change(probe, branch, name, value)
            for name, value in CHANGES.items()
            for branch in ("direct", "transmission")
        }


def _change(probe, branch, name, value):
    """Largest change of the throughput over views, lights opposite to them, and alpha from 0.05 on."""
    mu, light, alpha = (
        each.ravel()
        for each in np.meshgrid(
            np.linspace(0.02, 1.0, 50), np.linspace(0.02, 1.0, 25), np.linspace(0.05, 1.0, 6)
        )
    )
    wo, wi = (
        np.stack([side * np.sqrt(1.0 - z * z), 0.0 * z, z], axis=-1)
        for side, z in ((1.0, mu), (-1.0, light))
    )
    colors = {
        "color0": np.full_like(wo, 0.6),
        "color82": np.ones_like(wo),
        "color90": np.ones_like(wo),
    }
    inputs = colors | {
        "exponent": np.full_like(mu, 5.0),
        "roughness": np.stack([alpha, alpha], axis=-1),
    }
    changed = inputs | {name: np.full_like(inputs[name], value)}
    first, second = (probe.throughput(Batch(wo, wi, each), branch) for each in (inputs, changed))
    return np.abs(first - second).max()
