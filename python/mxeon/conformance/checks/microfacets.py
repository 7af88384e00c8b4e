# SPDX-License-Identifier: Apache-2.0
"""Checks of lobes of microfacets alone."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.case import Case
from mxeon.conformance.check import check, control, scale, with_inputs
from mxeon.conformance.checks.energy import summed
from mxeon.conformance.checks.lobes import is_plain, shows_exactly
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.samples import LEAST_COLOR82, Array, Batch, rounded, sky, sky_map
from mxeon.conformance.spec import Spec
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import LEAST_TANGENT_ALPHA, LEAST_TANGENT_COSINE, FacetSpec
from mxeon.conformance.tolerance import Compared

FEW = 1 << 12
LEAST_DIVIDED = 1.2  # index of a dielectric whose values are divided
SKIES = 8  # lobes that are asked for the mean of an uneven sky
LEAST_VALUE = 1e-3  # pi f cos of values whose ratio is asked


def is_facets(spec: Spec) -> bool:
    return is_plain(spec) and isinstance(spec, FacetSpec)


@control("the roughness is 10 % larger")
def rougher(case: Case) -> Case:
    def inputs(batch: Batch) -> Batch:
        rough = np.minimum(1.1 * np.asarray(batch.inputs["roughness"]), 1.0)
        return batch.altered(roughness=rough)

    return replace(case, inputs=inputs)


@control("the roughness is the same in both directions")
def isotropic(case: Case) -> Case:
    def inputs(batch: Batch) -> Batch:
        first = np.asarray(batch.inputs["roughness"])[:, :1]
        return batch.altered(roughness=np.repeat(first, 2, axis=1))

    return replace(case, inputs=inputs)


@check(
    "lossless",
    "A lossless lobe returns all light at every roughness.",
    is_facets,
    scale("values are 2 % too large", 1.02),
    "integral",
)
def lossless(case: Case) -> Compared:
    batch, weights = case.samples.integrated
    mirror = batch.altered(**case.of(PbrSpec).row.mirror)
    views, albedo = summed(case, mirror, weights)
    return Compared(views, albedo, np.ones_like(albedo))


@check(
    "shape",
    "For one view, the values for two lights have the same ratio as the products D F G2.",
    is_facets,
    rougher,
    pairs=True,
    open=True,
    hosts=shows_exactly,
)
def shape(case: Case) -> Compared:
    """Ratio of two values of one view against that of the equations: compensation cancels."""
    batch, other = (_clear(each.first(FEW)) for each in case.samples.mirrored)
    first, second = case.expected(batch), case.expected(other)
    lit = (np.minimum(first, second) > LEAST_VALUE).any(axis=1)
    least = np.minimum(batch.wo[:, 2], np.minimum(batch.wi[:, 2], other.wi[:, 2]))
    lit &= least >= LEAST_TANGENT_COSINE
    scale = (first * second).max(axis=1, keepdims=True)
    with np.errstate(invalid="ignore"):
        measured = case.direct(batch) * second / scale
        expected = case.direct(other) * first / scale
    return Compared(batch.where(lit), measured[lit], expected[lit])


def _clear(batch: Batch) -> Batch:
    """A batch without curves of which float32 cannot hold F: its terms cancel.

    These are dielectrics whose index is near 1, and deep dips at 82 degrees, which turn F negative.
    """
    changes: dict[str, ArrayLike] = {}
    if np.ndim(batch.inputs.get("ior", 0.0)) == 1:
        changes["ior"] = np.maximum(batch.inputs["ior"], LEAST_DIVIDED)
    if "color82" in batch.inputs:
        changes["color82"] = np.maximum(batch.inputs["color82"], LEAST_COLOR82)
    return batch.altered(**changes)


@check(
    "retroreflection",
    "The retroreflective lobe equals the mirror lobe for the mirrored view.",
    is_facets,
    with_inputs("the flag is dropped", retroreflective=False),
    pairs=True,
    diagnose=input_diagnosis.ignored("retroreflective"),
)
def retroreflection(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        mirrored = replace(batch, wo=batch.wo * [-1.0, -1.0, 1.0])
        measured = case.direct(batch.altered(retroreflective=True))
        yield Compared(batch, measured, case.direct(mirrored.altered(retroreflective=False)))


@check(
    "anisotropy",
    "The lobe turns with the tangent.",
    is_facets,
    with_inputs("the tangent is dropped", tangent=(1.0, 0.0, 0.0)),
    pairs=True,
    diagnose=input_diagnosis.ignored("tangent"),
)
def anisotropy(case: Case) -> Compared:
    batch = case.samples.mirrored[0].first(FEW)
    batch = batch.where(np.minimum(batch.wo[:, 2], batch.wi[:, 2]) >= LEAST_TANGENT_COSINE)
    batch = batch.altered(roughness=np.maximum(batch.inputs["roughness"], LEAST_TANGENT_ALPHA))
    angle = np.linspace(0.0, 2.0 * np.pi, len(batch.wo))
    cosine, sine, zero = np.cos(angle), np.sin(angle), np.zeros(len(angle))
    tangent = rounded([cosine, sine, zero])
    turned = replace(
        batch.altered(tangent=(1.0, 0.0, 0.0)),
        wo=_turned_back(batch.wo, tangent),
        wi=_turned_back(batch.wi, tangent),
    )
    return Compared(batch, case.direct(batch.altered(tangent=tangent)), case.direct(turned))


def _turned_back(w: Array, tangent: Array) -> Array:
    """Directions in the frame of a tangent in the surface."""
    along = w[:, 0] * tangent[:, 0] + w[:, 1] * tangent[:, 1]
    across = w[:, 1] * tangent[:, 0] - w[:, 0] * tangent[:, 1]
    return rounded([along, across, w[:, 2]])


@check(
    "sky",
    "An uneven environment is reflected as the values integrate over it, retroreflected, too.",
    is_facets,
    with_inputs("the flag is dropped", retroreflective=False),
    pairs=True,
    lit=True,
    diagnose=lambda case: diagnose_sky(case),
)
def reflected_sky(case: Case) -> Iterator[Compared]:
    """Means of the sky under each lobe, which one for a mirrored view has by retroreflection; factors cancel."""
    batch, weights = case.samples.integrated
    count, nodes = min(SKIES, len(weights)), weights.shape[1]
    part = batch.first(count * nodes)
    values = case.lobe.value(part).reshape(count, nodes, 3) * weights[:count, :, np.newaxis]
    albedo = values.sum(axis=1)
    bright = albedo.min(axis=1) > LEAST_VALUE
    seen = (values * sky(part.wi).reshape(count, nodes, 3)).sum(axis=1)
    views, mean = part.where(np.flatnonzero(bright) * nodes), seen[bright] / albedo[bright]
    mirrored = replace(views, wo=views.wo * [-1.0, -1.0, 1.0])
    for each in (views, mirrored.altered(retroreflective=True)):
        yield Compared(each, case.albedo(each, sky_map()) / case.albedo(each), mean)


def diagnose_sky(case: Case) -> Diagnosis:
    """Whether the mirror lobe is wrong, or the retroreflective one alone."""
    tolerance = case.tolerance("sky")
    assert tolerance is not None, f"{case.spec.title} has no sky"
    first = next(reflected_sky(case))
    if tolerance.metric(*first[1:]).max() > tolerance.value:
        return Diagnosis("the environment is looked up in other directions, or with other weights")
    return Diagnosis("retroreflective is ignored or wrong in an environment")


def diagnose_stretched(case: Case) -> Diagnosis:
    return input_diagnosis.diagnose_stretched(stretched(case))


@check(
    "anisotropic_albedo",
    "The environment branch of an anisotropic lobe returns the integral of its values.",
    is_facets,
    isotropic,
    pairs=True,
    lit=True,
    diagnose=diagnose_stretched,
)
def stretched(case: Case) -> Compared:
    batch, expected = case.samples.take(case.of(FacetSpec).stretched)
    return Compared(batch, case.albedo(batch), expected)
