# SPDX-License-Identifier: Apache-2.0
"""EON, FON and QON as BSDFs of Mitsuba.

Mitsuba's `si.wi` points to the viewer and is wo in this project; Mitsuba's `wo` points to the light
and is wi.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np

from mxeon.errors import NotRun, PackageError, install
from mxeon.mitsuba.arrays import register_functions
from mxeon.models import diffuse as formulas
from mxeon.models import sampling

# Any object of Mitsuba or Dr.Jit. The types of these objects depend on the variant.
Mitsuba: TypeAlias = Any

# LLVM 15 and older crash on the code that Dr.Jit 1.5 generates for a minimum.
OLDEST_LLVM = (16, 0, 0)


def register_plugin(mi: Mitsuba, name: str, kind: type) -> None:
    """Register a BSDF for the current variant. The methods are those of the class `kind`."""
    members: dict[str, Any] = {"__init__": _initialize, "mi": mi, "dr": import_module("drjit")}
    # Mitsuba's classes do not permit other base classes, so the members are copied.
    for each in reversed(kind.__mro__):
        members |= {n: member for n, member in vars(each).items() if not n.startswith("__")}
    mi.register_bsdf(name, type(name, (mi.BSDF,), members))


def mitsuba() -> Mitsuba:
    """Import Mitsuba and check that a variant is set and can run with the installed LLVM."""
    try:
        mi = import_module("mitsuba")
    except ModuleNotFoundError:
        raise PackageError(f"mitsuba is not installed: {install('mitsuba')}") from None
    variant = mi.variant()
    if not variant:
        raise NotRun("mitsuba: no variant is set; call mitsuba.set_variant('llvm_ad_rgb') first")
    register_functions()
    version = import_module("drjit").detail.llvm_version() if "llvm" in variant else OLDEST_LLVM
    if version < OLDEST_LLVM:
        raise NotRun(
            f"mitsuba: Dr.Jit found LLVM {version[0]}, which crashes it; install LLVM 16 "
            "or later (Debian: libllvm19), or name its library in DRJIT_LIBLLVM_PATH"
        )
    return mi


def _initialize(self: Mitsuba, properties: Mitsuba) -> None:
    self.mi.BSDF.__init__(self, properties)
    self.configure(properties)


class RoughDiffusePlugin:
    """Methods of a Mitsuba BSDF with a reflectance and a parameter in [0, `largest`]."""

    mi: Mitsuba
    dr: Mitsuba
    parameter = "roughness"
    largest = 1.0
    brdf: Callable[..., Mitsuba]  # brdf(mu_o, mu_i, s, rho, amount) of one channel, in 1/sr

    def configure(self, properties: Mitsuba) -> None:
        if self.parameter in properties:
            value = properties[self.parameter]
            if isinstance(value, int | float) and not 0.0 <= value <= self.largest:
                rule = f"{self.parameter} must lie in [0, {self.largest:.4g}]"
                raise ValueError(f"{rule}; got {value:g}")
        self.reflectance = properties.get_texture("reflectance", 0.5)
        self.amount = properties.get_texture(self.parameter, 0.0)
        flags = self.mi.BSDFFlags.DiffuseReflection | self.mi.BSDFFlags.FrontSide
        self.m_components, self.m_flags = [flags], flags

    def traverse(self, callback: Mitsuba) -> None:
        for name, texture in (("reflectance", self.reflectance), (self.parameter, self.amount)):
            callback.put(name, texture, self.mi.ParamFlags.Differentiable)

    def eval(self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        active = self._front(context, si.wi, wo, active)
        color = self.reflectance.eval(si, active)
        amount = self._clipped(self.amount.eval_1(si, active))
        return self.dr.select(active, self._reflected(si.wi, wo, color, amount), 0.0)

    def pdf(self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        active = self._front(context, si.wi, wo, active)
        rho, amount = self._gray(si, active)
        return self.dr.select(active, self._density(si.wi, wo, rho, amount), 0.0)

    def eval_pdf(
        self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True
    ) -> tuple[Mitsuba, Mitsuba]:
        return self.eval(context, si, wo, active), self.pdf(context, si, wo, active)

    def sample(
        self,
        context: Mitsuba,
        si: Mitsuba,
        sample1: Mitsuba,
        sample2: Mitsuba,
        active: Mitsuba = True,
    ) -> tuple[Mitsuba, Mitsuba]:
        wo, kind, component = self._pick(context, si, sample1, sample2, active)
        pdf = self.pdf(context, si, wo, active)
        active = self._front(context, si.wi, wo, active) & (pdf > 0.0)
        record = self.mi.BSDFSample3f(wo)
        record.pdf = self.dr.select(active, self.dr.detach(pdf), 0.0)
        record.eta = 1.0
        record.sampled_type, record.sampled_component = kind, component
        value = self.eval(context, si, wo, active)
        return record, self.dr.select(active, value / self.dr.select(active, record.pdf, 1.0), 0.0)

    def eval_diffuse_reflectance(self, si: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        return self.reflectance.eval(si, active)

    def to_string(self) -> str:
        return f"{self.parameter}: {self.amount}, reflectance: {self.reflectance}"

    def _pick(
        self, context: Mitsuba, si: Mitsuba, choice: Mitsuba, u: Mitsuba, active: Mitsuba
    ) -> tuple[Mitsuba, Mitsuba, Mitsuba]:
        rho, amount = map(self.dr.detach, self._gray(si, active))
        kind = self.mi.UInt32(+self.mi.BSDFFlags.DiffuseReflection)
        return self._draw(si.wi, choice, u, rho, amount), kind, 0

    def _enabled(self, context: Mitsuba) -> tuple[bool, ...]:
        """For each component of the BSDF, whether the context enables that component."""
        return (context.is_enabled(self.mi.BSDFFlags.DiffuseReflection),)

    def _front(self, context: Mitsuba, view: Mitsuba, light: Mitsuba, active: Mitsuba) -> Mitsuba:
        """Whether a component is enabled, and wo and wi are above the horizon."""
        enabled = any(self._enabled(context))
        return self.mi.Bool(active) & enabled & (view.z > 0.0) & (light.z > 0.0)

    def _clipped(self, amount: Mitsuba) -> Mitsuba:
        """The parameter, clamped because an optimizer may have moved it out of the valid range."""
        return self.dr.clip(amount, 0.0, self.largest)

    def _gray(self, si: Mitsuba, active: Mitsuba) -> tuple[Mitsuba, Mitsuba]:
        """Mean of the reflectance's channels, and the parameter, for drawing samples."""
        rho = self.dr.mean(self.reflectance.eval(si, active))
        return self.dr.clip(rho, 0.0, 1.0), self._clipped(self.amount.eval_1(si, active))

    def _reflected(self, view: Mitsuba, light: Mitsuba, color: Mitsuba, amount: Mitsuba) -> Mitsuba:
        s = view.x * light.x + view.y * light.y
        channels = [self.brdf(view.z, light.z, s, rho, amount) * light.z for rho in color]
        return type(color)(*map(self.mi.Float, channels))

    def _density(self, view: Mitsuba, light: Mitsuba, rho: Mitsuba, amount: Mitsuba) -> Mitsuba:
        """Density of the samples in 1/sr, which is mu_i / pi."""
        return light.z * self.dr.inv_pi

    def _draw(
        self, view: Mitsuba, choice: Mitsuba, u: Mitsuba, rho: Mitsuba, amount: Mitsuba
    ) -> Mitsuba:
        """Direction to the light, sampled with a density proportional to its cosine."""
        return self.mi.warp.square_to_cosine_hemisphere(u)


