# SPDX-License-Identifier: Apache-2.0
"""The table of checks: a claim, how it is measured, how wrong it may be, and what it must catch.

A check passes at error <= tolerance. Its control is the same probe made wrong on purpose, on the same
host; the check has to fail on it. Every tolerance is the expression that its derivation describes.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from mxeon.conformance import diagnosis, wiring
from mxeon.conformance.checks import (
    bsdf_measures,
    bsdf_tolerances,
    measures,
    sampling_measures,
    tolerances,
)
from mxeon.conformance.checks.bsdfs import BSDFS, COMBINED, KINDS, MICROFACET, MICROFACET_KINDS
from mxeon.conformance.checks.controls import (
    drop_changes,
    gray,
    isotropic,
    offset,
    pass_all,
    rougher,
    scale,
    scale_cosine,
    shifted,
    take_response,
    with_inputs,
)
from mxeon.conformance.checks.engine import on_engine
from mxeon.conformance.checks.measures import Measurement, Metric
from mxeon.conformance.checks.nodes import OwnNode, Surface
from mxeon.conformance.checks.tolerance import Tolerance
from mxeon.conformance.diagnosis import Diagnosis
from mxeon.models.pbr_combinations import COMBINATIONS
from mxeon.models.pbr_microfacets import MICROFACET_NODES
from mxeon.models.pbrlib import NODES
from mxeon.shaders.hosts import front_lit_only
from mxeon.shaders.nodes import FLAG

EON = ("eon", "eon_fitted")
ANY = (*EON, "qon")
OTHERS = (*(row.name for row in NODES), "burley_lambert")
MICROFACETS = tuple(row.name for row in MICROFACET_NODES)
COMBINATION = tuple(row.name for row in COMBINATIONS)
LAYERS = tuple(row.name for row in NODES if row.layerable)
OPAQUE = tuple(row.name for row in NODES if not row.layerable)
BLACK = tuple(subject.model for subject in BSDFS if subject.black)
RECIPROCAL = tuple(row.name for row in NODES if row.reciprocal)
SMOOTH = ("lambert",)
ROUGH = (*ANY, "fon")


def of_bsdfs(tolerance: Tolerance, pictures: bool = False) -> dict[str, Tolerance]:
    """The same tolerance for every kind of probe of the other BSDF nodes; in pictures, if told."""
    kinds = KINDS + (tolerances.BSDF_PICTURE_KINDS if pictures else ())
    return dict.fromkeys(kinds, tolerance)


def of_microfacets(tolerance: Tolerance) -> dict[str, Tolerance]:
    """The same tolerance for every kind of probe of microfacets."""
    return dict.fromkeys(MICROFACET_KINDS, tolerance)


@dataclass(frozen=True)
class Check:
    """A row of the table: what is asked of a probe.

    Attributes
    ----------
    key, claim : str
        One word, and a sentence.
    models : tuple of str
        The models that it holds for.
    measure : callable (probe, metric) -> Measurement
    variant : str
        The error that the control makes.
    control : callable (probe) -> probe
    tolerances : dict of str to Tolerance
        By kind of probe; one that is missing cannot be asked.
    applies : callable (subject, host) -> bool
        Whether the check can be asked about a subject of those models on the host of a name.
    diagnose : callable (probe) -> Diagnosis
        Explanation of a failure.
    open : bool
        Whether an error differs, and does not fail, where a permitted function explains all values.
    adapt : callable (tolerance, probe) -> Tolerance
        The tolerance on the probe's host, by the errors of its engine's own functions.
    """

    key: str
    claim: str
    models: tuple[str, ...]
    measure: Callable[[Any, Metric], Measurement]
    variant: str
    control: Callable[[Any], Any]
    tolerances: Mapping[str, Tolerance]
    applies: Callable[[Any, str], bool] = lambda subject, host: True
    diagnose: Callable[[Any], Diagnosis] = diagnosis.of_value
    open: bool = False
    adapt: Callable[[Tolerance, Any], Tolerance] = lambda tolerance, probe: tolerance


def has_flag(subject: Any, host: str) -> bool:
    """Whether a node has the flag that switches the model."""
    return FLAG in subject.inputs


def is_lobe(subject: Any, host: str) -> bool:
    """Whether a subject is the lobe of a surface shader, or a renderer's own Lambert."""
    return isinstance(subject, Surface) or subject.model == "lambert"


def is_alone(subject: Any, host: str) -> bool:
    """Whether no other lobe lies beside the diffuse one."""
    return not (isinstance(subject, OwnNode) and subject.others)


def is_sampled(subject: Any, host: str) -> bool:
    """Whether a renderer's own sampling of the subject can be called."""
    return isinstance(subject, OwnNode) and subject.sampled


def has_environment(subject: Any, host: str) -> bool:
    """Whether a host has the subject's model for all pairs, as an environment needs."""
    return not front_lit_only(host, subject.model)


