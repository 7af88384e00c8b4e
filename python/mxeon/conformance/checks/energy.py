# SPDX-License-Identifier: Apache-2.0
"""Checks of energy: what a lobe scatters in all, what it lets through, and both of two lobes together."""

from collections.abc import Callable, Iterator

import numpy as np

from mxeon.conformance.backends import WHITE
from mxeon.conformance.case import Case
from mxeon.conformance.check import check, pass_all, scale
from mxeon.conformance.checks.lobes import is_lobe, is_plain
from mxeon.conformance.diagnosis.comparisons import THROUGHPUT, TRANSMISSION
from mxeon.conformance.samples import LEAST_COLOR82, Array, Batch, Values
from mxeon.conformance.spec import Spec
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.tolerance import Compared

ROUNDED = 1e-9  # difference of two albedos that are the same


def is_layer(spec: Spec) -> bool:
    """Whether a node lets 1 - E through to what lies below."""
    return is_plain(spec) and isinstance(spec, PbrSpec) and spec.row.layerable


def reads(name: str) -> Callable[[Spec], bool]:
    """Whether a layer is one of an input of a name."""
    return lambda spec: is_layer(spec) and isinstance(spec, PbrSpec) and name in spec.row.inputs


check(
    "layering",
    "The throughput of a layer of albedo E is 1 - E for light from above, for every weight.",
    is_layer,
    pass_all,
)(THROUGHPUT)

check(
    "transmission",
    "The throughput of a layer is 1 - E for light through the base, too.",
    is_layer,
    pass_all,
)(TRANSMISSION)


@check(
    "dip",
    "Where color82 lowers the reflectance, the layer passes on what it does not reflect.",
    reads("color82"),
    pass_all,
    pairs=True,
    lit=True,
    diagnose=THROUGHPUT.diagnose,
)
def dip(case: Case) -> Iterator[Compared]:
    """Throughput of lobes that are white but for a dip at 82 degrees."""
    dipped = (LEAST_COLOR82,) * 3
    white: Values = {"color0": WHITE, "color90": WHITE, "color82": dipped, "exponent": 5.0}
    return (_passed(case, batch.altered(**white)) for batch in case.views)


@check(
    "denser",
    "For indices below 1, where facets reflect totally, the throughput is 1 - E, too.",
    reads("tint"),
    pass_all,
    pairs=True,
    lit=True,
    diagnose=THROUGHPUT.diagnose,
)
def denser(case: Case) -> Iterator[Compared]:
    """Throughput of lobes of the inverse indices."""
    for batch in case.views:
        inverse = batch.altered(ior=1.0 / np.asarray(batch.inputs["ior"]), tint=WHITE)
        yield _passed(case, inverse)


def _passed(case: Case, batch: Batch) -> Compared:
    """Throughput at full weight against 1 - E."""
    full = batch.altered(weight=1.0)
    passed = np.maximum(1.0 - case.expected_albedo(full), 0.0)
    return Compared(full, case.throughput(full, "direct"), passed)


@check(
    "layer",
    "A layer over a white base returns all light.",
    is_layer,
    pass_all,
    "light",
    diagnose=THROUGHPUT.diagnose,
)
def layer(case: Case) -> Compared:
    views, albedo = integrals(case)
    total = albedo + case.throughput(views, "direct")
    # Where the equations gain energy by themselves, no throughput makes up for it.
    own = case.lobe.albedo(views)
    sound = np.asarray((case.samples.integrals <= own + ROUNDED).all(axis=1))
    return Compared(views.where(sound), total[sound], np.ones((1, 3)))


@check(
    "integral",
    "Values integrate to the directional albedo that the equations give.",
    is_lobe,
    scale("values are 2 % too large", 1.02),
    open=True,
)
def integral(case: Case) -> Compared:
    views, albedo = integrals(case)
    return Compared(views, albedo, case.samples.integrals)


@check(
    "energy",
    "No albedo exceeds 1 or what the equations give.",
    is_lobe,
    scale("values are 100 times as large", 100.0),
    "integral",
)
def energy(case: Case) -> Compared:
    views, albedo = integrals(case)
    allowed = np.maximum(1.0, case.samples.integrals)
    return Compared(views, np.maximum(albedo, allowed), allowed)


def integrals(case: Case) -> tuple[Batch, Array]:
    """Views of the integrated materials, and their albedos from the host's values, (N, 3)."""
    return summed(case, *case.samples.integrated)


def summed(case: Case, batch: Batch, weights: Array) -> tuple[Batch, Array]:
    """Views of materials in many directions of light, and their albedos, (N, 3)."""
    count, nodes = weights.shape
    values = case.direct(batch).reshape(count, nodes, 3)
    albedo = (weights[..., np.newaxis] * values).sum(axis=1)
    return batch.where(np.arange(count) * nodes), albedo
