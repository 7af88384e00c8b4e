# SPDX-License-Identifier: Apache-2.0
"""Checks of a lobe: its values and albedos, its frame, its inputs and its edges."""

import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.backends import WHITE, scene_of
from mxeon.conformance.case import BRANCHES, Case, dead_inputs, edge_values, frames
from mxeon.conformance.check import (
    check,
    control,
    drop_changes,
    gray,
    of_family,
    offset,
    scale_cosine,
    take_response,
    with_inputs,
)
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis, explain
from mxeon.conformance.diagnosis.comparisons import ALBEDO, VALUE
from mxeon.conformance.samples import SKY_ROWS, SLOPE, Array, Batch, sky_map
from mxeon.conformance.spec import LobeSpec, Spec
from mxeon.conformance.specs.combinations import CombinedSpec
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, DiffuseSpec, SurfaceLobe, model_value
from mxeon.conformance.specs.emission import EmissionSpec
from mxeon.conformance.specs.hair import HairSpec
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.media import MediumSpec
from mxeon.conformance.specs.microfacets import FacetSpec, TransmissionSpec
from mxeon.conformance.specs.subsurface import ON_SPHERES, RINGS, SubsurfaceSpec, inner, spread
from mxeon.conformance.specs.thin_films import FilmSpec
from mxeon.conformance.tolerance import (
    Compared,
    Measurement,
    Term,
    absolute,
    count_named,
    count_not_finite,
    count_of,
    given,
    sum_of,
)
from mxeon.hosts import HOSTS, front_lit_only
from mxeon.models import table as reference
from mxeon.models.core.quadrature import hemisphere_nodes
from mxeon.shaders.nodes import FLAG

COLORS = ((0.2, 0.2, 0.2), (0.5, 0.5, 0.5), (0.8, 0.8, 0.8), (0.8, 0.4, 0.1))
QUADRATURE_NODES = 16  # reaches 1e-9 on the models judged, far below float32
LEAST_LIGHT = 0.01  # of a uniform environment, where the place of an uneven one is asked
# Texels are pi / 128 high and wide, their middles are read, and engines keep filters' weights in eight bits.
TEXEL = math.sqrt(2.0) * math.pi / SKY_ROWS * 2.0**-8
ARC_SINE = 4e-4  # largest error of an engine's arc sine: llvmpipe's, ten times that of others
SURROUNDINGS = sum_of(
    Term(SLOPE * TEXEL, "2^-8 of a texel, times the slope of the map, 1/2"),
    Term(SLOPE * ARC_SINE, "an engine's arc sine, times the slope"),
    Term(2.0**-11, "half floats"),
    unit="irradiance",
    metric=absolute,
)
ZERO = given(0.0, "pi f cos", "a product with 0 is 0 in any precision")
OPAQUE = given(0.0, "throughput", "a constant has no roundings")


ROUGH = ("eon", "eon_fitted", "qon", "fon")
MODES = ("eon", "eon_fitted", "qon")  # of which a node is one
EON = ("eon", "eon_fitted")
COATED = ("eon_coated", "openpbr_half_metal")  # which a renderer has
BURLEY = ("burley", "burley_lambert")


def is_model(spec: Spec, *names: str) -> bool:
    return isinstance(spec, DiffuseModelSpec) and spec.model in names


def is_plain(spec: Spec) -> bool:
    """Whether a spec is one lobe of pbrlib by itself, without a film, that transmits to no environment."""
    others = (CombinedSpec, FilmSpec, TransmissionSpec)
    return isinstance(spec, PbrSpec) and not isinstance(spec, others)


def is_lobe(spec: Spec) -> bool:
    return is_plain(spec) or is_model(spec, *BURLEY)


def is_node(spec: Spec) -> bool:
    """Whether a spec is a node, and not the lobe of a surface shader."""
    return not isinstance(spec, SurfaceLobe)


def is_reciprocal(spec: Spec) -> bool:
    own = is_plain(spec) and not isinstance(spec, (HairSpec, SubsurfaceSpec))
    reciprocal = own and isinstance(spec, PbrSpec) and spec.row.reciprocal
    return reciprocal or is_model(spec, *ROUGH, "lambert", "burley")


