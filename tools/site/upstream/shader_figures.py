# SPDX-License-Identifier: Apache-2.0
"""Figures in the sentences of pages that a shader on OpenGL shows."""

from contextlib import closing
from functools import cache

import numpy as np

from mxeon.conformance.nodes.bsdf import BSDFS
from mxeon.conformance.probes.bsdf import MicrofacetProbe
from mxeon.conformance.probes.families import PBR_SUBJECTS, probe_type, probe_type_of
from mxeon.conformance.samples.batch import SEED, Batch, directions, rounded
from mxeon.hosts import open_host
from mxeon.models.media.subsurface import diffusion_blur
from mxeon.shaders.functions import source_file

REACHES = (0.1, 0.153, 0.154, 0.5)  # of the profile; the largest errors are at these, within 1e-4
COSINES = np.linspace(-1.0, 1.0, 401).astype(np.float32).astype(np.float64)
CHANGES = {"color82": 0.3, "exponent": 1.0}  # of the default node, color82 1 and exponent 5

ARCS = """float mxeon_acos(float x)
{
    return acos(x);
}
float mxeon_asin(float x)
{
    return asin(x);
}
"""
SCALE = 0.1  # of the azimuthal lobe of hair
REFRACTED = {"smooth": 0.0001, "rough": 0.05}  # alpha, by name


def arc_errors():
    """Largest errors of the driver's arc cosine and arc sine, by name."""
    x = np.linspace(-1.0, 1.0, 1 << 16).astype(np.float32).astype(np.float64)
    with closing(open_host("gl")) as host:
        return {
            name: np.abs(host.execute(ARCS, f"mxeon_{name}", x)[:, 0] - exact(x)).max()
            for name, exact in (("acos", np.arccos), ("asin", np.arcsin))
        }


def acos_error():
    """Error of the driver's arc cosine."""
    return {"acos": arc_errors()["acos"]}


def azimuth_errors():
    """Error of the driver's arc sine, and what a lobe of SCALE makes of it."""
    error = arc_errors()["asin"]
    return {"asin": error, "lobe": error / SCALE}


def mirrored_sheen():
    """Largest value of the Conty-Kulla sheen at roughness 1 where it is 0, in mirrored lights."""
    with closing(open_host("gl")) as host:
        wo = rounded(directions(np.random.default_rng(SEED), 1 << 14).T)
        inputs = {"color": np.ones_like(wo), "roughness": np.ones(len(wo))}
        probe = _probe(host, "sheen_bsdf, mode conty_kulla")
        return {"mirrored": probe.direct(Batch(wo, wo * [-1.0, -1.0, 1.0], inputs)).max()}


def refracted_angles():
    """Largest angles with the horizon, in degrees, at which light through a dielectric is NaN."""
    degrees, index = (
        each.ravel()
        for each in np.meshgrid(np.linspace(0.005, 3.0, 300), np.linspace(1.05, 4.5, 70))
    )
    angle = np.radians(degrees)
    wo = rounded([np.cos(angle), 0.0 * angle, np.sin(angle)])
    inputs = {"ior": index, "tint": np.ones_like(wo)}
    with closing(open_host("gl")) as host:
        probe = _probe(host, "dielectric_bsdf, scatter_mode RT")
        light = {
            name: probe.transmitted(
                Batch(wo, wo, inputs | {"roughness": np.full((len(wo), 2), alpha)})
            )
            for name, alpha in REFRACTED.items()
        }
    return {name: degrees[~np.isfinite(each).all(axis=1)].max() for name, each in light.items()}


def _probe(host, title):
    """The probe of stock's node of a title."""
    [subject] = [each for each in PBR_SUBJECTS if each.title == title]
    return probe_type_of(subject, probe_type("gl"))(host, subject, "stock")


@cache
def blur_error():
    """Largest error of eonlib's blur of subsurface scattering against that of the profile."""
    source = source_file("glsl", "subsurface_blur").read_text(encoding="utf-8")
    with closing(open_host("gl")) as host:
        errors = []
        for reach in REACHES:
            reaches = np.full((len(COSINES), 3), reach)  # of each channel
            blurred = host.execute(source, "subsurface_blur", COSINES, reaches)[:, 0]
            errors.append(blurred - diffusion_blur(COSINES, reach))
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
