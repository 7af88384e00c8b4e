# SPDX-License-Identifier: Apache-2.0
"""A Python function judged like a host: for anyone whose renderer or library has bindings."""

import platform
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from importlib.metadata import version

import numpy as np

import mxeon
from mxeon.conformance.checks.evaluate import judge_subject
from mxeon.conformance.checks.probes import FEW, SEED, Batch, PairProbe, directions, random_inputs
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.results import PASSED, Run
from mxeon.errors import InputError
from mxeon.models import table as reference
from mxeon.shaders.hosts.base import Identity

# What can be asked of values alone: there is no environment branch and no flag.
KEYS = ("value", "albedo", "black", "reciprocity", "lambert", "inputs", "finite")
LIBRARY = "callable"


@dataclass(frozen=True)
class Function:
    """What is judged, in place of a host.

    Attributes
    ----------
    name : str
    brdf : callable
    """

    name: str
    brdf: Callable


@dataclass(frozen=True)
class Claim:
    """What a function has to be, in place of a node.

    Attributes
    ----------
    title, model : str
    """

    title: str
    model: str
    inputs = ("color", "roughness")
    flag = None


@dataclass(frozen=True)
class CallableProbe(PairProbe):
    """A function asked for pairs."""

    @cached_property
    def batches(self):
        """One batch of FEW random pairs."""
        rng = np.random.default_rng(SEED)
        wo, wi = directions(rng, FEW), directions(rng, FEW)
        return (Batch(wo, wi, random_inputs(rng, FEW, reference.model(self.subject.model))),)

    def _evaluate(self, batch, branch):
        """f cos(theta_i), (N, 3); for an environment nothing, (N, 0)."""
        count = len(batch.wi)
        if branch == "environment":
            return np.empty((count, 0))
        rho = np.broadcast_to(np.asarray(batch.inputs["color"], float), (count, 3))
        roughness = np.broadcast_to(np.asarray(batch.inputs["roughness"], float), count)
        values = np.asarray(self.host.brdf(batch.wo, batch.wi, rho, roughness), np.float64)
        if values.shape != (count, 3):
            raise InputError(
                f"values of {self.host.name} must have shape {(count, 3)}; got {values.shape}"
            )
        with np.errstate(invalid="ignore"):  # inf x 0 is for the checks to find
            return values * batch.wi[:, 2:]


def check_brdf(brdf, model="eon", name=None):
    """Run every check that applies to a function of directions and inputs.

    Parameters
    ----------
    brdf : callable
        `brdf(wo, wi, rho, roughness) -> values`, with wo, wi and rho (N, 3), roughness (N,) and
        values (N, 3) in 1/sr, without the cosine. The directions leave the surface, in the local
        frame with the normal +z; roughness is sigma in radian for models that have one.
    model : str
        What it has to be: a row of `mxeon.models.table.MODELS` with a parameter.
    name : str or None
        What the report calls it; None for the function's own name.

    Returns
    -------
    Run
        See `mxeon.report.write`.

    Raises
    ------
    ValueError
        If there is no such model, or the values have another shape.

    Examples
    --------
    >>> from mxeon.models import eon_brdf
    >>> {result.verdict for result in check_brdf(eon_brdf).results}
    {'passed'}
    """
    probe = _probe(brdf, model, name)
    results = tuple(judge_subject(probe, (check,))[0] for check in _checks(model))
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version(), "numpy": version("numpy")},
        hosts=(Identity(probe.host.name, "version not given", "device not given"),),
        results=results,
    )


def brdf_test(brdf, model="eon", name=None):
    """Test function for pytest, with one case per check of `check_brdf`.

    Assign it to a name that begins with `test_`:

        from mxeon import brdf_test
        from my_renderer import my_brdf

        test_my_brdf_is_eon = brdf_test(my_brdf, "eon")

    Parameters
    ----------
    brdf, model, name
        As those of `check_brdf`.

    Returns
    -------
    callable
        A test function; on failure it shows the error, the tolerance and the nearest known model.

    Raises
    ------
    ImportError
        If pytest is not installed.
    """
    import pytest

    probe = _probe(brdf, model, name)

    @pytest.mark.parametrize("check", _checks(model), ids=lambda check: check.key)
    def test_brdf(check):
        (result,) = judge_subject(probe, (check,))
        assert result.verdict == PASSED, f"{check.claim} {result.explanation}"

    return test_brdf


def _probe(brdf, model, name):
    name = name or getattr(brdf, "__name__", type(brdf).__name__)
    return CallableProbe(Function(name, brdf), Claim(reference.model(model).title, model), LIBRARY)


def _checks(model):
    """Rows of the table that apply to values of a model."""
    row = reference.model(model)
    if not row.parameter:
        known = ", ".join(each.name for each in reference.MODELS if each.parameter)
        raise InputError(f"model must be one of {known}; got {model!r}")
    kept = [key for key in KEYS if key != "albedo" or row.albedo_dir]
    return tuple(replace(check, models=(model,)) for check in CHECKS if check.key in kept)
