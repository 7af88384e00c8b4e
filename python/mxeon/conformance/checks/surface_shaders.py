# SPDX-License-Identifier: Apache-2.0
"""Checks of whole surface shaders; a failure names the lobe that causes it."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.conformance import backends, controls, samples, specs
from mxeon.conformance.case import SCATTERING, Case, unchanged
from mxeon.conformance.check import Check, family
from mxeon.conformance.checks.lobes import LAYERS, finds_albedo
from mxeon.conformance.diagnosis import ALBEDO, THROUGHPUT, defect
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity
from mxeon.conformance.spec import Ability
from mxeon.conformance.specs.surface_shaders import STRETCHED_FIT, SurfaceShaderSpec, stretched
from mxeon.conformance.specs.surface_shaders import VALUE as VALUE_ERROR
from mxeon.conformance.tolerance import Compared, count_named, count_of, scaled
from mxeon.errors import NotRun
from mxeon.hosts.calls import NORMAL, TANGENT

WORST = 32  # worst pairs to diagnose
CHANGED = 8  # pairs that must react to a changed input
# Inputs that disable a lobe, keyed by the lobe's name.
LOBE_INPUTS = {
    "coat": ("coat", "coat_weight", "clearcoat"),
    "sheen": ("sheen", "fuzz_weight", "sheen_color"),
    "metal": ("metalness", "base_metalness", "metallic"),
    "specular reflection": ("specular", "specular_weight"),
}


def diagnose_lobes(case: Case) -> Diagnosis:
    """Find the lobe whose removal corrects the worst pairs."""
    [batch] = case.batches
    compared = values(case)
    wrong = scaled(compared.measured, compared.expected)
    two = stretched(batch)
    if wrong[~two].max() > VALUE_ERROR.value:
        wrong[two] = 0.0
    pairs = batch.where(np.argsort(wrong)[-WORST:])
    errors = {}
    for lobe, inputs in LOBE_INPUTS.items():
        if names := [name for name in inputs if name in batch.inputs]:
            plain = pairs.altered(**{name: np.zeros_like(pairs.inputs[name]) for name in names})
            errors[lobe] = float(scaled(case.direct(plain), case.expected(plain)).max())
    lobe = min(errors, key=errors.__getitem__)
    if errors[lobe] <= VALUE_ERROR.value:
        return defect("right_without", lobe)
    if layers := wrong_layers(case):
        return defect("throughput_of_lobes", *layers)
    return defect("no_single_lobe", *sorted(errors, key=errors.__getitem__)[:2])


def wrong_layers(case: Case) -> list[str]:
    """Titles of the material's lobes that have a wrong throughput when judged separately."""
    from mxeon.shaders.document.graphs import categories, inner_nodes

    used, found = categories(inner_nodes(case.evaluating.shader.document)), []
    for spec in filter(LAYERS, specs.PLAIN_LOBES):
        if spec.node in used:
            lobe = case.another(spec)
            if any(lobe.tolerance("throughput").wrong(each).any() for each in THROUGHPUT(lobe)):
                found.append(spec.title)
    return found


SURFACES, SUM = family(SurfaceShaderSpec), defect("sum_of_lobes")


def values(case: Case) -> Compared:
    """Values compared with the layer equation.

    Fits for two alphas are coarser: each such error is scaled by VALUE_ERROR / STRETCHED_FIT, or
    replaced by the mean error of these pairs if that is larger.
    """
    [batch] = case.batches
    expected = case.expected(batch)
    scale = np.maximum(expected.max(axis=1, keepdims=True), 1.0)
    errors, two = (case.direct(batch) - expected) / scale, stretched(batch)
    if np.any(two):
        own, mean = errors[two] * (VALUE_ERROR.value / STRETCHED_FIT), errors[two].mean(axis=0)
        errors[two] = np.where(np.abs(own) > np.abs(mean), own, mean)
    return Compared(batch, expected + errors * scale, expected)


def lobes_mean(case: Case) -> Iterator[Compared]:
    compared = values(case)
    yield compared.where(~stretched(compared.batch))
    yield from ALBEDO(case)


def lobes_furnace(case: Case) -> Compared:
    white = replace(case.backend.views[0], inputs=samples.arrays(case.of(SurfaceShaderSpec).white))
    return Compared(white, case.albedo(white), np.ones((1, 3)))


def lobes_energy(case: Case) -> Compared:
    batch = case.backend.edges
    return Compared(batch, np.maximum(case.albedo(batch), 1.0), np.ones((1, 3)))


def glass(case: Case) -> Iterator[Compared]:
    spec, methods = case.of(SurfaceShaderSpec), case.host.active
    batch = spec.clear(case.backend.views[0])
    through = spec.transmitted(batch, methods.transmission == "opacity")
    measured = case.transmitted(batch)
    yield Compared(batch, measured, through)
    if methods.environment == "fis":  # other methods use a fit or reflect nothing
        yield Compared(batch, measured + case.albedo(batch), through + case.expected_albedo(batch))


def misplaced(case: Case) -> list[str]:
    """Inputs that have an effect although documented as having none, or the reverse."""
    wrong = set(expected_dead(case)).symmetric_difference(without_effect(case))
    return sorted(wrong.difference(case.backend.unset))


