# SPDX-License-Identifier: Apache-2.0
"""Checks that a renderer's sampling density is correct, and that samples follow the density."""

from collections.abc import Iterator
from typing import cast

import numpy as np

from mxeon.conformance import controls, diagnosis
from mxeon.conformance.case import Case
from mxeon.conformance.check import Check, family
from mxeon.conformance.checks import CHECKS, paths
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, generator
from mxeon.conformance.tolerance import Compared, Measurement, roundings, single, sum_of
from mxeon.models.sampling import eon_cltc_pdf
from mxeon.survey.backends import Renderer
from mxeon.survey.specs import RendererSpec

# A correct sampler exceeds this limit in one of 3.5 million runs.
CHI_SQUARE = single(5.0, Quantity.DEVIATIONS, "five standard deviations")
# The density contains the fourth power of a vector's length, which costs three bits of precision.
OWN_DENSITY = sum_of(
    roundings(48 * 2.0**3, "(48, times 8 for three lost bits)"), quantity=Quantity.DENSITY
)
COSINES = (0.05, 0.3, 0.7, 0.99)  # cosines of view directions
SAMPLES = 1 << 15
ROUGHNESS = 1.0

# Nodes whose sampling function can be called.
SAMPLED = family(RendererSpec, lambda spec: spec.sampled and spec.model in ("eon", "eon_fitted"))


def density(case: Case) -> Iterator[Compared]:
    for batch in case.few:
        batch = batch.where(batch.wi[:, 2] > 0.0)
        expected = eon_cltc_pdf(batch.wo, batch.wi, batch.inputs["roughness"])[:, np.newaxis]
        yield Compared(batch, _density(case, batch)[:, np.newaxis], expected)


def _density(case: Case, batch: Batch) -> Array:
    batch = case.inputs(batch)
    roughness = np.broadcast_to(batch.inputs["roughness"], len(batch.wo))
    return cast(Renderer, case.host).density(batch.wo, batch.wi, roughness).astype(np.float64)


def samples(case: Case) -> Measurement:
    """Largest deviation of samples from the density, in standard deviations of a chi-square test.

    The cosines of the views are COSINES, and the material has ROUGHNESS. A control needs one view.
    """
    deviations = [_deviation(case, mu) for mu in COSINES[: 1 if case.control else None]]
    worst = int(np.argmax(deviations))
    return Measurement(float(deviations[worst]), {"mu_o": [COSINES[worst]]})


def _deviation(case: Case, mu: float) -> float:
    """Deviation of the samples of one view from the density, in standard deviations."""
    rng, pole = generator(), np.array([0.0, 0.0, 1.0])
    wo = np.array([np.sqrt(1.0 - mu * mu), 0.0, mu])
    draws = np.broadcast_to(wo, (SAMPLES, 3)), rng.random((SAMPLES, 2)), np.full(SAMPLES, ROUGHNESS)
    wi = cast(Renderer, case.host).sample(*draws).astype(np.float64)

    def density(w: Array) -> Array:
        batch = Batch(np.broadcast_to(wo, w.shape), w, {"roughness": np.array(ROUGHNESS)})
        return np.where(w[:, 2] > 0.0, _density(case, batch), 0.0)

    return paths.deviation(np.where(wi[:, 2:] > 0.0, wi, 0.0), density, pole, pole)


# fmt: off
CHECKS += (
    Check(key="density", claim="The sampling density is the paper's.",
          applies=SAMPLED, measure=density, tolerance=OWN_DENSITY,
          control=controls.with_inputs("roughness is dropped", roughness=0.0),
          explain=diagnosis.defect("density_differs")),
    Check(key="samples", claim="Samples follow the density that is returned with them.",
          applies=SAMPLED, measure=samples, tolerance=CHI_SQUARE,
          control=controls.with_inputs("the density is that of roughness 0", roughness=0.0),
          explain=diagnosis.defect("samples_differ")),
)
# fmt: on
