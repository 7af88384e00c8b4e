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

    `eon` and `fon` have the textures `reflectance` and `roughness`, and `qon` has `reflectance` and
    `sigma`, in radians. `varnished` and `dielectric_over_eon` (MaterialX's `layer`) add the numbers
    `alpha` and `ior` to the textures of `eon`. All inputs are differentiable and are listed by
    `mitsuba.traverse`. Samples of `eon` are exact for the mean of the reflectance's channels.
    Coated BSDFs also sample visible facets. Samples of `fon` and `qon` are cosine-weighted. All
    BSDFs reflect only on the front.
    """
    mi = mitsuba()
    for name, kind in PLUGINS.items():
        register_plugin(mi, name, kind)
