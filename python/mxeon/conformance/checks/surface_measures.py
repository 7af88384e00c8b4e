# SPDX-License-Identifier: Apache-2.0
"""Measurements of surface shaders as a whole."""

from collections.abc import Iterable

import numpy as np

from mxeon.conformance.nodes.surface_shaders import SurfaceShader
from mxeon.conformance.probes.probe import Probe, subject_of
from mxeon.conformance.samples.measurement import Case, Measurement, count_named

BRANCHES = ("direct", "environment", "transmission")


def energy(probe: Probe) -> Iterable[Case]:
    """Albedos above 1 over random materials with every lobe."""
    albedo = probe.albedo(probe.materials)
    return [Case(probe.materials, np.maximum(albedo, 1.0), np.ones((1, 3)))]


def furnace(probe: Probe) -> Iterable[Case]:
    """Albedo against 1 of a material that loses no light."""
    albedo = probe.albedo(probe.white)
    return [Case(probe.white, albedo, np.ones((1, 3)))]


def reach(probe: Probe) -> Measurement:
    """Number of inputs that change something where the page says nothing, or the reverse."""
    return count_named(misplaced(probe))


def misplaced(probe: Probe) -> list[str]:
    """The inputs of `reach`."""
    table = subject_of(probe, SurfaceShader).table
    wrong = set(table.without_effect).symmetric_difference(without_effect(probe))
    return sorted(wrong.difference(table.curved))


def without_effect(probe: Probe) -> list[str]:
    """Inputs that change no value in any branch."""
    names = subject_of(probe, SurfaceShader).inputs
    effective = np.zeros(len(names), bool)
    for branch in BRANCHES:
        values = probe.response(probe.changed, branch).reshape(len(names), 2, -1)
        effective |= (values[:, 0] != values[:, 1]).any(axis=1)
    return [name for name, each in zip(names, effective, strict=True) if not each]