def is_opaque(spec: Spec) -> bool:
    """Whether a node lets no light through to what lies below."""
    opaque = is_plain(spec) and isinstance(spec, PbrSpec) and not spec.row.layerable
    return opaque or is_model(spec, *MODES)


def shows_exactly(spec: Spec, host: str) -> bool:
    """Whether a host has directions to the last bit, those on the horizon too."""
    return all(row.way not in ("rendered", "pictures") for row in HOSTS if row.name == host)


def has_environment(spec: Spec, host: str) -> bool:
    """Whether a host has the spec's model for all pairs, as an environment needs."""
    return not front_lit_only(host, spec.model)


check(
    "value",
    "The value matches the model for every pair of directions, including back-lit and grazing ones.",
    lambda spec: is_node(spec) and (is_lobe(spec) or is_model(spec, *ROUGH, *COATED)),
    gray,
    open=True,
)(VALUE)

check(
    "lobe",
    "The diffuse lobe of the surface shader matches the model.",
    lambda spec: is_model(spec, "lambert") or not is_node(spec),
    gray,
)(VALUE)

check(
    "environment",
    "The environment branch returns the directional albedo.",
    lambda spec: is_lobe(spec) or is_model(spec, *ROUGH, "lambert", *COATED),
    gray,
    open=True,
    hosts=has_environment,
)(ALBEDO)


@check(
    "albedo",
    "Values integrate to the colored directional albedo.",
    lambda spec: is_model(spec, *MODES),
    gray,
    "integral",
)
def quadrature(case: Case) -> list[Compared]:
    rows = list(product((0.1, 0.3, 0.6, 0.95), COLORS, (0.25, 1.0)))
    mu, color, roughness = (np.array(column) for column in zip(*rows, strict=True))
    wo = np.stack([np.sqrt(1.0 - mu * mu), 0.0 * mu, mu], axis=1)
    batch = Batch(wo, wo, {"color": color, "roughness": roughness})
    return [Compared(batch, *integrated(case, mu, color, roughness))]


def integrated(
    case: Case, mu: Array, color: ArrayLike, roughness: ArrayLike
) -> tuple[Array, Array]:
    """Directional albedo at some cosines, (N, 3): from the host's values, and in closed form.

    The host is asked once for all of them: to some a question takes as long as a thousand values.
    """
    # Lay the nodes of all cosines out one after the other.
    rules = [hemisphere_nodes(float(each), QUADRATURE_NODES) for each in mu]
    wi = np.concatenate([directions for _, directions, _ in rules])
    count = len(wi) // len(mu)
    wo = np.repeat([view for view, _, _ in rules], count, axis=0)
    color = np.broadcast_to(color, (len(mu), 3))
    roughness = np.broadcast_to(roughness, len(mu))
    inputs = {"color": np.repeat(color, count, 0), "roughness": np.repeat(roughness, count)}
    values = case.direct(Batch(wo, wi, inputs)) / (np.pi * wi[:, 2:])
    parts = values.reshape(len(mu), count, 3)
    measured = [weights @ part for (_, _, weights), part in zip(rules, parts, strict=True)]
    row = reference.model(case.spec.model)
    return np.array(measured), row.closed_albedo_dir(mu, color, roughness)


@check(
    "furnace",
    "A white surface disappears in a white environment.",
    lambda spec: is_model(spec, *EON, *COATED),
    with_inputs("reflectance is 0.99", color=(0.99, 0.99, 0.99)),
    "albedo",
    hosts=has_environment,
    diagnose=ALBEDO.diagnose,
)
def furnace(case: Case) -> Iterator[Compared]:
    for batch in case.views:
        white = batch.altered(color=WHITE, weight=1.0)
        yield Compared(white, case.albedo(white), np.ones((1, 3)))