def expected_dead(case: Case) -> tuple[str, ...]:
    """Inputs that may have no effect. Transmission as opacity is not blurred by a roughness."""
    spec = case.of(SurfaceShaderSpec)
    blur = ("transmission_extra_roughness",)
    return (*spec.without_effect, *(blur if case.opaque and blur[0] in spec.names else ()))


def without_effect(case: Case) -> list[str]:
    """Inputs that change neither a value in any branch nor the emission."""
    spec, evaluating = case.of(SurfaceShaderSpec), case.evaluating
    given = {port.path.rsplit("/", 1)[-1]: port.value for port in evaluating.shader.inputs}
    for name in spec.names:  # frame inputs have no value in a document
        if name.endswith(("normal", "tangent")):
            given.setdefault(name, TANGENT if "tangent" in name else NORMAL)
    rows = [row for changes in spec.changes.values() for row in changes]
    names = dict.fromkeys(name for row in rows for name in row)
    if missing := [name for name in names if name not in given]:
        names_lost = ", ".join(missing)
        raise NotRun(f"{spec.node} of this MaterialX lacks an input that is varied: {names_lost}")
    inputs = {name: np.asarray(given[name]) for name in names}
    few = replace(case.backend.batches[0].first(CHANGED), inputs=inputs)
    batch = backends.joined([few.altered(**row) for row in rows])
    effective = np.zeros(len(spec.names), bool)
    for branch, output in (*((each, "response") for each in SCATTERING), ("emission", "radiance")):
        ask = partial(evaluating.evaluate, branch=branch, output=output)
        found = case.measured(ask, batch)
        pairs = found.reshape(len(spec.names), 2, -1)
        effective |= ~unchanged(pairs[:, 0], pairs[:, 1]).all(axis=1)
    return [name for name, each in zip(spec.names, effective, strict=True) if not each]


# The host evaluates only the first row, and its values count for all rows.
ignore_changes = controls.Control(
    "every change is dropped",
    lambda case: replace(
        case,
        inputs=lambda batch: batch.first(1),
        outputs=lambda batch, found: np.repeat(found, len(batch.wo), axis=0),
    ),
)


def diagnose_reach(case: Case) -> Diagnosis:
    known, wrong = expected_dead(case), misplaced(case)
    dead, effective = (
        [x for x in wrong if (x in known) == known_dead] for known_dead in (False, True)
    )
    groups = {"changes_nothing": dead, "changes_something": effective}
    causes = (Cause(Kind.DEFECT, key, tuple(names)) for key, names in groups.items() if names)
    return Diagnosis(tuple(causes))


# fmt: off
ROWS = (
    Check(key="lobes",
          claim="In direct light, the material is the sum of its lobes by the layer equation.",
          applies=SURFACES, measure=values, tolerance="value", control=controls.shifted,
          explain=diagnose_lobes),
    Check(key="lobes_film", claim="Under a thin film, too, the material is the sum of its lobes.",
          applies=family(SurfaceShaderSpec, lambda spec: bool(spec.film)),
          measure=lambda case: case.compared(case.backend.take(case.of(SurfaceShaderSpec).films)),
          tolerance="lobes_film", control=controls.shifted, explain=SUM, requires=Ability.LIGHT),
    Check(key="lobes_albedo",
          claim="The environment branch returns the albedo of all lobes by the layer equation.",
          applies=SURFACES, measure=ALBEDO, tolerance="albedo", control=controls.shifted,
          explain=SUM, methods=finds_albedo),
    Check(key="lobes_mean",
          claim="Averaged over many materials and views, the shader returns as much light as its lobes.",
          applies=SURFACES, measure=lobes_mean, tolerance="lobes_mean",
          control=controls.scale("every value is 1 % too low", 0.99), explain=SUM,
          requires=Ability.LIGHT, methods=finds_albedo),
    Check(key="lobes_furnace",
          claim="A white material with many lobes disappears in a white environment.",
          applies=SURFACES, measure=lobes_furnace, tolerance="albedo",
          control=controls.scale("every value is 10 % too low", 0.9), explain=SUM,
          requires=Ability.LIGHT, methods=finds_albedo),
    Check(key="lobes_energy",
          claim="No material with these lobes reflects and transmits more light than it receives.",
          applies=SURFACES, measure=lobes_energy, tolerance="albedo",
          control=controls.scale("every value is 50 % too high", 1.5), explain=SUM,
          requires=Ability.LIGHT, methods=finds_albedo),
    Check(key="glass",
          claim="Clear glass reflects and transmits the shares of a white environment that its lobes have by the layer equation.",
          applies=SURFACES, measure=glass, tolerance="glass",
          control=controls.scale("values are 5 % too large", 1.05), explain=SUM,
          requires=Ability.LIGHT),
    Check(key="reach",
          claim="Every input changes a value, except those that are known to change nothing.",
          applies=SURFACES, measure=lambda case: count_named(misplaced(case)),
          tolerance=count_of(Quantity.INPUTS), control=ignore_changes, explain=diagnose_reach),
)
# fmt: on
