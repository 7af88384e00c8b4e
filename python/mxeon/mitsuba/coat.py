# SPDX-License-Identifier: Apache-2.0
"""BSDFs of Mitsuba for EON under a dielectric and under a varnish, as in `mxeon.models.coat`.

The albedo of the interface depends only on a cosine. After a change of `alpha` or `ior`, the albedo
is tabulated in float64 as a cubic in each part of an octave. The coefficients have gradients with
respect to `alpha` and `ior`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar, cast

import numpy as np

from mxeon.mitsuba.arrays import gather_cubic, octave_cells, octave_cubics
from mxeon.mitsuba.diffuse import EonPlugin, Mitsuba, RoughDiffusePlugin
from mxeon.models import coat as formulas
from mxeon.models.core.arguments import RANGES
from mxeon.models.core.arrays import Array
from mxeon.models.diffuse import eon_albedo
from mxeon.models.diffuse import fon_loss_mu as fon_loss
from mxeon.models.microfacet import ggx
from mxeon.models.microfacet.fresnel import dielectric, dielectric_avg
from mxeon.models.sampling import visible_density, visible_normal

ALPHAS, IORS = (RANGES[name][:2] for name in ("coat_alpha", "coat_ior"))
STEP = 1e-4  # step for finite differences of the coefficients


class CoatPlugin(EonPlugin):
    """EON under a dielectric. A lobe is sampled with a probability in proportion to the albedo."""

    # Default, minimum and maximum of each parameter that is constant over the surface.
    numbers: ClassVar[dict[str, tuple[float, ...]]] = {
        "alpha": (0.05, *ALPHAS),
        "ior": (1.5, *IORS),
    }
    interface: Callable[[float, float], Any] = staticmethod(formulas.constant_coat)
    count = 2  # number of tabulated curves

    def configure(self, properties: Mitsuba) -> None:
        EonPlugin.configure(self, properties)
        for name, (default, low, high) in self.numbers.items():
            value = properties.get(name, default)
            if not isinstance(value, int | float):
                raise ValueError(f"{name} must be one number for the surface; got {value}")
            if not low <= value <= high:
                raise ValueError(f"{name} must lie in [{low:g}, {high:g}]; got {value:g}")
            setattr(self, name, self.mi.Float(value))
        flags, front = self.mi.BSDFFlags, self.mi.BSDFFlags.FrontSide
        self.m_components = [flags.GlossyReflection | front, flags.DiffuseReflection | front]
        self.m_flags = self.m_components[0] | self.m_components[1]
        self.tabulate()

    def traverse(self, callback: Mitsuba) -> None:
        EonPlugin.traverse(self, callback)
        for name in self.numbers:
            callback.put(name, getattr(self, name), self.mi.ParamFlags.Differentiable)

    def parameters_changed(self, keys: list[str]) -> None:
        self.tabulate()

    def tabulate(self) -> None:
        """Compute the table as a linear function of each parameter that has a gradient."""
        numbers = self._clamped("alpha"), self._clamped("ior")
        values = [float(np.array(self.dr.detach(each)).item()) for each in numbers]
        self.coat, self.average = self.interface(*values), dielectric_avg(numbers[1])
        if not self._compiled:
            return
        self.table = self.mi.Float(self._rows(values))
        for k, number in enumerate(numbers):
            if self.dr.grad_enabled(number):
                change = number - self.dr.detach(number)
                self.table = self.table + self.mi.Float(self._slopes(values, k)) * change
        self.dr.make_opaque(self.average, self.table, *(getattr(self, n) for n in self.numbers))

    def eval(self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        active = self._front(context, si.wi, wo, active)
        is_glossy, is_diffuse = self._enabled(context)
        color, number = self.reflectance.eval(si, active), self.mi.Float
        missing, reflected = self._interface_curves(si.wi.z)
        facets, c = self._facets(si.wi, wo)
        F = dielectric(c, self._clamped("ior")) * (1.0 + self.average * missing)
        top = type(color)(number(is_glossy * F * facets * wo.z))
        amount = self._clipped(self.amount.eval_1(si, active))
        base = self._reflected(si.wi, wo, color, amount)
        return self.dr.select(active, top + base * number(is_diffuse * (1.0 - reflected)), 0.0)

    def pdf(self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        active = self._front(context, si.wi, wo, active)
        rho, amount = self._gray(si, active)
        share = self._share(context, si, rho, amount)
        view, light = self._vector(si.wi), self._vector(wo)
        facets = visible_density(view, ggx.half_vector(view, light)[0], self._roughness())
        mixture = share * facets + (1.0 - share) * self._density(si.wi, wo, rho, amount)
        return self.dr.select(active, self.mi.Float(mixture), 0.0)

    def _pick(
        self, context: Mitsuba, si: Mitsuba, choice: Mitsuba, u: Mitsuba, active: Mitsuba
    ) -> tuple[Mitsuba, Mitsuba, Mitsuba]:
        dr, flags = self.dr, self.mi.BSDFFlags
        rho, amount = map(dr.detach, self._gray(si, active))
        share = dr.detach(self._share(context, si, rho, amount))
        is_reflected = choice < share
        rest = dr.maximum(choice - share, 0.0) / dr.maximum(1.0 - share, 1e-7)
        view, roughness = self._vector(si.wi), dr.detach(self._roughness())
        wh = self.mi.Vector3f(*visible_normal(view, u.x, u.y, roughness))
        base = self._draw(si.wi, rest, u, rho, amount)
        wo = dr.select(is_reflected, self.mi.reflect(si.wi, wh), base)
        kinds = [
            self.mi.UInt32(+each) for each in (flags.GlossyReflection, flags.DiffuseReflection)
        ]
        return wo, dr.select(is_reflected, *kinds), dr.select(is_reflected, self.mi.UInt32(0), 1)

    def _enabled(self, context: Mitsuba) -> tuple[bool, ...]:
        flags = self.mi.BSDFFlags
        glossy = context.is_enabled(flags.GlossyReflection, 0)
        return glossy, context.is_enabled(flags.DiffuseReflection, 1)

    def _share(self, context: Mitsuba, si: Mitsuba, rho: Mitsuba, amount: Mitsuba) -> Mitsuba:
        """Probability of sampling the facets, which is the facets' share of the albedo."""
        is_glossy, is_diffuse = self._enabled(context)
        if not is_glossy or not is_diffuse:
            return self.mi.Float(is_glossy)
        facets, total = map(self.mi.Float, self._albedos(si.wi.z, rho, amount))
        return facets / self.dr.maximum(total, 1e-30)

    def _albedos(self, mu: Mitsuba, rho: Mitsuba, amount: Mitsuba) -> tuple[Mitsuba, Mitsuba]:
        """Directional albedos of the facets alone and of the whole coat."""
        reflected = self._interface_curves(mu)[1]
        return reflected, reflected + (1.0 - reflected) * eon_albedo(fon_loss(mu), rho, amount)

    def _facets(self, view: Mitsuba, light: Mitsuba) -> tuple[Mitsuba, Mitsuba]:
        """BRDF of perfectly reflecting facets, and the cosine wo . wh, which equals wi . wh."""
        wh, c = ggx.half_vector(self._vector(view), self._vector(light))
        visibility = ggx.visibility(view.z, light.z, self._clamped("alpha"))
        return ggx.ndf(wh, self._roughness()) * visibility, c

    def _interface_curves(self, mu: Mitsuba) -> tuple[Mitsuba, Mitsuba]:
        """Missing energy of the facets, (1 - E_ss) / E_ss, and albedo of the interface, at mu."""
        missing, reflected = self._curves(mu)
        return self.dr.maximum(missing, 0.0), self.dr.clip(reflected, 0.0, 1.0)

    def _curves(self, mu: Mitsuba) -> list[Mitsuba]:
        """Values of the interface's curves at mu. Scalar variants do not use the table."""
        if not self._compiled:
            return list(self.coat.at(mu))
        cell, x = octave_cells(mu)
        return [gather_cubic(self.table, self.count * cell + k, x) for k in range(self.count)]

    def _rows(self, values: list[float]) -> Array:
        """Cubics of all curves, cell by cell. A varnish appends the `means` of the interface."""
        coat = self.interface(*values)
        rows = [octave_cubics(partial(_curve, coat, k)) for k in range(self.count)]
        return np.append(np.stack(rows, axis=1), getattr(coat, "means", ()))

    def _slopes(self, values: list[float], k: int) -> Array:
        """Derivatives of the table with respect to parameter `k`, by steps in the valid range."""
        low, high = (ALPHAS, IORS)[k]
        ends = min(values[k] + STEP, high), max(values[k] - STEP, low)
        upper, lower = (self._rows([*values[:k], end, *values[k + 1 :]]) for end in ends)
        return (upper - lower) / (ends[0] - ends[1])

    def _roughness(self) -> Mitsuba:
        return self._clamped("alpha"), self._clamped("alpha")

    def _clamped(self, name: str) -> Mitsuba:
        """The parameter, clamped because an optimizer may have moved it out of the valid range."""
        return self.dr.clip(getattr(self, name), *self.numbers[name][1:])

    def _vector(self, w: Mitsuba) -> Mitsuba:
        """A direction for the formulas, which is converted to a NumPy array in scalar variants."""
        return w if self._compiled else np.array([w.x, w.y, w.z])

    @property
    def _compiled(self) -> bool:
        return bool(self.dr.is_jit_v(self.mi.Float))


