# SPDX-License-Identifier: Apache-2.0
"""OpenPBR's base as a BSDF of Mitsuba: a metal and a dielectric over EON; see `mxeon.models.openpbr_base_brdf`."""

from __future__ import annotations

from typing import ClassVar

from mxeon.mitsuba.coat import CoatPlugin
from mxeon.mitsuba.plugin import Mitsuba
from mxeon.models.coat import openpbr
from mxeon.models.core.ranges import RANGES
from mxeon.models.microfacet.fresnel_formulas import schlick, schlick_avg

EDGE: Mitsuba = openpbr.EDGE


class OpenPbrBasePlugin(CoatPlugin):
    """A metal and a dielectric over EON, mixed, with one roughness of facets."""

    color = "base_color"
    parameter = "base_diffuse_roughness"
    numbers: ClassVar[dict[str, tuple[float, ...]]] = {
        "specular_roughness": (0.3, *RANGES["specular_roughness"][:2]),
        "specular_ior": (1.5, *RANGES["specular_ior"][:2]),
    }

    def configure(self, properties: Mitsuba) -> None:
        """Take the textures and numbers, and say which lobes there are."""
        CoatPlugin.configure(self, properties)
        self.metalness = properties.get_texture("base_metalness", 0.0)

    def traverse(self, callback: Mitsuba) -> None:
        """Show textures and numbers to `mitsuba.traverse`."""
        CoatPlugin.traverse(self, callback)
        callback.put("base_metalness", self.metalness, self.mi.ParamFlags.Differentiable)

    def _dielectric(self) -> tuple[Mitsuba, Mitsuba]:
        return self._inside("specular_roughness") ** 2, self._inside("specular_ior")

    def _dielectric_share(self, si: Mitsuba, active: Mitsuba) -> Mitsuba:
        return 1.0 - self.dr.clip(self.metalness.eval_1(si, active), 0.0, 1.0)

    def _glossy(self, si: Mitsuba, rho: Mitsuba, reflected: Mitsuba, active: Mitsuba) -> Mitsuba:
        """Albedo of both glossy lobes; of the metal about that of a smooth one."""
        share = self._dielectric_share(si, active)
        return share * reflected + (1.0 - share) * schlick(si.wi.z, rho, *EDGE)

    def _fresnel(
        self, si: Mitsuba, color: Mitsuba, c: Mitsuba, missing: Mitsuba, active: Mitsuba
    ) -> Mitsuba:
        share, number = self._dielectric_share(si, active), self.mi.Float
        channels = [
            schlick(c, rho, *EDGE) * (1.0 + schlick_avg(rho, *EDGE) * missing) for rho in color
        ]
        metal = type(color)(*map(number, channels))
        return (
            share * CoatPlugin._fresnel(self, si, color, c, missing, active) + (1.0 - share) * metal
        )
