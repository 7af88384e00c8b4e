# SPDX-License-Identifier: Apache-2.0
"""How exact each kind of probe is: one row for each, with a tolerance, the bound of a check, for each quantity."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

from mxeon.conformance.accuracy import (
    bsdf,
    diffuse,
    emission,
    hair,
    rendered,
    surface_shaders,
    thin_films,
    utilities,
)
from mxeon.conformance.nodes import kinds
from mxeon.conformance.samples.measurement import scaled
from mxeon.conformance.samples.tolerance import ROUNDING, SCALED, Tolerance, rounded_up

Quantity: TypeAlias = Literal[
    "value",
    "albedo",
    "throughput",
    "frame",
    "integral",
    "light",
    "reciprocity",
    "lambert",
    "difference",
]


@dataclass(frozen=True)
class Accuracy:
    """Tolerances of a kind of probe by quantity; None where no check asks it for one."""

    # Of values in direct light, radiances, transmittances and outputs.
    value: Tolerance | None = None
    albedo: Tolerance | None = None
    throughput: Tolerance | None = None
    frame: Tolerance | None = None  # of values and albedos in turned frames
    integral: Tolerance | None = None  # of values summed over directions
    light: Tolerance | None = None  # of all light that a lobe and what lies below it return
    reciprocity: Tolerance | None = None  # of values times both cosines
    lambert: Tolerance | None = None  # of values that have no roughness
    # Whether its host evaluates any pairs of directions, those at the edges of the domain too.
    pairs: bool = True
    # Whether the host itself finds light and lets it pass, or tells closures alone.
    lit: bool = True

    @property
    def difference(self) -> Tolerance | None:
        return self.value and diffuse.difference_of(self.value)

    def of(self, quantity: Quantity) -> Tolerance | None:
        tolerance: Tolerance | None = getattr(self, quantity)
        return tolerance


def _lobe(
    kind: str,
    value: Tolerance,
    albedo: Tolerance,
    frame: Tolerance,
    throughput: Tolerance | None = None,
    light: Tolerance | None = None,
    mean: Tolerance | None = None,
) -> Accuracy:
    """Accuracy of a BSDF node on a host that evaluates any pairs; `mean` of values in an integral."""
    passed = throughput or albedo
    integral = bsdf.integral_of(mean or value, bsdf.QUADRATURES[kind])
    light = light or bsdf.layer_of(integral, passed)
    return Accuracy(value, albedo, passed, frame, integral, light, reciprocity=value)


def _seen(
    value: Tolerance, albedo: Tolerance | None = None, lambert: Tolerance | None = None
) -> Accuracy:
    """Accuracy of a host that shows a node from some directions."""
    return Accuracy(value, albedo, lambert=lambert, pairs=False)


def _emission(kind: str) -> Accuracy:
    """Accuracy of an emission on a host that evaluates any views."""
    return Accuracy(emission.RADIANCES[kind], integral=emission.EXITANCES[kind])


# Values and albedos of nodes that hosts show on a mesh, by kind.
SHOWN: Mapping[str, tuple[Tolerance, Tolerance]] = {
    kinds.CLOSED: (bsdf.DIFFUSE_VALUE, bsdf.CLOSED_ALBEDO),
    kinds.SHEEN: (bsdf.ZELTNER_VALUE, bsdf.CLOSED_ALBEDO),
    kinds.FITTED: (bsdf.CONTY_KULLA_VALUE, bsdf.CONTY_KULLA_ALBEDO),
    kinds.MICROFACET: (bsdf.MICROFACET_VALUE, bsdf.MICROFACET_PICTURE),
    kinds.SCHLICK: (bsdf.MICROFACET_VALUE, bsdf.MICROFACET_PICTURE),
}

# By kind of probe on a host that lights what it shows or evaluates.
LIT: dict[str, Accuracy] = {
    kinds.DIFFUSE: Accuracy(
        diffuse.VALUE,
        diffuse.ENVIRONMENT,
        frame=diffuse.FRAME,
        integral=diffuse.INTEGRAL,
        reciprocity=diffuse.RECIPROCITY,
        lambert=diffuse.LAMBERT,
    ),
    kinds.PICTURE: _seen(diffuse.CYCLES_RAY, diffuse.CYCLES_NOISE, diffuse.CYCLES_RAY),
    kinds.drawn_kind("drawn", kinds.DIFFUSE): _seen(
        diffuse.EXACT, diffuse.EXACT_SURROUNDINGS, diffuse.EXACT
    ),
    kinds.drawn_kind("drawn", kinds.LOBE): _seen(diffuse.LOBE),
    **{
        kinds.drawn_kind("drawn", kind): _seen(diffuse.drawn_of(value), diffuse.drawn_of(albedo))
        for kind, (value, albedo) in SHOWN.items()
    },
    kinds.drawn_kind("half", kinds.DIFFUSE): _seen(
        diffuse.HALF, diffuse.HALF_SURROUNDINGS, diffuse.HALF
    ),
    kinds.drawn_kind("half", kinds.LOBE): _seen(diffuse.HALF_LOBE),
    **{
        kinds.drawn_kind("half", kind): _seen(diffuse.drawn_of(value, diffuse.HALF_CUT))
        for kind, (value, _) in SHOWN.items()
        if kind != kinds.SHEEN  # Storm takes the mode's default
    },
    kinds.LOBE: _seen(diffuse.LOBE),
    kinds.EXACT: _seen(diffuse.EXACT, diffuse.EXACT_SURROUNDINGS, diffuse.EXACT),
    kinds.FACET: _seen(diffuse.FACETS, diffuse.FACET_NOISE, diffuse.FACETS),
    kinds.COARSE_FACET: _seen(diffuse.COARSE_FACETS, diffuse.COARSE_FACETS),
    kinds.FACET_PAIR: Accuracy(
        diffuse.FACET_PAIRS, diffuse.FACET_NOISE, reciprocity=diffuse.FACET_PAIRS, pairs=False
    ),
    kinds.CLOSED: _lobe(kinds.CLOSED, bsdf.DIFFUSE_VALUE, bsdf.CLOSED_ALBEDO, bsdf.FLAT_FRAME),
    kinds.SUBSURFACE: _lobe(kinds.CLOSED, bsdf.DIFFUSE_VALUE, bsdf.CLOSED_ALBEDO, bsdf.FLAT_FRAME),
    kinds.SHEEN: _lobe(kinds.SHEEN, bsdf.ZELTNER_VALUE, bsdf.CLOSED_ALBEDO, bsdf.FLAT_FRAME),
    kinds.FITTED: replace(
        _lobe(kinds.FITTED, bsdf.CONTY_KULLA_VALUE, bsdf.CONTY_KULLA_ALBEDO, bsdf.FLAT_FRAME),
        reciprocity=bsdf.EXCHANGED,
    ),
    kinds.MICROFACET: _lobe(
        kinds.MICROFACET,
        bsdf.MICROFACET_VALUE,
        bsdf.MICROFACET_ENVIRONMENT,
        bsdf.MICROFACET_FRAME,
        bsdf.MICROFACET_ALBEDO,
        light=bsdf.WHITE_FURNACE,
        mean=bsdf.MICROFACET_MEAN,
    ),
    kinds.SCHLICK: _lobe(
        kinds.SCHLICK,
        bsdf.MICROFACET_VALUE,
        bsdf.MICROFACET_ENVIRONMENT,
        bsdf.MICROFACET_FRAME,
        bsdf.SCHLICK_THROUGHPUT,
        bsdf.WHITE_FURNACE,
        bsdf.MICROFACET_MEAN,
    ),
    kinds.HAIR: _lobe(
        kinds.HAIR, hair.HAIR_VALUE, hair.HAIR_ALBEDO, hair.HAIR_FRAME, mean=hair.HAIR_MEAN
    ),
    kinds.COMBINED: Accuracy(bsdf.COMBINED_VALUE, bsdf.COMBINED_ALBEDO, bsdf.COMBINED_ALBEDO),
    kinds.NESTED: Accuracy(bsdf.NESTED_VALUE, bsdf.COMBINED_ALBEDO, bsdf.COMBINED_ALBEDO),
    kinds.FILM: Accuracy(thin_films.FILM_VALUE, thin_films.FILM_ALBEDO, thin_films.FILM_ALBEDO),
    kinds.TRANSMISSION: Accuracy(
        bsdf.MICROFACET_ALBEDO, light=bsdf.clear_of(bsdf.MICROFACET_ALBEDO)
    ),
    kinds.SCHLICK_TRANSMISSION: Accuracy(
        bsdf.SCHLICK_THROUGHPUT, light=bsdf.clear_of(bsdf.SCHLICK_THROUGHPUT)
    ),
    kinds.EMISSION: _emission(kinds.EMISSION),
    kinds.POWER_EMISSION: _emission(kinds.POWER_EMISSION),
    kinds.CONE_EMISSION: _emission(kinds.CONE_EMISSION),
    kinds.EMISSION_PICTURE: _seen(emission.PICTURE_RADIANCE),
    kinds.MEDIUM: Accuracy(emission.TRANSMITTANCE),
    kinds.EMITTING_SURFACE: _seen(emission.OPACITY),
    kinds.ABSENT: Accuracy(),
    kinds.UTILITY: Accuracy(utilities.ALPHA),  # each output has its own
    kinds.UTILITY_OSL: _seen(utilities.ALPHA),
    kinds.SURFACE_SHADER: Accuracy(surface_shaders.VALUE, surface_shaders.ALBEDO),
}


# Of closures, whose arguments OSL prints and the models evaluate in float64.
ARGUMENTS = Tolerance(
    ROUNDING,
    SCALED,
    scaled,
    "nine digits tell a float32 to its last bit, so that arguments and weights are those of the document; "
    "the models round in float64, 2^-53, and the sharpest lobe, of alpha 1e-4, takes that 1e8 times: "
    "less than one rounding of float32, 2^-24",
)
GRAPH = Tolerance(
    rounded_up(4 * 16 * ROUNDING),
    SCALED,
    scaled,
    "16 roundings of float32, 2^-24 each, on the way from an input to an argument, times 4, as the logarithm "
    "of a distribution changes with that of alpha; rounded up",
)


def _of_closures(shown: Accuracy, value: Tolerance) -> Accuracy:
    """Accuracy of closures, by that of a host that evaluates: frames are turned in float32."""
    light = value if shown.throughput else None
    return Accuracy(value, value, light, shown.frame, lambert=shown.lambert and value, lit=False)


def _rendered(kind: str, flat: Tolerance, sharp: Tolerance) -> Accuracy:
    """Accuracy of a renderer's closures of a kind; its environments have noise."""
    value = flat if kind in rendered.FLAT_KINDS else sharp
    if kind == kinds.LOBE:
        return Accuracy(rendered.BELOW, pairs=False, lit=False)
    return Accuracy(
        value,
        rendered.NOISE,
        rendered.PASSED,
        integral=rendered.INTEGRAL,
        light=rendered.LIGHT,
        reciprocity=value,
        lambert=flat,
        lit=False,
    )


# By kind of probe.
ACCURACY: Mapping[str, Accuracy] = (
    LIT
    | {
        kinds.closure_kind(kind): _of_closures(
            LIT[kind], GRAPH if kind == kinds.SURFACE_SHADER else ARGUMENTS
        )
        for kind in kinds.TOLD
    }
    | {
        kinds.rendered_kind(kind): _rendered(kind, rendered.FLAT, rendered.SHARP)
        for kind in kinds.RENDERED
    }
    | {
        kinds.rendered_kind(kind, kinds.TRACED): _rendered(
            kind, rendered.TRACED_FLAT, rendered.TRACED_SHARP
        )
        for kind in kinds.TRACED_CLOSURES
    }
)