@check(
    "black",
    "A black surface scatters nothing.",
    lambda spec: (
        (is_plain(spec) and isinstance(spec, LobeSpec) and bool(spec.black))
        or (
            is_model(spec, *ROUGH, "lambert", "burley")
            and is_node(spec)
            and not getattr(spec, "beside", False)
        )
    ),
    offset,
    tolerance=ZERO,
)
def black(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        batch = batch.altered(**case.lobe.black)
        yield Compared(batch, case.direct(batch), np.zeros((1, 3)))


check(
    "frame",
    "The value follows the surface's frame, with the normal turned toward the viewer.",
    # The frames turn from pixel to pixel: to subsurface scattering that is a curved surface.
    lambda spec: (is_lobe(spec) and not isinstance(spec, SubsurfaceSpec)) or is_model(spec, *MODES),
    with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
    diagnose=input_diagnosis.diagnose_frame,
)(frames)


def diagnose_surroundings(case: Case) -> Diagnosis:
    return input_diagnosis.diagnose_surroundings(surroundings(case), SURROUNDINGS.value)


@check(
    "surroundings",
    "An uneven environment is looked up along the viewer-facing normal, or along its opposite for translucent nodes.",
    lambda spec: (
        (is_plain(spec) and not isinstance(spec, FacetSpec)) or is_model(spec, *MODES, "burley")
    ),
    with_inputs("the node's normal is dropped", normal=(0.0, 0.0, 1.0)),
    tolerance=SURROUNDINGS,
    pairs=True,
    lit=True,
    diagnose=diagnose_surroundings,
)
def surroundings(case: Case) -> Compared:
    batch = case.samples.turned
    if "color" in batch.inputs:
        batch = batch.altered(color=WHITE)
    level = case.albedo(batch)
    bright = level.min(axis=1) > LEAST_LIGHT
    if bright.any():  # or what is dark is wrong
        batch, level = batch.where(bright), level[bright]
    with np.errstate(divide="ignore", invalid="ignore"):
        measured = case.albedo(batch, sky_map()) / level
    return Compared(batch, measured, case.lobe.sky(batch))


def diagnose_sphere(case: Case) -> Diagnosis:
    return explain(case, list(spheres(case)), ON_SPHERES, (), RINGS)


ON_SPHERE = with_inputs("the mean free path is 0.3 in every channel", radius=(0.3, 0.3, 0.3))


@check(
    "sphere_mean",
    "On average, a sphere reflects the share of light that the profile predicts.",
    of_family(SubsurfaceSpec),
    ON_SPHERE,
    lit=True,
    diagnose=diagnose_sphere,
)
@check(
    "sphere",
    "On a sphere, light spreads as the diffusion profile predicts from radius and anisotropy.",
    of_family(SubsurfaceSpec),
    ON_SPHERE,
    lit=True,
    diagnose=diagnose_sphere,
)
def spheres(case: Case) -> Iterator[Compared]:

    def picture(batch: Batch) -> Array:
        scene = scene_of(batch)
        [shader] = case.host.compile(case.spec.document(batch.inputs), library=case.library)
        return case.host.picture(shader, scene)[inner(scene.size)].astype(np.float64)

    for batch in case.samples.take(case.of(SubsurfaceSpec).spheres):
        yield Compared(batch, case.measured(picture, batch), spread(batch))


@check(
    "cylinder",
    "On a cylinder, light spreads alike, whichever way the axis runs on the screen.",
    of_family(SubsurfaceSpec),
    with_inputs("the mean free path is 0", radius=(0.0, 0.0, 0.0)),
    "frame",
    pairs=True,
    lit=True,
    diagnose=lambda case: Diagnosis(
        "the curvature depends on the direction in which a surface bends"
    ),
)
def cylinders(case: Case) -> Compared:
    """Values of pixels in squares of 2 x 2 that bend along the columns, against the same along the rows."""
    batch = case.samples.take(case.of(SubsurfaceSpec).cylinder)
    quarter = len(batch.wo) // 4
    turned = np.arange(len(batch.wo)).reshape(2, quarter, 2).transpose(2, 1, 0).ravel()
    there = case.evaluating.direct(batch.where(turned))
    back = np.empty_like(there)
    back[turned] = there
    return Compared(batch, case.direct(batch), back)


def opaque_values(case: Case, branch: str) -> Iterator[Compared]:
    for batch in case.few:
        yield Compared(batch, case.throughput(batch, branch), np.zeros((len(batch.wo), 3)))


@check(
    "throughput",
    "No light from below passes: the throughput is 0 in every branch, for every weight.",
    is_opaque,
    take_response,
    tolerance=OPAQUE,
    pairs=True,
    lit=True,
    diagnose=lambda case: input_diagnosis.diagnose_throughput(
        {branch: list(opaque_values(case, branch)) for branch in BRANCHES}
    ),
)
def throughput(case: Case) -> Iterator[Compared]:
    return (each for branch in BRANCHES for each in opaque_values(case, branch))


@check(
    "reciprocity",
    "Exchanging the two directions does not change the BRDF.",
    is_reciprocal,
    scale_cosine("the value has an extra factor cos(theta_o)", 1),
)
def reciprocity(case: Case) -> Iterator[Compared]:
    """f(wo, wi) against f(wi, wo), both times both cosines."""
    for batch in case.few:
        side = -1.0 if np.all(batch.wi[:, 2] <= 0.0) else 1.0  # light through the surface
        swapped = replace(batch, wo=side * batch.wi, wi=side * batch.wo)
        with np.errstate(invalid="ignore"):  # inf x 0 is NaN, which `absolute` notices
            forward = case.direct(batch) * batch.wo[:, 2:]
            backward = case.direct(swapped) * np.abs(batch.wi[:, 2:])
        yield Compared(batch, forward, backward)


@check(
    "lambert",
    "At roughness 0 the node is Lambert.",
    lambda spec: is_model(spec, *MODES),
    with_inputs("roughness is 0.1", roughness=0.1),
)
def lambert(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        batch = batch.altered(roughness=0.0)
        yield Compared(batch, case.direct(batch), model_value(batch, "lambert"))


def modes_of(case: Case) -> tuple[str, str]:
    """The model of a case's mode, and that of the other one."""
    return ("eon", "qon") if case.spec.model == "eon" else ("qon", "eon")


@control("the mode returns the values of the other mode")
def take_other_mode(case: Case) -> Case:
    """Values of the other mode: not by its flag, which a host may ignore."""
    own, other = modes_of(case)

    def change(batch: Batch, values: Array) -> Array:
        if batch.inputs[FLAG] != (own == "eon"):
            return values
        return values + model_value(batch, other) - model_value(batch, own)

    return replace(case, outputs=change)


@check(
    "flag",
    "energy_compensation changes the value by the difference between the two models.",
    lambda spec: is_model(spec, *MODES) and isinstance(spec, DiffuseSpec) and FLAG in spec.names,
    take_other_mode,
    "difference",
)
def flag(case: Case) -> Measurement:
    """The part that the case's own mode has in a wrong change by the flag, relative to the models'."""
    error = largest = 0.0
    modes = modes_of(case)
    for batch in case.few:
        batch = batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))
        # Leave out the pairs for which the host has no closure of the flagged model.
        rows: slice | Array = slice(None)
        if front_lit_only(case.host.name, "qon"):
            rows = (batch.wo[:, :2] * batch.wi[:, :2]).sum(axis=1) >= 0.0
        # A wrong change is charged to the mode whose values are wrong.
        own, other = (case.direct(batch.altered(**{FLAG: mode == "eon"})) for mode in modes)
        expected, beside = (model_value(batch, mode) for mode in modes)
        change = absolute(own - other, expected - beside)
        wrong = np.minimum(change, absolute(own, expected))
        error = np.maximum(error, wrong[rows].max(initial=0.0))
        largest = max(largest, np.abs(expected - beside)[rows].max(initial=0.0))
    return Measurement(float(error / largest), {"expected": [float(largest)]})


@check(
    "inputs",
    "Every input of the node changes the value.",
    lambda spec: (
        (is_node(spec) and (is_lobe(spec) or is_model(spec, *ROUGH, "lambert", *COATED)))
        or isinstance(spec, (CombinedSpec, EmissionSpec, MediumSpec))
    ),
    drop_changes,
    tolerance=count_of("inputs"),
    diagnose=input_diagnosis.diagnose_inputs,
)
def inputs(case: Case) -> Measurement:
    return count_named(dead_inputs(case))


@check(
    "finite",
    "Every value at the edges of the domain is finite.",
    lambda spec: is_lobe(spec) or is_model(spec, *MODES),
    scale_cosine("the value is divided by cos(theta_o)", -1),
    tolerance=count_of("values"),
    pairs=True,
    hosts=shows_exactly,
    diagnose=input_diagnosis.diagnose_finite,
)
def finite(case: Case) -> Measurement:
    batch, found, _ = edge_values(case)
    return count_not_finite(batch, found)