def _curve(coat: Any, k: int, mu: Array) -> Array:
    return cast(Array, coat.at(mu)[k])


class VarnishPlugin(CoatPlugin):
    """EON below a rough dielectric interface. Visible facets or a cosine lobe are sampled."""

    interface: Callable[[float, float], Any] = staticmethod(formulas.constant_varnish)
    count = 3
    _density, _draw = RoughDiffusePlugin._density, RoughDiffusePlugin._draw

    def eval(self, context: Mitsuba, si: Mitsuba, wo: Mitsuba, active: Mitsuba = True) -> Mitsuba:
        active = self._front(context, si.wi, wo, active)
        is_glossy, is_diffuse = self._enabled(context)
        color, amount = self.reflectance.eval(si, active), self.amount.eval_1(si, active)
        (facets, c), means = self._facets(si.wi, wo), self._means()
        ior, s = self._clamped("ior"), si.wi.x * wo.x + si.wi.y * wo.y
        o, i = (formulas.nonnegative(self._curves(w.z)) for w in (si.wi, wo))
        transmitted = (1.0 - o.E_single - o.D) * (1.0 - i.E_single - i.D) / ior**2
        multiple = o.D * i.D / (np.pi * formulas.nonzero(means.D))
        arguments = (si.wi.z, wo.z), s, (o.b, i.b), ior, means
        glossy, channels = is_glossy * facets * dielectric(c, ior), []
        for rho in color:
            base = formulas.base_under_varnish(*arguments, rho, self._clipped(amount))
            value = glossy + is_diffuse * (multiple + transmitted * base)
            channels.append(self.mi.Float(value))
        return self.dr.select(active, type(color)(*channels) * wo.z, 0.0)

    def _albedos(self, mu: Mitsuba, rho: Mitsuba, amount: Mitsuba) -> tuple[Mitsuba, Mitsuba]:
        curves, ior = formulas.nonnegative(self._curves(mu)), self._clamped("ior")
        return curves.E_single, formulas.varnish_albedo(mu, curves, ior, self._means(), rho, amount)

    def _means(self) -> formulas.Means:
        if not self._compiled:
            means: formulas.Means = self.coat.means
            return means
        start = self.dr.width(self.table) - 4
        return formulas.Means(
            *(self.dr.gather(self.mi.Float, self.table, start + k) for k in range(4))
        )
