# SPDX-License-Identifier: Apache-2.0
"""EON, FON, QON, a dielectric over EON, and EON under a varnish as BSDF plugins of Mitsuba 3.

Dr.Jit evaluates and differentiates the formulas of `mxeon.models`.
"""

from __future__ import annotations

from mxeon.mitsuba.coat import CoatPlugin, VarnishPlugin
from mxeon.mitsuba.diffuse import EonPlugin, FonPlugin, QonPlugin, mitsuba, register_plugin

PLUGINS = {
    "eon": EonPlugin,
    "fon": FonPlugin,
    "qon": QonPlugin,
    "dielectric_over_eon": CoatPlugin,
    "varnished": VarnishPlugin,
}


def register() -> None:
    """Register the BSDFs of `PLUGINS`, such as `eon`, for Mitsuba's current variant.

    `eon` and `fon` have the textures `reflectance` and `roughness`, `qon` has `reflectance` and `sigma`, in radian.
    `varnished` and `dielectric_over_eon`, MaterialX's `layer`, also have `eon`'s textures, and the numbers `alpha` and
    `ior`. All are in `mitsuba.traverse` and differentiable. `eon` is sampled
    exactly for the mean of its reflectance, coated lobes with their facets, `fon` and `qon` by the cosine. Like Mitsuba's
    `diffuse`, they reflect only on the front.
    """
    mi = mitsuba()
    for name, kind in PLUGINS.items():
        register_plugin(mi, name, kind)
