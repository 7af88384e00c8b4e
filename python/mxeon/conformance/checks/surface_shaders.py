# SPDX-License-Identifier: Apache-2.0
"""Checks of whole surface shaders, and of sentences in their specifications."""

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.conformance import backends, controls, samples, specs
from mxeon.conformance.case import BRANCHES, Case, unchanged
from mxeon.conformance.case import values as direct_values
from mxeon.conformance.check import Check, family
from mxeon.conformance.checks.lobes import LAYERS, finds_albedo
from mxeon.conformance.diagnosis import ALBEDO, THROUGHPUT, Comparison, defect
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity
from mxeon.conformance.spec import Ability, broadcast_inputs
from mxeon.conformance.specs.surface_shaders import STRETCHED_FIT, SurfaceShaderSpec, stretched
from mxeon.conformance.specs.surface_shaders import VALUE as VALUE_ERROR
from mxeon.conformance.specs.surface_texts import EMITTED, SentenceSpec
from mxeon.conformance.tolerance import Compared, count_named, count_of, scaled
from mxeon.errors import NotRun
from mxeon.hosts.calls import NORMAL, TANGENT

WORST = 32  # number of worst pairs that a diagnosis tries to correct
CHANGED = 8  # number of pairs for each changed input
# For each lobe, inputs that disable the lobe if set to 0.
LOBE_INPUTS = {
    "coat": ("coat", "coat_weight", "clearcoat"),
    "sheen": ("sheen", "fuzz_weight", "sheen_color"),
    "metal": ("metalness", "base_metalness", "metallic"),
    "specular reflection": ("specular", "specular_weight"),
}


def diagnose_lobes(case: Case) -> Diagnosis:
    """Find the lobe whose removal corrects the worst pairs."""
    batch, measured, expected = values(case)
    error = scaled(measured, expected)
    anisotropic = stretched(batch)
    if error[~anisotropic].max() > VALUE_ERROR.value:
        error[anisotropic] = 0.0
    pairs = batch.where(np.argsort(error)[-WORST:])
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
    """Titles of the material's lobes whose throughput is wrong when each lobe is judged alone."""
    from mxeon.shaders.document.graphs import categories, inner_nodes

    used = categories(inner_nodes(case.evaluating.shader.document))
    lobes = [case.another(each) for each in specs.PLAIN_LOBES if LAYERS(each) and each.node in used]
    return [
        lobe.spec.title
        for lobe in lobes
        if any(lobe.tolerance("throughput").wrong(each).any() for each in THROUGHPUT(lobe))
    ]


SURFACES, SUM = family(SurfaceShaderSpec), defect("sum_of_lobes")


def values(case: Case) -> Compared:
    """Compare values with the layer equation.

    Shaders fit anisotropic lobes less accurately. The error of a pair with an anisotropic lobe is
    therefore multiplied by VALUE_ERROR / STRETCHED_FIT. If the mean error of all pairs with
    anisotropic lobes is larger, the mean error replaces the product.
    """
    [batch] = case.batches
    expected = case.expected(batch)
    scale = np.maximum(expected.max(axis=1, keepdims=True), 1.0)
    errors, anisotropic = (case.direct(batch) - expected) / scale, stretched(batch)
    if np.any(anisotropic):
        mean = errors[anisotropic].mean(axis=0)
        reduced = errors[anisotropic] * (VALUE_ERROR.value / STRETCHED_FIT)
        errors[anisotropic] = np.where(np.abs(reduced) > np.abs(mean), reduced, mean)
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
    spec = case.of(SurfaceShaderSpec)
    batch = spec.clear(case.backend.views[0])
    passed = spec.transmitted(batch, case.opaque)
    measured = case.transmitted(batch)
    yield Compared(batch, measured, passed)
    if case.host.active.environment == "fis":  # skip methods that fit albedos or reflect nothing
        yield Compared(batch, measured + case.albedo(batch), passed + case.expected_albedo(batch))


def unexpected(case: Case) -> list[str]:
    """Inputs that wrongly have an effect, and inputs that wrongly have no effect."""
    wrong = expected_dead(case).symmetric_difference(without_effect(case))
    return sorted(wrong.difference(case.backend.unset))


def expected_dead(case: Case) -> set[str]:
    """Inputs that must have no effect, such as extra roughness if transmission becomes opacity."""
    spec = case.of(SurfaceShaderSpec)
    blur = {"transmission_extra_roughness"} & {*spec.names} if case.opaque else set()
    return {*spec.without_effect} | blur


