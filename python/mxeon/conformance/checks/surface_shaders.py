# SPDX-License-Identifier: Apache-2.0
"""Checks of surface shaders as a whole; a failure names the lobe without which it vanishes."""

from collections.abc import Iterable

import numpy as np

from mxeon.conformance.accuracy import surface_shaders as tolerances
from mxeon.conformance.accuracy.diffuse import count_of
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import Altered, Mistake, scale, shifted
from mxeon.conformance.checks.measures import counted
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.comparisons import ALBEDO, VALUE
from mxeon.conformance.nodes.surface_shaders import SHADERS, SurfaceShader
from mxeon.conformance.probes.cases import SCATTERING, albedo_cases, value_cases
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Array, Batch
from mxeon.conformance.samples.measurement import Case, scaled

MODELS = tuple(shader.model for shader in SHADERS)
WORST = 32  # pairs that are looked at
# Inputs that take a lobe away, by its name.
LOBE_INPUTS = {
    "coat": ("coat", "coat_weight", "clearcoat"),
    "sheen": ("sheen", "fuzz_weight", "sheen_color"),
    "metal": ("metalness", "base_metalness", "metallic"),
    "specular reflection": ("specular", "specular_weight"),
}


def energy(probe: Probe) -> Iterable[Case]:
    """Albedos above 1 over random materials with every lobe."""
    albedo = probe.albedo(probe.materials)
    return [Case(probe.materials, np.maximum(albedo, 1.0), np.ones((1, 3)))]


def mean(probe: Probe) -> Iterable[Case]:
    """Direct light and albedos against those by the layer equation."""
    return [*value_cases(probe), *albedo_cases(probe)]


def furnace(probe: Probe) -> Iterable[Case]:
    """Albedo against 1 of a material that loses no light."""
    albedo = probe.albedo(probe.white)
    return [Case(probe.white, albedo, np.ones((1, 3)))]


def misplaced(probe: Probe) -> list[str]:
    """Inputs that change something where the page says nothing, or the reverse."""
    table = subject_of(probe, SurfaceShader).table
    wrong = set(table.without_effect).symmetric_difference(without_effect(probe))
    return sorted(wrong.difference(table.curved, probe.unset))


def without_effect(probe: Probe) -> list[str]:
    """Inputs that change no value in any branch."""
    names = subject_of(probe, SurfaceShader).inputs
    effective = np.zeros(len(names), bool)
    for branch in SCATTERING:
        values = probe.response(probe.changed, branch).reshape(len(names), 2, -1)
        effective |= (values[:, 0] != values[:, 1]).any(axis=1)
    return [name for name, each in zip(names, effective, strict=True) if not each]


def diagnose_lobes(probe: Probe) -> Diagnosis:
    """The lobe whose absence leaves the smallest error of the worst pairs."""
    # Pick the worst pairs.
    [batch] = probe.batches
    expected = probe.expected(batch)
    worst = np.argsort(scaled(probe.direct(batch), expected))[-WORST:]
    pairs = batch.where(worst)
    # Find their error without each lobe.
    errors = {}
    for lobe, inputs in LOBE_INPUTS.items():
        if names := tuple(name for name in inputs if name in batch.inputs):
            errors[lobe] = _error(probe, pairs, names)
    lobe = min(errors, key=errors.__getitem__)
    if errors[lobe] <= tolerances.VALUE.value:
        return Diagnosis(f"the layer equation holds without the {lobe}")
    least = " and ".join(sorted(errors, key=errors.__getitem__)[:2])
    return Diagnosis(f"no single lobe explains it; the error is smallest without {least}")


def _error(probe: Probe, pairs: Batch, names: tuple[str, ...]) -> float:
    """Largest error of pairs whose materials lack a lobe."""
    plain = pairs.altered(**{name: np.zeros_like(pairs.inputs[name]) for name in names})
    return float(scaled(probe.direct(plain), probe.expected(plain)).max())


def diagnose_sum(probe: Probe) -> Diagnosis:
    """Where the lobes are judged."""
    return Diagnosis("see the checks of each lobe and of `layer`")


def diagnose_reach(probe: Probe) -> Diagnosis:
    """The inputs."""
    known, wrong = subject_of(probe, SurfaceShader).table.without_effect, misplaced(probe)
    groups = {
        verb: [name for name in wrong if (name in known) == effective]
        for verb, effective in (("changes nothing", False), ("changes something", True))
    }
    texts = (f"{', '.join(names)} {verb}" for verb, names in groups.items() if names)
    return Diagnosis("; ".join(texts))


class IgnoreChanges(Altered):
    """A probe whose host sees the first pair only."""

    def response(self, batch: Batch, branch: str) -> Array:
        return np.repeat(self.probe.response(batch.first(1), branch), len(batch.wo), axis=0)


CHECKS = (
    Check(
        "lobes",
        "In direct light, the material is the sum of its lobes by the layer equation.",
        MODELS,
        VALUE,
        shifted,
        diagnose=diagnose_lobes,
    ),
    Check(
        "lobes_albedo",
        "The environment branch returns the albedo of all lobes by the layer equation.",
        MODELS,
        ALBEDO,
        shifted,
        diagnose=diagnose_sum,
    ),
    Check(
        "lobes_mean",
        "Averaged over many materials and views, no light is gained or lost.",
        MODELS,
        mean,
        scale("every value is 1 % too low", 0.99),
        tolerances.MEAN,
        lit=True,
        diagnose=diagnose_sum,
    ),
    Check(
        "lobes_furnace",
        "A white material with many lobes disappears in a white environment.",
        MODELS,
        furnace,
        scale("every value is 10 % too low", 0.9),
        "albedo",
        lit=True,
        diagnose=diagnose_sum,
    ),
    Check(
        "lobes_energy",
        "No material with these lobes reflects and transmits more light than it receives.",
        MODELS,
        energy,
        scale("every value is 50 % too high", 1.5),
        "albedo",
        lit=True,
        diagnose=diagnose_sum,
    ),
    Check(
        "reach",
        "Every input changes a value unless its page says otherwise.",
        MODELS,
        counted(misplaced),
        Mistake("every change is dropped", IgnoreChanges),
        count_of("inputs"),
        diagnose=diagnose_reach,
    ),
)
