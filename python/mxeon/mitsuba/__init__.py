# SPDX-License-Identifier: Apache-2.0
"""EON, FON, QON, a dielectric over EON, EON under a varnish and OpenPBR's base as BSDF plugins of Mitsuba 3.

The values are those of the formulas of `mxeon.models`, which Dr.Jit evaluates and differentiates.
"""

from __future__ import annotations

from mxeon.mitsuba.coat import CoatPlugin, OpenPbrBasePlugin, VarnishPlugin
from mxeon.mitsuba.diffuse import EonPlugin, FonPlugin, QonPlugin, mitsuba, register_plugin

PLUGINS = {
    "eon": EonPlugin,
    "fon": FonPlugin,
    "qon": QonPlugin,
    "dielectric_over_eon": CoatPlugin,
    "varnished": VarnishPlugin,
    "openpbr_base": OpenPbrBasePlugin,
}


def register() -> None:
    """Register the BSDFs of `PLUGINS`, such as `eon`, for the variant of Mitsuba that is set.

    `eon` and `fon` have the textures `reflectance` and `roughness`, `qon` has `reflectance` and `sigma`, in
    radian. `varnished`, and `dielectric_over_eon`, MaterialX's `layer`, have those of `eon`, and the numbers
    `alpha` and `ior`; `openpbr_base` has inputs of OpenPBR's base. All are in `mitsuba.traverse`, and can be
    differentiated. `eon` is sampled by its value for the mean of its reflectance, a lobe under facets
    with these, the others by the cosine. As Mitsuba's `diffuse` they reflect on the front alone.
    """
    mi = mitsuba()
    for name, kind in PLUGINS.items():
        register_plugin(mi, name, kind)
