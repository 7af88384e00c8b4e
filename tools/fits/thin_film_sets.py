# SPDX-License-Identifier: Apache-2.0
"""Root mean square errors of eonlib's thin film over sets of films: python -m tools.fits.thin_film_sets.

A check measures the error of one set of films. This computes the errors of other sets drawn in the same
way; the largest is the check's tolerance. It is at most a third of the largest error of a single film, so a
wrong digit, which affects all films, exceeds it although it stays below the largest error.
"""

import numpy as np

from mxeon.conformance.checks.microfacets import SMOOTH
from mxeon.conformance.samples import SEED
from mxeon.conformance.specs import microfacets
from mxeon.models.microfacet.ggx import ggx_albedo_dir
from tools.fits import thin_film as fit

SETS = 64


def smooth_errors(category, material, _, mu):
    """Errors of a smooth lobe's value by F_ss: it is F (1 + F_ss (1 - E_ss) / E_ss)."""
    E_ss = ggx_albedo_dir(mu, SMOOTH[0])
    F = fit.film_curve(category).at(mu, **material).max(axis=0)
    return fit.average_errors(category, material) * F * (1.0 - E_ss) / E_ss


# Measurements by name: errors, and a set of films.
MEASURED = {
    "all orders": (fit.curve_errors, microfacets.ORDERED),
    "F_ss": (fit.average_errors, microfacets.FRINGED),
    "compensation of smooth lobes": (smooth_errors, microfacets.FRINGED),
    "visible facets": (fit.visible_errors, microfacets.STEEP),
    "visible facets that are much alike": (fit.visible_errors, microfacets.GLOSSY),
}


def films(spec, ranges, seed):
    """Category, material, roughness and cosine of a check's films, drawn with another seed."""
    SEED.set(seed)
    batch = microfacets.film_views(spec, ranges)
    material = {
        name: np.moveaxis(batch.inputs[name], -1, 0)
        for name in batch.inputs
        if name not in ("roughness", "retroreflective")
    }
    return spec.node, material, batch.inputs["roughness"][:, 0], batch.wo[:, 2]


def largest(errors, ranges, sets=SETS):
    """The largest root mean square of errors, by category."""
    return {
        spec.node: max(
            float(np.sqrt(np.mean(errors(*films(spec, ranges, seed)) ** 2)))
            for seed in range(2, 2 + sets)
        )
        for spec in microfacets.FILM_SPECS
    }


if __name__ == "__main__":
    for name, row in MEASURED.items():
        text = ", ".join(f"{category} {error:.3g}" for category, error in largest(*row).items())
        print(f"{name}: {text}")
