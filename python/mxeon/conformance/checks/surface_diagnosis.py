# SPDX-License-Identifier: Apache-2.0
"""Diagnosis of a surface shader's failures: the lobe without which they vanish."""

import numpy as np

from mxeon.conformance.accuracy.surface_shaders import VALUE
from mxeon.conformance.checks.surface_measures import misplaced
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.nodes.surface_shaders import SurfaceShader
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.batch import Batch
from mxeon.conformance.samples.measurement import scaled

WORST = 32  # pairs that are looked at
# Inputs that take a lobe away, by its name.
LOBES = {
    "coat": ("coat", "coat_weight", "clearcoat"),
    "sheen": ("sheen", "fuzz_weight", "sheen_color"),
    "metal": ("metalness", "base_metalness", "metallic"),
    "specular reflection": ("specular", "specular_weight"),
}


def diagnose_lobes(probe: Probe) -> Diagnosis:
    """The lobe whose absence leaves the smallest error of the worst pairs."""
    # Pick the worst pairs.
    [batch] = probe.batches
    expected = probe.expected(batch)
    worst = np.argsort(scaled(probe.direct(batch), expected))[-WORST:]
    pairs = batch.where(worst)
    # Find their error without each lobe.
    errors = {}
    for lobe, inputs in LOBES.items():
        if names := tuple(name for name in inputs if name in batch.inputs):
            errors[lobe] = _error(probe, pairs, names)
    lobe = min(errors, key=errors.__getitem__)
    if errors[lobe] <= VALUE.value:
        return Diagnosis(f"the layer equation holds without the {lobe}")
    least = " and ".join(sorted(errors, key=errors.__getitem__)[:2])
    return Diagnosis(f"no lobe alone explains it; the error is least without {least}")


def _error(probe: Probe, pairs: Batch, names: tuple[str, ...]) -> float:
    """Largest error of pairs whose materials lack a lobe."""
    plain = pairs.altered(**{name: np.zeros_like(pairs.inputs[name]) for name in names})
    return float(scaled(probe.direct(plain), probe.expected(plain)).max())


def diagnose_sum(probe: Probe) -> Diagnosis:
    """Where the lobes are judged."""
    return Diagnosis("the checks of each lobe and of `layer` say why")


def diagnose_reach(probe: Probe) -> Diagnosis:
    """The inputs."""
    names = misplaced(probe)
    without_effect = [
        name for name in names if name not in subject_of(probe, SurfaceShader).table.without_effect
    ]
    effective = [
        name for name in names if name in subject_of(probe, SurfaceShader).table.without_effect
    ]
    texts = [
        f"{', '.join(group)} {verb}"
        for group, verb in ((without_effect, "changes nothing"), (effective, "changes something"))
        if group
    ]
    return Diagnosis("; ".join(texts))
