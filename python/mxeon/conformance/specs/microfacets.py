# SPDX-License-Identifier: Apache-2.0
"""Specs of the microfacet nodes in scatter modes R, T and RT, and under a thin film.

E_ss is the albedo of GGX facets that reflect all light, without multiple scattering. F_ss is the
average of a Fresnel curve. Compensation multiplies values by 1 + F_ss (1 - E_ss) / E_ss.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from mxeon.conformance import samples, spec, tolerance
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Counts, Values, directions, generator, rounded
from mxeon.conformance.specs import lobes, sheen
from mxeon.conformance.tolerance import Term, Tolerance, roundings, single, sum_in, sum_of
from mxeon.models import sampling, transmission
from mxeon.models.microfacet import Lobe, fresnel, node_albedo, uncompensated
from mxeon.models.microfacet.ggx import ggx_albedo_dir, smith_g1, smith_g2, smith_g2_anisotropic
from mxeon.models.nodes import microfacets
from mxeon.models.nodes.microfacets import FILM_NODES, LOBES, MICROFACET_NODES, TRANSMISSION_NODES
from mxeon.models.nodes.node import Scattering

COUNTS = replace(lobes.PbrSpec.counts, diagnosed=1 << 8)  # the models are slow
LEAST_ALPHA = 1e-3  # smallest alpha of random pairs
LEAST_STRETCHED = 0.05  # smallest alpha and cosine of anisotropic lobes with measured albedos
LEAST_INVERTED = 0.1  # smaller IORs of dielectrics are raised to 0.1 before inversion
LEAST_INDEX = 1.05  # smallest IOR above 1 for which tools/fits/ggx_cosine.py fits albedos
COSINE_STEP = 2.0**-18  # largest difference between wo . wh and wi . wh
RIM_COLOR = 0.05  # smallest |wo + wi| if all channels of color90 are below 0.05
# Smallest alpha of lobes with rotated tangents. Errors of a tangent grow by 1 / alpha.
LEAST_TANGENT_ALPHA = 0.05
LEAST_TANGENT_COSINE = 0.1  # smallest cosine of directions if tangents are rotated
COSINES = np.linspace(0.0, 1.0, 65)  # cosines at which Fresnel curves are tested for values below 0

# fmt: off
# With the first IOR in `materials`, pictures are bright enough to show deliberate errors.
INDEX = spec.Input("ior", low=0.5, high=3.0, edges=(1.0, 1.5, 3.0), change=1.6, materials=(2.5, 1.2),
              beyond=(0.0, 0.2, 1.0015, 1.02, 4.0, 10.0, 100.0))
FILM: Values = {"thinfilm_thickness": 400.0}
FACETS = (
    spec.Input("roughness", "vector2", LEAST_ALPHA, 1.0, edges=(1e-4, 0.01, 1.0), change=(0.3, 0.3),
          logarithmic=True, equal=True, materials=((0.8, 0.8), (0.4, 0.4)),
          beyond=(1e-4, 2.0), ends=(0.0, 1.0)),
    spec.Input("retroreflective", "boolean", change=True),
    spec.Input("thinfilm_thickness", high=1000.0, edges=(0.0, 1.0, 100.0), change=400.0,
          beyond=(1500.0, 2500.0, 3000.0, 6000.0, 1e5)),
    spec.Input("thinfilm_ior", low=1.0, high=2.5, edges=(1.0, 1.5), change=2.0, needs=FILM,
          beyond=(0.5, 3.0, 5.0), ends=(1.0, np.inf)),
    lobes.NORMAL,
    spec.Input("tangent", "vector3", change=(0.6, 0.8, 0.0), needs={"roughness": (0.1, 0.4)}),
)
INPUTS = {
    "dielectric_bsdf": (lobes.WEIGHT, spec.color("tint", (0.2, 0.5, 0.8), (0.9, 0.6, 0.3)), INDEX, *FACETS),
    "conductor_bsdf": (
        lobes.WEIGHT,
        replace(INDEX, type="color3", change=(0.9, 1.1, 1.6),
                materials=((0.2, 0.9, 1.1), (1.5, 0.6, 2.0)), beyond=(0.0, 0.05, 0.18, 5.0, 10.0)),
        spec.Input("extinction", "color3", 0.5, 6.0, edges=(0.5, 3.0), change=(0.9, 2.1, 3.6),
              materials=((3.9, 2.5, 1.8), (0.5, 1.0, 4.0)), beyond=(0.0, 0.2, 10.0, 100.0)),
        *FACETS,
    ),
    "generalized_schlick_bsdf": (
        lobes.WEIGHT,
        spec.color("color0", (0.1, 0.4, 0.9), (0.8, 0.5, 0.2)),
        spec.color("color82", (0.5, 0.7, 0.8), (1.0, 1.0, 1.0)),
        spec.color("color90", (0.9, 0.8, 0.6), (1.0, 1.0, 1.0)),
        spec.Input("exponent", low=1.0, high=8.0, edges=(1.0, 5.0), change=2.5, materials=(5.0, 3.0),
              beyond=(0.5, 10.0, 20.0, 100.0)),
        *FACETS,
    ),
}
# fmt: on
# MaterialX's average of a film's reflectance is least accurate on a base with an IOR of 1.
BUBBLE: Values = dict.fromkeys(("weight", "tint", "ior"), 1.0)
BUBBLE = {**BUBBLE, "thinfilm_ior": 2.5, "thinfilm_thickness": 325.0}
BUBBLE_ROW = 3

# Largest errors of the shaders' fits, measured by scripts in tools/fits.
ESS_FIT = 5e-4  # error of E_ss (ggx_albedo.py)
SMOOTH_ESS_FIT = 5.3e-5  # error of E_ss of smooth lobes at cosines from 0.05 (ggx_albedo.py)
# Error of a value with compensation, due to the fit of E_ss (ggx_albedo.py). The error is relative
# for values above 1.
ESS_VALUE_FIT = 1.14e-3
METAL_FIT = 4.6e-4  # error of F_ss of a metal (fresnel_average.py)
# Error of a value with compensation if F_ss has an error of 1 (ggx_albedo.py). The error is
# relative for values above 1.
COMPENSATED = 0.6
LOBE_FIT = 3.2e-3  # error of the albedo of GGX with a Fresnel curve (ggx_cosine.py)
INSIDE_FIT = 2.8e-2  # error of the albedo of a dielectric with an IOR below 1 (ggx_inside.py)
PASSING_FIT = 3.4e-2  # error of the share of light that leaves a denser medium (ggx_inside.py)
DIP_FIT = 5.9e-3  # additional error of an albedo for the deepest Fresnel dip (ggx_cosine.py)
LEAST_ESS = 1.0 - math.log(2.0)  # smallest E_ss, at alpha 1 along the normal


def sum_over(directions: int) -> Term:
    """Error of a lobe's mean over `directions` samples of an environment.

    `tools/fits/lattices.py` measures the error for three point sets. MaterialX's own points have
    half of the error.
    """
    return Term(3.6 / directions, f"a sum over {directions} directions of an environment")


HALF_TEXEL = math.sqrt(2.0) * math.pi / (2 * samples.SKY_ROWS)
TEXEL = Term(samples.SLOPE * HALF_TEXEL, "the nearest texel, up to half a texel away")

# Errors of two fits for anisotropic GGX (ggx_anisotropic.py): the relative error of E_ss, and the
# error of a dielectric's albedo. Both errors apply to alpha ratios up to 50 and cosines from 0.01.
ANISOTROPIC_FIT, ANISOTROPIC_LOBE_FIT = 2.5e-2, 3.4e-2
LARGEST_RATIO, LEAST_ANISOTROPIC_COSINE = 50.0, 0.01
ANISOTROPIC = Term(ANISOTROPIC_FIT, "the anisotropic fit of E_ss")
ANISOTROPIC_LOBE = Term(ANISOTROPIC_LOBE_FIT, "the anisotropic fit of the lobe's albedo")
ESS = Term(ESS_FIT / LEAST_ESS, "the fit of E_ss, divided by 0.31, the smallest E_ss")
COMPENSATION = (ESS, Term(METAL_FIT * (1.0 - LEAST_ESS), "the fit of F_ss, times 1 - E_ss"))
LOBE = Term(LOBE_FIT, "the fit of the lobe's albedo")
INSIDE = Term(INSIDE_FIT, "the fit of the albedo for an IOR below 1")
PASSING_SHARE = Term(PASSING_FIT, "the fit of the light that passes from the denser side")
PASSING = sum_in(Quantity.ALBEDO, PASSING_SHARE)
HALF_DIP = Term((1.0 - samples.LEAST_COLOR82) * DIP_FIT, "half of the fit's error at 82 degrees")


def compensated(average: float, words: str) -> Tolerance:
    """Tolerance of values with compensation if F_ss has the error `average`."""
    fit = Term(ESS_VALUE_FIT, "the fit of E_ss, divided by E_ss")
    return sum_of(fit, Term(COMPENSATED * average, f"{words}, times 0.6"), exact=True)


VALUE = compensated(METAL_FIT, "the fit of F_ss")
LOST = (1.0 - LEAST_ESS) / LEAST_ESS
MEAN_METAL = Term(METAL_FIT * LOST, "the fit of F_ss, times (1 - E_ss) / E_ss")
MEAN = sum_in(Quantity.ALBEDO, ESS, MEAN_METAL)
ENVIRONMENT = sum_in(Quantity.ALBEDO, *COMPENSATION, sum_over(1024))
THROUGHPUT = sum_in(Quantity.ALBEDO, ESS, LOBE)
SCHLICK_THROUGHPUT = THROUGHPUT.plus(HALF_DIP)
# The distribution of normals h is proportional to q^-4, where q is the length of the vector
# (h_x / a_x, h_y / a_y, h_z). The logarithm of q^-4 has a slope of at most 2 / min(a_x, a_y).
FRAME = sum_of(
    roundings(
        2 * 2 * 5 / (2 * samples.TURNED[0] * samples.LEAST_TURNED),
        "(five in each of two directions, divided by the smallest cosine and alpha)",
    )
)
WEAK = "the fit of a cosine at IOR 1.03, scaled"
A_COSINE, THREE_COSINES = "the fit of a cosine, which", "F_ss from three cosines,"
# Errors outside the domains of the fits. Each row has a quantity, an input, a value of the input,
# an error, and the cause of the error.
BEYOND: tuple[tuple[str, str, float, float, str], ...] = (
    ("throughput", "ior", 1.0015, 9.3e-3, WEAK),
    ("throughput", "ior", 1.02, 2.9e-3, WEAK),
    ("throughput", "ior", 4.0, 0.03, f"{A_COSINE} ends at IOR 3"),
    ("throughput", "ior", 10.0, 0.1, f"{A_COSINE} ends at IOR 3"),
    ("throughput", "ior", 100.0, 0.17, f"{A_COSINE} ends at IOR 3"),
    ("throughput", "ior", 0.2, 0.07, "the fit from inside, which ends at IOR 0.33"),
    ("throughput", "exponent", 20.0, 0.09, f"{A_COSINE} ends at exponent 10"),
    ("throughput", "exponent", 100.0, 0.23, f"{A_COSINE} ends at exponent 10"),
    ("throughput", "exponent", 0.5, 0.05, f"{A_COSINE} begins at exponent 1"),
    ("value", "extinction", 0.0, 0.22, f"{THREE_COSINES} which miss total reflection"),
    ("value", "extinction", 0.2, 4.5e-3, f"{THREE_COSINES} below their domain"),
    ("value", "ior", 10.0, 1e-3, f"{THREE_COSINES} above their domain"),
    ("albedo", "extinction", 0.0, 0.07, f"{THREE_COSINES} which miss total reflection"),
    ("albedo", "ior", 0.2, 7e-3, "a sum over 1024 directions, across a critical angle"),
)
OUTSIDE_ERRORS = {
    (quantity, name, value): compensated(error, words)
    if quantity == "value"
    else single(error, Quantity.ALBEDO, words)
    for quantity, name, value, error, words in BEYOND
}
# fmt: off
ERRORS = {
    "picture_albedo": sum_in(Quantity.ALBEDO, *COMPENSATION, sum_over(256)),
    "anisotropic_albedo": sum_of(*COMPENSATION, ANISOTROPIC, sum_over(1024), quantity=Quantity.ALBEDO),
    "anisotropic_value": VALUE.plus(ANISOTROPIC),
    "shape": sum_in(Quantity.RELATIVE, roundings(2 * 64, "of two values")),
    # Mirroring a view changes only signs, which is exact.
    "retroreflection": lobes.BURLEY_VALUE,
    "anisotropy": sum_of(roundings(
        2 * 2 * 2 / (2 * LEAST_TANGENT_COSINE * LEAST_TANGENT_ALPHA),
        "(two in each of two directions, divided by the smallest cosine and alpha)")),
    "dip": sum_in(Quantity.ALBEDO, HALF_DIP),
    "denser": sum_in(Quantity.ALBEDO, INSIDE, ESS),
}
# fmt: on
QUADRATURE = 6e-4  # error of an albedo computed by a quadrature of exact values
# MaterialX fits a lobe's albedo in a prefiltered environment as F0 A + F90 B. The error for F0 =
# F90 = 1 is largest where B is 0.
PREFILTERED = Term(5.06e-2, "MaterialX's fit of prefiltered light")


def facet_errors(throughput: Tolerance) -> dict[str, Tolerance]:
    quadrature = Term(QUADRATURE, "the quadrature of the equations")
    words = "the quadrature of the equations, of a value and of its part of the sky"
    few = Term(1.6 / 64, "a sum over MaterialX's 64 directions")
    return {
        **ERRORS,
        **lobes.lobe_errors(MEAN, ENVIRONMENT, throughput, FRAME, QUADRATURE),
        **dict.fromkeys(("value", "reciprocity"), VALUE),
        "anisotropic_throughput": throughput.plus(ANISOTROPIC, ANISOTROPIC_LOBE),
        # An error of E_ss cancels, because values rise by as much as throughputs fall.
        "light": sum_in(Quantity.LIGHT, *throughput.terms[1:], quadrature),
        "methods": ENVIRONMENT.plus(PREFILTERED, few),
        "sky": sum_in(Quantity.IRRADIANCE, Term(2.0 * QUADRATURE, words), sum_over(1024), TEXEL),
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class FacetSpec(lobes.PbrSpec):
    counts: Counts = COUNTS
    least_cosine: float = sheen.FIT_COSINE

    def prefiltered(self, batch: Batch) -> Array:
        """Albedo that MaterialX fits for prefiltered environments, (N, 3)."""
        return batch.strength * LOBES[self.node].prefiltered(batch.wo, spec.broadcast_inputs(batch))

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """The usual batches, and pairs near the mirror direction. All lobes are isotropic."""
        batches = (batch.where(_has_curve(batch)) for batch in super().batches(counts))
        return tuple(_with_one_alpha(batch) for batch in (*batches, self.mirrored(counts)[0]))

    @property
    def value_candidates(self) -> tuple[samples.Candidate, ...]:
        """The candidates whose values differ from the model's values for isotropic lobes."""
        return tuple(each for each in self.all_candidates if not each.anisotropic)

    @property
    def all_candidates(self) -> tuple[samples.Candidate, ...]:
        return super().value_candidates

    def anisotropic(self, counts: Counts) -> Batch:
        """Pairs near the mirror direction, with anisotropic materials in the domain of the fits."""
        batch = self.mirrored(counts)[0]
        alpha = batch.inputs["roughness"]
        least = alpha.max(axis=1, keepdims=True) / LARGEST_RATIO
        batch = batch.altered(roughness=np.maximum(alpha, least))
        return batch.where(batch.wo[:, 2] >= LEAST_ANISOTROPIC_COSINE)

    def few(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        return *super().few(batches, counts), batches[-1].first(counts.few)

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views for albedos, with simplified inputs and without negative Fresnel curves.

        Lobes with an alpha below LEAST_ALPHA become perfectly smooth.
        """
        views = []
        for batch in super().views(batches, counts):
            inputs = simple(batch.inputs)
            inputs["roughness"][inputs["roughness"] < LEAST_ALPHA] = 0.0
            positive = ~np.broadcast_to(falls_below_0(inputs), len(batch.wo))
            views.append(replace(batch, inputs=inputs).where(positive))
        return tuple(views)

    def mirrored(self, counts: Counts) -> tuple[Batch, Batch]:
        """Random views, each with two light directions, which are reflections at visible facets."""
        rng, count = generator(), counts.mirrored
        wo, inputs = directions(rng, count), self.random_inputs(rng, count)
        alpha = inputs["roughness"]
        first, second = (reflected(wo, alpha, *rng.random((2, count))) for _ in range(2))
        above = (np.minimum(first[:, 2], second[:, 2]) > 0.0) & (wo[:, 2] > 0.0)
        batches = Batch(wo, first, inputs), Batch(wo, second, inputs)
        known = above & _has_curve(batches[0]) & _has_curve(batches[1])
        return batches[0].where(known), batches[1].where(known)

    def stretched(self, counts: Counts) -> tuple[Batch, Array]:
        """Random views of anisotropic materials, and the albedo at each view."""
        rng, count = generator(), counts.materials
        inputs = simple(self.random_inputs(rng, count))
        inputs["roughness"] = rounded(LEAST_STRETCHED ** rng.random((2, count)))
        batch = Batch(directions(rng, count), directions(rng, count), inputs)
        batch = batch.where(batch.wo[:, 2] >= LEAST_STRETCHED)
        return batch, self.integral(batch)

    def stretched_sums(self, counts: Counts) -> tuple[Batch, Array]:
        """The views of `stretched`, and the albedos that MaterialX's environment sums compute."""
        batch, _ = self.stretched(counts)
        return batch, batch.strength * node_albedo(self.node, batch.wo, batch.inputs, summed=True)

    def single(self, batch: Batch) -> Array:
        """Values without compensation for multiple scattering."""
        return self.values(partial(LOBES[self.node].value, terms=Lobe(uncompensated)), batch)

    def summed(self, pairs: Batch) -> Array:
        """Values without compensation. G_2 / G_1 uses the mean alpha, as MaterialX's sums do."""
        alpha = pairs.inputs["roughness"]
        mean = np.sqrt(alpha.prod(axis=1))
        weight = smith_g2(pairs.wo[:, 2], pairs.wi[:, 2], mean)
        weight = weight / smith_g1(pairs.wo, np.stack([mean, mean], axis=1))
        weight *= smith_g1(pairs.wo, alpha) / smith_g2_anisotropic(pairs.wo, pairs.wi, alpha)
        return np.asarray(self.single(pairs) * weight[:, np.newaxis])

    def turned(self, counts: Counts) -> Batch:
        """Pairs with individual frames. Lobes are rough, because rounding displaces sharp lobes."""
        batch = super().turned(counts)
        rough = np.maximum(batch.inputs["roughness"], samples.LEAST_TURNED)
        return denser(batch.altered(roughness=rough))

    def integrable(self, inputs: dict[str, Array]) -> dict[str, Array]:
        """Inputs without negative Fresnel curves. Fits of albedos do not clamp such curves to 0."""
        changed = simple(inputs)
        if "color82" in changed:
            changed["color82"][falls_below_0(changed)] = 1.0
        return changed

    def nodes(self, wo: Array, inputs: dict[str, Array], count: int) -> tuple[Array, Array]:
        # Reflect the view at visible facets, which Gauss nodes and uniform azimuths select.
        x, w = np.polynomial.legendre.leggauss(count)
        height, around = np.meshgrid(0.5 * (x + 1.0), (np.arange(count) + 0.5) / count)
        size = height.size
        views, alpha = (np.repeat(each, size, axis=0) for each in (wo, inputs["roughness"]))
        wi = reflected(views, alpha, *(np.tile(each.ravel(), len(wo)) for each in (height, around)))
        lit = wi[:, 2] > 0.0
        wi[~lit] = (0.0, 0.0, 1.0)
        density = np.where(lit, sampling.ggx_pdf(views, wi, alpha), np.inf)
        weights = np.tile(np.meshgrid(0.5 * w, np.ones(count))[0].ravel() / count, len(wo))
        return wi.reshape(len(wo), size, 3), (weights / (np.pi * density)).reshape(len(wo), size)


def denser(batch: Batch) -> Batch:
    """Invert IORs below 1, because the Fresnel curve is too steep at a critical angle."""
    if "tint" not in batch.inputs:
        return batch
    index = np.maximum(batch.inputs["ior"], LEAST_INVERTED)
    return batch.altered(ior=np.maximum(index, 1.0 / index))


def simple(inputs: Mapping[str, Array]) -> dict[str, Array]:
    """Inputs for which the albedo has a closed form and a quadrature is accurate.

    Roughness becomes isotropic. The IOR of a dielectric becomes 1 or at least LEAST_INDEX. For an
    IOR below 1, a quadrature does not resolve the critical angle. An IOR between 1 and LEAST_INDEX
    is outside the domain of the shaders' fits (see docs/loading.md). color82 becomes at least
    LEAST_COLOR82, because a Fresnel curve with a deep dip at 82 degrees is negative.
    """
    changed = dict(inputs)
    changed["roughness"] = np.repeat(inputs["roughness"][:, :1], 2, axis=1)
    if np.ndim(inputs.get("ior", ())) == 1 and np.size(inputs.get("ior", ())):
        index = np.asarray(inputs["ior"])
        changed["ior"] = np.where(index > 1.0, np.maximum(index, LEAST_INDEX), 1.0)
    if "color82" in inputs:
        changed["color82"] = np.maximum(inputs["color82"], samples.LEAST_COLOR82)
    return changed


def _with_one_alpha(batch: Batch) -> Batch:
    alpha = np.broadcast_to(batch.inputs["roughness"], (len(batch.wo), 2))
    return batch.altered(roughness=np.repeat(alpha[:, :1], 2, axis=1))


def _has_curve(batch: Batch) -> samples.Mask:
    """Mask of pairs whose Fresnel curve is accurate in float32 and at least 0.

    A correct shader may compute the curve from wo . wh or from wi . wh. The two cosines differ by
    (|wo|^2 - |wi|^2) / |wo + wi|, because rounded vectors are not exactly unit vectors. If wo and
    wi are nearly opposite, the cosines differ too much, and shaders clamp the cosine to GRAZING. A
    curve with a dark color90 then has few correct digits.
    """
    length = np.linalg.norm(batch.wo + batch.wi, axis=1)
    rounding = np.abs((batch.wo**2).sum(axis=1) - (batch.wi**2).sum(axis=1))
    bright = np.max(batch.inputs.get("color90", np.ones((1, 3))), axis=1) >= RIM_COLOR
    known = (rounding <= COSINE_STEP * length) & (length >= 2.0 * samples.GRAZING)
    return np.asarray(known & (bright | (length >= RIM_COLOR)) & ~is_below_0(batch))


def is_below_0(batch: Batch) -> samples.Mask:
    """Mask of pairs for which the equation of the Fresnel curve is negative in some channel."""
    cosines = np.minimum(0.5 * np.linalg.norm(batch.wo + batch.wi, axis=1), 1.0)
    return _below_0(batch.inputs, cosines)


def falls_below_0(inputs: Mapping[str, Array]) -> samples.Mask:
    """Mask of materials for which the equation of the Fresnel curve is negative at some cosine."""
    return np.asarray(np.any([_below_0(inputs, each) for each in COSINES], axis=0))


def _below_0(inputs: Mapping[str, Array], cosine: Array | float) -> samples.Mask:
    if "color82" not in inputs:
        return np.zeros(1, bool)
    color0, color82, color90 = (inputs[name] for name in ("color0", "color82", "color90"))
    F = fresnel.fresnel_schlick(cosine, color0, color82, color90, inputs["exponent"])
    return np.asarray((F < 0.0).any(axis=-1))


def reflected(wo: Array, alpha: Array, height: Array, around: Array) -> Array:
    """Views reflected at visible GGX facets, (N, 3). Two numbers in [0, 1] select each facet."""
    return samples.float32(sampling.ggx_sample(wo, np.stack([height, around], axis=-1), alpha)[0])


FACET_SPECS = tuple(
    FacetSpec(
        **lobes.mode_of(row),
        inputs=INPUTS[row.category],
        outside_errors=OUTSIDE_ERRORS,
        errors=facet_errors(SCHLICK_THROUGHPUT if row.name == "schlick" else THROUGHPUT),
    )
    for row in MICROFACET_NODES
)


# Largest slope of a Fresnel curve at cosines that differ from the critical cosine by 0.05 or more.
FRESNEL_SLOPE = 7.3


def transmission_errors(passed: Tolerance) -> dict[str, Tolerance]:
    reflected, lit = ENVIRONMENT.term("a reflected albedo"), passed.term("light that passes")
    smooth = Term(SMOOTH_ESS_FIT, "the fit of E_ss for smooth lobes")
    steep = roundings(4 * FRESNEL_SLOPE, "(four of a cosine, times the Fresnel slope 7.3)")
    return {
        "methods": passed.plus(PREFILTERED),
        "value": passed,  # the values of this spec are transmitted light
        "light": sum_in(Quantity.LIGHT, reflected, lit),
        "kept": lobes.BURLEY_VALUE,  # compares two evaluations of the same function
        "inside": PASSING.plus(sum_over(1024)),
        "rough_refraction": sum_in(Quantity.IRRADIANCE, sum_over(1024), TEXEL),
        "states": sum_of(roundings(32, "of the same parts in two programs")),
        "critical": sum_in(Quantity.ALBEDO, smooth, steep, roundings(16)),
    }


@dataclass(frozen=True, eq=False, kw_only=True)
class TransmissionSpec(FacetSpec):
    """A microfacet node that transmits light, in mode T or RT."""

    requires = spec.Ability.LOBE | spec.Ability.TRANSMISSION
    # In a rotated frame, roundings change which refracted samples are totally reflected.
    plain = ("frame", "shape")

    @property
    def functions(self) -> microfacets.Transmission:
        return microfacets.TRANSMISSIONS[self.node]

    @property
    def reflects(self) -> bool:
        return self.row.fixed["scatter_mode"] == "RT"

    def ends(self, batch: Batch) -> Array:
        """Light that the BTDF transmits, and all light that is not reflected, (2, N, 3)."""
        wo, inputs, functions = batch.wo, batch.inputs, self.functions
        rest = functions.tint(inputs) * (1.0 - functions.reflected(wo, inputs))
        return np.stack([functions.passed(wo, inputs, True), np.maximum(rest, 0.0)])

    def reversed(self, mu: Array, alpha: float, index: float, inputs: Mapping[str, Array]) -> Array:
        """Share of light that leaves a medium of IOR `index`; the mean over channels, (N,)."""

        def reflected(cosines: Array) -> Array:
            views = samples.directions_at(cosines, 0.0)
            whole = {name: np.repeat(each, len(views), axis=0) for name, each in inputs.items()}
            whole["roughness"] = np.full((len(views), 2), alpha)
            return self.functions.reflected(views, whole)

        passed = transmission.reversed_transmittance(mu, alpha, 1.0 / index, reflected)
        return np.asarray(passed.mean(axis=1))

    @property
    def reflection(self) -> FacetSpec:
        """The spec of the same node in mode R."""
        row = replace(self.row, fixed={"scatter_mode": "R"})
        inputs, errors = self.inputs, self.errors
        return FacetSpec(**lobes.mode_of(row), inputs=inputs, errors=errors, counts=self.counts)


TRANSMISSION_SPECS = tuple(
    TransmissionSpec(
        **lobes.mode_of(row),
        inputs=INPUTS[row.category],
        errors=transmission_errors(THROUGHPUT if "tint" in row.inputs else SCHLICK_THROUGHPUT),
        prefiltered_fits={"value": (PREFILTERED,)},
    )
    for row in TRANSMISSION_NODES
)


# --- thin films -----------------------------------------------------------------------------------

# Error of a film's albedo for cosines of at least 0.1 and films of up to 1000 nm, measured by
# tools/fits/thin_film.py. Shaders average a film's reflectance over visible facets by a sum over
# three cosines, and over the hemisphere (F_ss) by another sum over three cosines.
FILM_SEEN = 7.82e-2
FILM_OILED = 6.92e-2  # error of a film's albedo for films with an IOR of at least 1.25
FILM_PHASE = 71.0  # phase of the first order of interference, in radians, at 1000 nm and IOR 2.5
CURVE_ROUNDINGS = 10 * 9.5 + 16  # 10 in a phase, times the curve's slope 9.5, plus 16 in the curve

FILM_ALBEDO = sum_in(
    Quantity.ALBEDO,
    Term(FILM_OILED, "the mean over visible facets and F_ss, from three cosines each"),
    Term(ESS_FIT, "the fit of E_ss"),
)
# If a metal has a lower IOR than the film, light is totally reflected, and three cosines do not
# resolve the fringes.
FILM_TRAPPED = single(FILM_SEEN - FILM_OILED, Quantity.ALBEDO, "films with an IOR below 1.25")

# In a picture, the error at each point is weighted by the view's cosine.
FILM_SHOWN = sum_in(
    Quantity.PICTURE,
    Term(2.59e-2, "the mean over visible facets and F_ss, times the cosine"),
    Term(ESS_FIT, "the fit of E_ss"),
)
FILM_AVERAGE = 3.61e-2  # largest error of a film's F_ss that is computed from three cosines


def film_terms(alpha: float) -> tuple[Term, Term]:
    """Errors of a lobe under a film in direct light, due to F_ss and to the Fresnel curve."""
    mu = np.linspace(1e-3, 1.0, 64)
    E = ggx_albedo_dir(mu, alpha)
    lost = min(COMPENSATED, float((mu * (1.0 - E) / E).max()))
    return Term(FILM_AVERAGE * lost, f"film F_ss from three cosines, times {lost:.2g}"), UNSUMMED


def _mean(value: float, words: str) -> Tolerance:
    """Tolerance of the rms error of a set of films, measured by tools/fits/thin_film.py."""
    return single(value, Quantity.REFLECTANCE_RMS, words, tolerance.root_mean_square)


# Omitted orders of interference matter most for thin films on metals at grazing views.
UNSUMMED = Term(8e-4, "omitted interference orders")
FILM_VALUE = sum_of(*compensated(FILM_AVERAGE, "F_ss from three cosines").terms, UNSUMMED)
# fmt: off
FILM_ERRORS = {
    "value": FILM_VALUE,
    "anisotropic_value": FILM_VALUE.plus(ANISOTROPIC),
    "albedo": FILM_ALBEDO,
    "throughput": FILM_ALBEDO,
    "anisotropic_throughput": _mean(6e-3, "the anisotropic fits, over 24 sets of 32 films of 50 to 100 nm"),
    "film_curve": sum_in(
        Quantity.REFLECTANCE,
        Term(2.4e-6, "omitted interference orders, from 200 nm and a cosine of 0.3 on"),
        Term(0.65 * 2.8e-5, "the fit of E_ss at alpha 1e-3, times F (1 - F_ss)"),
        roundings(CURVE_ROUNDINGS, "(10 in a phase, times the slope 9.5, plus 16)")),
    "film_orders": sum_of(
        Term(8.7e-7, "omitted interference orders, rms over 1024 films of 40 to 100 nm"),
        Term(1.5e-4, "the fit of E_ss at alpha 1e-3 and cosines of 0.1 to 0.2"),
        quantity=Quantity.REFLECTANCE_RMS, metric=tolerance.root_mean_square),
    # With any film, even a film without effect, shaders compute F_ss from three cosines. Without a
    # film, shaders compute F_ss by a fit.
    "film_limit": sum_of(Term(4.4e-3 * COMPENSATED, "F_ss from three cosines, times 0.6")),
    "film_energy": VALUE,
    "retroreflection": lobes.BURLEY_VALUE,
    "film_average": _mean(7e-3, "F_ss from three cosines, for films of 50 to 1000 nm"),
    "film_smooth": _mean(1e-5, "F_ss from three cosines, times the light lost at alpha 0.04"),
    "film_visible": _mean(1.9e-3, "visible facets from three cosines, for films of 50 to 100 nm"),
    "film_glossy": _mean(1.1e-3, "visible facets from three cosines, for alpha 0.03 to 0.1"),
    "frame": FRAME.plus(roundings(2 * CURVE_ROUNDINGS, "(10 in a phase, times 9.5, plus 16, in each of two values)")),
}
# fmt: on


class Films(NamedTuple):
    """Ranges for a random set of lobes under films, with lights in the mirror direction."""

    size: int
    alpha: tuple[float, float]
    mu: tuple[float, float]
    thickness: tuple[float, float]  # range in nm


# Rough lobes under films with few fringes. tools/fits/thin_film.py measures the mean errors.
STEEP = Films(1 << 6, (0.6, 1.0), (0.6, 1.0), (50.0, 100.0))
FRINGED = STEEP._replace(thickness=(50.0, 1000.0))
GLOSSY = STEEP._replace(alpha=(0.03, 0.1))  # visible facets are similar, so few cosines suffice
# Lobes with two alphas. Shaders use the albedos of isotropic lobes as approximations.
BRUSHED = Films(1 << 5, (0.05, 1.0), (0.1, 1.0), (50.0, 100.0))
# Smooth lobes reflect at nearly one cosine. Few orders of interference matter.
SHARP = Films(1 << 6, (1e-3, 1e-3), (0.3, 1.0), (200.0, 1000.0))
# Smooth lobes at grazing views under thin films. Many orders of interference matter.
ORDERED = Films(1 << 10, (1e-3, 1e-3), (0.1, 0.2), (40.0, 100.0))
# Numbers of samples are small, because averages of films are slow.
FILM_COUNTS = Counts(1 << 8, 1 << 6, diagnosed=1 << 5, albedos=24, materials=16)
LEAST_OIL = 1.2  # smallest IOR of films with a visible effect
LEAST_FILM = 1.25  # smallest IOR of films in albedo checks; below 1.25, metals may reflect totally
LEAST_FACET = 0.1  # smallest cosine to the half vector; smaller cosines need all orders
THICK = (0.0, 1.0, 100.0, 1e4)  # film thicknesses at the edges of the domain, in nm


@dataclass(frozen=True, eq=False, kw_only=True)
class FilmSpec(FacetSpec):
    """A microfacet node under a thin film."""

    requires = spec.Ability.LOBE | spec.Ability.FILM

    counts: Counts = FILM_COUNTS

    least_cosine: float = LEAST_FACET

    @property
    def bounded(self) -> tuple[spec.Input, ...]:
        return tuple(each for each in super().bounded if each.name.startswith("thinfilm"))

    def random_inputs(self, rng: samples.Rng, count: int, edged: bool = False) -> dict[str, Array]:
        """Random inputs with IORs of at least 1. If `edged`, some films have the base's IOR.

        For IORs below 1, averages over few cosines do not resolve the curve at the critical angle.
        """
        inputs = super().random_inputs(rng, count, edged)
        if "tint" in inputs:
            inputs["ior"] = np.maximum(inputs["ior"], 1.0)
            if edged:
                same = rng.random(count) < 0.25
                inputs["thinfilm_ior"] = np.where(same, inputs["ior"], inputs["thinfilm_ior"])
        return inputs

    def values(self, function: Scattering, batch: Batch) -> Array:
        """Values with films whose IOR is raised to at least 1."""
        index = np.maximum(batch.inputs["thinfilm_ior"], 1.0)
        return super().values(function, batch.altered(thinfilm_ior=index))

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs, special pairs, and pairs near the mirror direction."""
        rng, count = generator(), counts.pairs
        special = _some_special(rng, count)
        random = directions(rng, count), directions(rng, count)
        pairs = self._batch(rng, random), self._batch(rng, special, edged=True)
        batches = (*pairs, self.mirrored(counts)[0].first(count))
        return tuple(_with_one_alpha(batch.where(_steep(batch))) for batch in batches)

    def anisotropic(self, counts: Counts) -> Batch:
        batch = super().anisotropic(counts).first(counts.pairs)
        return batch.where(_steep(batch))

    def stretched(self, counts: Counts) -> tuple[Batch, Array]:
        """Random views of anisotropic lobes under thin films, and the albedo at each view."""
        batch, rng = film_views(self, BRUSHED), generator()
        alpha = rounded(LEAST_STRETCHED ** rng.random((2, BRUSHED.size)))
        batch = batch.altered(roughness=alpha, weight=1.0)
        return batch, self.integral(batch)

    few = spec.ValueSpec.few

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views of random pairs, and views at which averages over three cosines are inaccurate."""
        batch = batches[0].where(batches[0].wo[:, 2] >= self.least_cosine)
        easy = batch.first(counts.albedos)
        easy = replace(easy, inputs=simple(easy.inputs))
        if "tint" in easy.inputs:
            easy = easy.with_row(BUBBLE_ROW, samples.directions_at(0.9, 0.0), **BUBBLE)
        hard = Films(counts.albedos, (0.08, 0.8), (0.1, 0.35), (200.0, 1000.0))
        return tuple(
            batch.altered(thinfilm_ior=np.maximum(batch.inputs["thinfilm_ior"], LEAST_FILM))
            for batch in (easy, film_views(self, hard))
        )

    def edges(self, counts: Counts) -> Batch:
        """Special pairs with extreme inputs, very thick films, and films of IOR 0."""
        rng = generator()
        wo, wi = _some_special(rng, 2 * counts.pairs)
        inputs = self.random_inputs(rng, len(wo), edged=True)
        inputs["thinfilm_thickness"] = rng.choice(THICK, len(wo))
        inputs["thinfilm_ior"][::16] = 0.0
        return Batch(wo, wi, inputs)


def _some_special(rng: samples.Rng, count: int) -> tuple[Array, Array]:
    wo, wi = samples.special_directions(rng)
    picked = rng.permutation(len(wo))[:count]
    return wo[picked], wi[picked]


def film_views(node: lobes.PbrSpec, films: Films) -> Batch:
    rng, (count, *ranges) = generator(), films
    alpha, mu, thickness = (low + (high - low) * rng.random(count) for low, high in ranges)
    wo = samples.directions_at(mu, 2.0 * np.pi * rng.random(count))
    inputs = simple(node.random_inputs(rng, count))
    inputs["thinfilm_ior"] = np.maximum(inputs["thinfilm_ior"], LEAST_OIL)
    inputs["roughness"] = rounded([alpha, alpha])
    inputs["thinfilm_thickness"] = rounded([thickness])[:, 0]
    if "tint" in inputs:
        inputs["tint"] = np.ones((count, 3))
    return Batch(wo, wo * [-1.0, -1.0, 1.0], inputs)


def _steep(batch: Batch) -> np.ndarray:
    """Mask of pairs whose half vector has a cosine of at least LEAST_FACET to the view."""
    half = batch.wo + batch.wi
    length = np.linalg.norm(half, axis=1)
    cosine = np.abs((half * batch.wo).sum(axis=1)) / np.maximum(length, 1e-12)
    return np.asarray(cosine >= LEAST_FACET)


# For films of at least 200 nm, the reflectance has twice the error of the engine's cosine or sine.
WAVE_ERROR = spec.EngineError(
    "the engine's own cosine and sine, times 2",
    spec.WAVE.error(lambda: [samples.float32(np.linspace(0.0, FILM_PHASE, spec.ARGUMENTS))], 2.0),
    2.0,
)
FILM_SPECS = tuple(
    FilmSpec(
        **lobes.mode_of(row, f"{row.category}, thin film"),
        inputs=INPUTS[row.category],
        errors=FILM_ERRORS,
        engines=dict.fromkeys(("film_curve", "film_orders"), (WAVE_ERROR,)),
    )
    for row in FILM_NODES
)