class FonPlugin(RoughDiffusePlugin):
    """FON with cosine-weighted samples."""

    brdf = staticmethod(formulas.fon_brdf_mu)


class QonPlugin(RoughDiffusePlugin):
    """QON with cosine-weighted samples."""

    parameter = "sigma"
    largest = 0.5 * np.pi
    brdf = staticmethod(formulas.qon_brdf_mu)


class EonPlugin(RoughDiffusePlugin):
    """EON with samples in exact proportion to BRDF times cosine, as in `mxeon.models.sampling`."""

    brdf = staticmethod(formulas.eon_brdf_mu)

    def _density(self, view: Mitsuba, light: Mitsuba, rho: Mitsuba, amount: Mitsuba) -> Mitsuba:
        s = view.x * light.x + view.y * light.y
        return self.mi.Float(sampling.eon_density_mu(view.z, light.z, s, rho, amount))

    def _draw(
        self, view: Mitsuba, choice: Mitsuba, u: Mitsuba, rho: Mitsuba, amount: Mitsuba
    ) -> Mitsuba:
        """Direction sampled from one of EON's four parts, by the method of `eon_draw`."""
        dr, number = self.dr, self.mi.Float
        mu_o, S_o = view.z, dr.safe_sqrt(view.x * view.x + view.y * view.y)
        lower, upper, multiple, flat = sampling.eon_integrals(mu_o, S_o, rho, amount)
        place = choice * number(lower + upper + multiple + flat)
        is_lower, is_toward = place < number(lower), place < number(lower + upper)
        is_flat = place >= number(lower + upper + multiple)
        v, u2 = u.x, u.y
        x = number(v * mu_o * sampling.eon_cube_gap(mu_o, S_o))
        mu_lower = number(sampling.eon_lower_cosine(x, dr.cbrt(1.0 - x)))
        limit = sampling.eon_upper_limit(mu_o, S_o)
        mu_upper = number(sampling.eon_upper_cosine(v**0.4, mu_o, limit))
        mu_multiple = number(sampling.eon_multiple_cosine(dr.cbrt(v)))
        mu = dr.select(is_lower, mu_lower, dr.select(is_toward, mu_upper, mu_multiple))
        # Directions of EON's lower and upper parts are on wo's side. Directions of the multiple
        # part have a uniform azimuth.
        S, (sine, cosine) = dr.safe_sqrt((1.0 - mu) * (1.0 + mu)), dr.sincos(2.0 * dr.pi * u2)
        ahead = dr.select(is_toward, 2.0 * dr.safe_sqrt(u2 * (1.0 - u2)), cosine)
        aside = dr.select(is_toward, 2.0 * u2 - 1.0, sine)
        r = dr.sqrt(v)
        point = sampling.eon_flat_direction(v, r * cosine, r * sine, amount * S_o)
        x, y, z = (
            dr.select(is_flat, number(each), other)
            for each, other in zip(point, (S * ahead, S * aside, mu), strict=True)
        )
        # The direction is rotated to the local frame from a frame in whose xz-plane wo lies.
        length = dr.select(S_o > 0.0, S_o, 1.0)
        c, s = dr.select(S_o > 0.0, view.x / length, 1.0), view.y / length
        return self.mi.Vector3f(c * x - s * y, s * x + c * y, z)