def without_effect(case: Case) -> list[str]:
    """Inputs that change neither the scattered light, for any kind of light, nor the emission."""
    spec, evaluating = case.of(SurfaceShaderSpec), case.evaluating
    defaults = {port.path.rsplit("/", 1)[-1]: port.value for port in evaluating.shader.inputs}
    for name in spec.names:  # normals and tangents have no default value
        if name.endswith(("normal", "tangent")):
            defaults.setdefault(name, TANGENT if "tangent" in name else NORMAL)
    rows = [row for changes in spec.changes.values() for row in changes]
    names = dict.fromkeys(name for row in rows for name in row)
    if missing := ", ".join(name for name in names if name not in defaults):
        raise NotRun(f"{spec.node} of this MaterialX lacks an input to vary: {missing}")
    inputs = {name: np.asarray(defaults[name]) for name in names}
    few = replace(case.backend.batches[0].first(CHANGED), inputs=inputs)
    batch = backends.joined([few.altered(**row) for row in rows])
    effective = np.zeros(len(spec.names), bool)
    for branch in BRANCHES:
        output = "radiance" if branch == "emission" else "response"
        evaluate = partial(evaluating.evaluate, branch=branch, output=output)
        pairs = case.measured(evaluate, batch).reshape(len(spec.names), 2, -1)
        effective |= ~unchanged(pairs[:, 0], pairs[:, 1]).all(axis=1)
    return [name for name, each in zip(spec.names, effective, strict=True) if not each]


# A mistake in which the result of the first pair is used for all pairs.
ignore_changes = controls.Control(
    "every change is dropped",
    lambda case: replace(
        case,
        inputs=lambda batch: batch.first(1),
        outputs=lambda batch, values: np.repeat(values, len(batch.wo), axis=0),
    ),
)


def diagnose_reach(case: Case) -> Diagnosis:
    dead, wrong = expected_dead(case), unexpected(case)
    groups = {
        "changes_nothing": tuple(name for name in wrong if name not in dead),
        "changes_something": tuple(name for name in wrong if name in dead),
    }
    causes = (Cause(Kind.DEFECT, key, names) for key, names in groups.items() if names)
    return Diagnosis(tuple(causes))


SENTENCE = Comparison("value", direct_values, lambda case: case.valued.value_candidates)


def diagnose_sentence(case: Case) -> Diagnosis:
    """Find the formula by which the shader or its graph implements a specified sentence."""
    from mxeon.conformance.reference import Reference

    spec, explained = case.of(SentenceSpec), SENTENCE.diagnose(case)
    if explained.kind is Kind.MODEL or spec.evaluated == EMITTED:
        return explained
    [batch] = case.batches
    branch, _, factor = spec.evaluated
    inputs = broadcast_inputs(batch.altered(**{**spec.fixed, **batch.inputs}))
    try:
        shader = case.evaluating.shader
        graph = factor * Reference().evaluate(shader, batch.wo, batch.wi, inputs, branch)
    except NotRun:
        return explained
    readings = spec.value_candidates
    errors = {each.title: float(np.abs(each.values(batch) - graph).max()) for each in readings}
    nearest = min(errors, key=errors.__getitem__)
    if errors[nearest] > case.tolerance("value").value:
        return explained
    if explained.distances[nearest] < explained.distances[readings[0].title]:
        return Diagnosis(
            (Cause(Kind.MODEL, nearest), *defect("lobes_too").causes), explained.distances
        )
    return replace(defect("lobes_of_graph"), distances=explained.distances)


# fmt: off
ROWS = (
    Check(key="lobes",
          claim="In direct light, the material is the sum of its lobes by the layer equation.",
          applies=SURFACES, measure=values, tolerance="value", control=controls.shifted,
          explain=diagnose_lobes),
    Check(key="lobes_film", claim="Under a thin film, too, the material is the sum of its lobes.",
          applies=family(SurfaceShaderSpec, lambda spec: bool(spec.film)),
          measure=lambda case: case.compared(case.backend.take(case.of(SurfaceShaderSpec).films)),
          control=controls.shifted, explain=SUM, requires=Ability.LIGHT),
    Check(key="lobes_albedo",
          claim="The environment branch returns the albedo of all lobes by the layer equation.",
          applies=SURFACES, measure=ALBEDO, control=controls.shifted, explain=SUM, methods=finds_albedo),
    Check(key="lobes_mean",
          claim="Averaged over many materials and views, the shader returns as much light as its lobes.",
          applies=SURFACES, measure=lobes_mean,
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
          claim="In a white environment, clear glass reflects and transmits as its lobes do by the layer equation.",
          applies=SURFACES, measure=glass, control=controls.scale("values are 5 % too large", 1.05),
          explain=SUM, requires=Ability.LIGHT),
    Check(key="reach",
          claim="Every input changes a value, except those that are known to change nothing.",
          applies=SURFACES, measure=lambda case: count_named(unexpected(case)),
          tolerance=count_of(Quantity.INPUTS), control=ignore_changes, explain=diagnose_reach),
    Check(key="specification",
          claim="The surface shader does what this sentence of its specification says.",
          applies=family(SentenceSpec), measure=SENTENCE, control=controls.shifted,
          explain=diagnose_sentence, open=True),
)
# fmt: on
