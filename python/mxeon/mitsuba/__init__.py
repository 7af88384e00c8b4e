# SPDX-License-Identifier: Apache-2.0
"""BSDF plugins of Mitsuba 3: EON, FON, QON, a dielectric over EON, and EON under a varnish.

The plugins evaluate and differentiate the formulas of `mxeon.models` with Dr.Jit.
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

    `eon` and `fon` have the textures `reflectance` and `roughness`; `qon` has `reflectance` and
    `sigma`, in radian. `varnished` and `dielectric_over_eon` (MaterialX's `layer`) add the numbers
    `alpha` and `ior` to the textures of `eon`. All inputs are in `mitsuba.traverse` and
    differentiable. Sampling of `eon` is exact for the mean of the reflectance's channels; coated
    BSDFs also sample visible facets; `fon` and `qon` sample the cosine. All BSDFs reflect only on
    the front.
    """
    mi = mitsuba()
    for name, kind in PLUGINS.items():
        register_plugin(mi, name, kind)