CHECKS = (
    Check(
        "value",
        "The value is the model's for every pair of directions, back-lit and grazing ones included.",
        (*ROUGH, *OTHERS),
        measures.value,
        "every channel gets the mean color",
        gray,
        tolerances.VALUES,
        open=True,
        adapt=on_engine,
    ),
    Check(
        "lobe",
        "The diffuse lobe of the surface shader is the model's.",
        (*ANY, *SMOOTH),
        measures.value,
        "every channel gets the mean color",
        gray,
        tolerances.LOBES,
        is_lobe,
    ),
    Check(
        "environment",
        "The environment branch gives the directional albedo.",
        (*ROUGH, *OTHERS, *SMOOTH),
        measures.environment,
        "every channel gets the mean color",
        gray,
        tolerances.ALBEDOS,
        has_environment,
        diagnosis.of_albedo,
        open=True,
    ),
    Check(
        "albedo",
        "Values integrate to the colored directional albedo.",
        ANY,
        measures.quadrature,
        "every channel gets the mean color",
        gray,
        {"pairs": tolerances.INTEGRAL},
    ),
    Check(
        "furnace",
        "A white surface in a white environment cannot be seen.",
        EON,
        measures.furnace,
        "reflectance is 0.99",
        with_inputs(color=(0.99, 0.99, 0.99)),
        tolerances.ALBEDOS,
        has_environment,
        diagnosis.of_albedo,
    ),
    Check(
        "black",
        "A black surface scatters nothing.",
        (*ROUGH, *BLACK, *SMOOTH),
        measures.black,
        "a thousandth is added to every value",
        offset,
        {
            "pairs": tolerances.ZERO,
            "pictures": tolerances.ZERO,
            "planes": tolerances.ZERO,
            **of_bsdfs(tolerances.ZERO, pictures=True),
            "exact": tolerances.ZERO,
            "facets": tolerances.ZERO,
            "coarse facets": tolerances.ZERO,
            "facet pairs": tolerances.ZERO,
        },
        is_alone,
    ),
    Check(
        "density",
        "The density of drawn directions is that of the paper's sampling.",
        EON,
        sampling_measures.density,
        "roughness is dropped",
        with_inputs(roughness=0.0),
        {"facet pairs": tolerances.OWN_DENSITY},
        is_sampled,
        lambda probe: Diagnosis("the density is not that of the paper's listings"),
    ),
    Check(
        "samples",
        "Directions are drawn with the density that is returned for them.",
        EON,
        sampling_measures.samples,
        "the density is that of roughness 0",
        with_inputs(roughness=0.0),
        {"facet pairs": tolerances.CHI_SQUARE},
        is_sampled,
        lambda probe: Diagnosis("the drawn directions do not have the density"),
    ),
    Check(
        "frame",
        "The value depends on the directions in the surface's frame, turned to the viewer.",
        (*ANY, *OTHERS),
        measures.frame,
        "the node's normal is dropped",
        with_inputs(normal=(0.0, 0.0, 1.0)),
        tolerances.FRAMES,
        diagnose=wiring.of_frame,
    ),
    Check(
        "surroundings",
        "An uneven environment is looked up at the normal, which is turned to the viewer.",
        ANY,
        measures.surroundings,
        "the node's normal is dropped",
        with_inputs(normal=(0.0, 0.0, 1.0)),
        {"pairs": tolerances.SURROUNDINGS},
        diagnose=wiring.of_surroundings,
    ),
    Check(
        "throughput",
        "No light from below passes: the throughput is 0 in every branch and for every weight.",
        (*ANY, *OPAQUE),
        measures.throughput,
        "the response is taken for the throughput",
        take_response,
        {"pairs": tolerances.OPAQUE, **of_bsdfs(tolerances.OPAQUE)},
        diagnose=wiring.of_throughput,
    ),
    Check(
        "reciprocity",
        "Exchanging the two directions does not change the BRDF.",
        (*ROUGH, *RECIPROCAL, *SMOOTH),
        measures.reciprocity,
        "the value carries cos(theta_o) once more",
        scale_cosine(1),
        {
            "pairs": tolerances.RECIPROCITY,
            **bsdf_tolerances.VALUES,
            "facet pairs": tolerances.FACET_PAIRS,
        },
    ),
    Check(
        "lambert",
        "Roughness 0 is Lambert.",
        ANY,
        measures.lambert,
        "roughness is 0.1",
        with_inputs(roughness=0.1),
        {
            "pairs": tolerances.LAMBERT,
            "pictures": tolerances.CYCLES_RAY,
            "planes": tolerances.TESTRENDER,
            "exact": tolerances.EXACT,
            "facets": tolerances.FACETS,
        },
    ),
    Check(
        "flag",
        "energy_compensation changes the value by as much as the models differ.",
        ANY,
        measures.flag,
        "the flag is dropped",
        with_inputs(**{FLAG: True}),
        {
            "pairs": tolerances.difference_of(tolerances.VALUE),
            "pictures": tolerances.difference_of(tolerances.CYCLES_RAY),
            "planes": tolerances.difference_of(tolerances.TESTRENDER),
        },
        has_flag,
        wiring.of_flag,
    ),
    Check(
        "inputs",
        "Every input of the node changes the value.",
        (*ROUGH, *OTHERS, *SMOOTH, *COMBINATION),
        measures.inputs,
        "every change is dropped",
        drop_changes,
        {
            "pairs": tolerances.count_of("inputs"),
            "pictures": tolerances.count_of("inputs"),
            "planes": tolerances.count_of("inputs"),
            **of_bsdfs(tolerances.count_of("inputs"), pictures=True),
            "exact": tolerances.count_of("inputs"),
            "facets": tolerances.count_of("inputs"),
            "coarse facets": tolerances.count_of("inputs"),
            "facet pairs": tolerances.count_of("inputs"),
            COMBINED: tolerances.count_of("inputs"),
        },
        diagnose=wiring.of_inputs,
    ),
    Check(
        "finite",
        "No value at the edges of the domain is infinite or not a number.",
        (*ANY, *OTHERS),
        measures.finite,
        "the value is divided by cos(theta_o)",
        scale_cosine(-1),
        {"pairs": tolerances.count_of("values"), **of_bsdfs(tolerances.count_of("values"))},
        diagnose=wiring.of_finite,
    ),
    Check(
        "layering",
        "The throughput of a layer is 1 - E for light from above, for every weight.",
        LAYERS,
        bsdf_measures.layering,
        "all light passes",
        pass_all,
        tolerances.THROUGHPUTS,
        diagnose=diagnosis.of_throughput,
    ),
    Check(
        "transmission",
        "The throughput of a layer is 1 - E for light through the base as well.",
        LAYERS,
        bsdf_measures.transmission,
        "all light passes",
        pass_all,
        tolerances.THROUGHPUTS,
        diagnose=diagnosis.of_transmission,
    ),
    Check(
        "layer",
        "A layer over a white base returns all light.",
        LAYERS,
        bsdf_measures.layer,
        "all light passes",
        pass_all,
        bsdf_tolerances.LAYERS,
        diagnose=diagnosis.of_throughput,
    ),
    Check(
        "integral",
        "Values integrate to the directional albedo of the equations.",
        OTHERS,
        bsdf_measures.integral,
        "values are 2 % too large",
        scale(1.02),
        bsdf_tolerances.INTEGRALS,
        open=True,
    ),
    Check(
        "energy",
        "No albedo exceeds 1, nor what the equations have.",
        OTHERS,
        bsdf_measures.energy,
        "values are 100 times as large",
        scale(100.0),
        bsdf_tolerances.INTEGRALS,
    ),
    Check(
        "lossless",
        "A lobe that reflects all light returns all of it, at every roughness.",
        MICROFACETS,
        bsdf_measures.lossless,
        "values are 2 % too large",
        scale(1.02),
        of_microfacets(bsdf_tolerances.INTEGRALS[MICROFACET]),
    ),
    Check(
        "shape",
        "Two lights of one view give values in the ratio of D F G2.",
        MICROFACETS,
        bsdf_measures.shape,
        "the roughness is a tenth larger",
        rougher,
        of_microfacets(bsdf_tolerances.SHAPE),
        open=True,
    ),
    Check(
        "retroreflection",
        "The retroreflective lobe is the mirror lobe of the mirrored view.",
        MICROFACETS,
        bsdf_measures.retroreflection,
        "the flag is dropped",
        with_inputs(retroreflective=False),
        of_microfacets(bsdf_tolerances.RETROREFLECTION),
        diagnose=wiring.of_retroreflection,
    ),
    Check(
        "anisotropy",
        "The lobe turns with the tangent.",
        MICROFACETS,
        bsdf_measures.anisotropy,
        "the tangent is dropped",
        with_inputs(tangent=(1.0, 0.0, 0.0)),
        of_microfacets(bsdf_tolerances.ANISOTROPY),
        diagnose=wiring.of_tangent,
    ),
    Check(
        "anisotropic_albedo",
        "The environment branch of an anisotropic lobe gives the integral of its values.",
        MICROFACETS,
        bsdf_measures.stretched,
        "the roughness is the same in both directions",
        isotropic,
        of_microfacets(bsdf_tolerances.ANISOTROPIC_ALBEDO),
        diagnose=wiring.of_stretched,
    ),
    Check(
        "combination",
        "The value of two lobes together is that of the node's equation.",
        COMBINATION,
        measures.value,
        "each pair has the inputs of another",
        shifted,
        {COMBINED: bsdf_tolerances.COMBINED_VALUE},
    ),
    Check(
        "combined_albedo",
        "The environment branch of two lobes together gives their albedo.",
        COMBINATION,
        measures.environment,
        "each pair has the inputs of another",
        shifted,
        {COMBINED: bsdf_tolerances.COMBINED_ALBEDO},
        diagnose=diagnosis.of_albedo,
    ),
    Check(
        "combined_throughput",
        "Two lobes together pass what they do not scatter, as the layer equation asks.",
        COMBINATION,
        bsdf_measures.layering,
        "all light passes",
        pass_all,
        {COMBINED: bsdf_tolerances.COMBINED_ALBEDO},
        diagnose=diagnosis.of_throughput,
    ),
)
