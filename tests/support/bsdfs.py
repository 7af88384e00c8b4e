# SPDX-License-Identifier: Apache-2.0
"""Mitsuba BSDFs, directions, and tests of both: Mitsuba's chi-square test, and a white furnace."""

import numpy as np

PARAMETERS = {"eon": "roughness", "fon": "roughness", "qon": "sigma"}
COLOR = (0.25, 0.5, 1.0)  # exact in float32
PAIRS, SEED = 512, 7
SAMPLES = 100_000  # samples of a chi-square test


def material(name, amount, color=COLOR):
    reflectance = {"type": "rgb", "value": list(color)}
    return {"type": name, "reflectance": reflectance, PARAMETERS[name]: amount}


def directions(rng):
    """Unit vectors in float32, some of them along the normal or grazing."""
    w = rng.normal(size=(PAIRS, 3))
    w[:, 2] = np.abs(w[:, 2])
    w[:8], w[8:16, 2] = (0.0, 0.0, 1.0), 1e-3
    return (w / np.linalg.norm(w, axis=1, keepdims=True)).astype(np.float32)


def surface(mi, wo):
    """Surface points seen from these directions."""
    point = mi.SurfaceInteraction3f()
    point.wi = mi.Vector3f(np.asarray(wo).T)
    return point


def chi_square(mi, angle, functions):
    """Mitsuba's chi-square test of the functions that its adapter derives from a BSDF."""
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    wi = [float(0.8 * np.sin(angle)), float(0.6 * np.sin(angle)), float(np.cos(angle))]
    sample, pdf = functions(lambda *arguments: BSDFAdapter(*arguments, wi=wi))
    return ChiSquareTest(
        domain=SphericalDomain(),
        sample_func=sample,
        pdf_func=pdf,
        sample_dim=3,
        sample_count=SAMPLES,
        res=31,
        ires=8,  # a peak at grazing takes more than 4 nodes of a bin
    )


def furnace(mi, bsdf, samples):
    """Picture of a sphere in a white environment."""
    camera = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"}}
    picture = mi.render(
        mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1},
                "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": film},
                "sphere": {"type": "sphere", "bsdf": bsdf},
                "light": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
            }
        ),
        spp=samples,
    )
    return np.array(picture)
