# SPDX-License-Identifier: Apache-2.0
"""The table of checks: a claim, how it is measured, how wrong it may be, and what it must catch.

A check passes at error <= limit. Its control is the same probe made wrong on purpose, on the same
host; the check has to fail on it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.conformance.checks import measures
from mxeon.conformance.checks.measures import absolute, of_mean, relative
from mxeon.conformance.checks.nodes import FLAG

ANY = ("eon", "qon")
ROUNDING = 2.0**-24  # unit roundoff of float32


@dataclass(frozen=True)
class Tolerance:
    """What an error may be.

    Attributes
    ----------
    limit : float
    unit : str
        What the error counts.
    error : callable (measured, expected) -> ndarray
        Error of each row.
    derivation : str
    """

    limit: float
    unit: str
    error: Callable
    derivation: str


@dataclass(frozen=True)
class Check:
    """A row of the table.

    Attributes
    ----------
    key, claim : str
        One word, and a sentence.
    models : tuple of str
        What a subject has to be for this check; empty for a check of the shader twins.
    measure : callable (probe, error) -> Measurement
    variant : str
        What the control does wrong.
    control : callable (probe) -> probe
    tolerances : dict of str to Tolerance
        By kind of probe; one that is missing cannot be asked.
    """

    key: str
    claim: str
    models: tuple[str, ...]
    measure: Callable
    variant: str
    control: Callable
    tolerances: dict


@dataclass(frozen=True)
class Altered:
    """A probe made wrong: its batches changed on the way in, its values on the way out."""

    probe: object
    batch: Callable = lambda batch: batch
    values: Callable = lambda batch, values: values

    def __getattr__(self, name):
        return getattr(self.probe, name)

    @property
    def batches(self):
        """The few: a control has nothing to prove on a million."""
        return self.probe.few

    def direct(self, batch):
        """Values of the changed batch, changed."""
        return self.values(batch, self.probe.direct(self.batch(batch)))

    def albedo(self, batch):
        """Albedos of the changed batch, changed."""
        return self.values(batch, self.probe.albedo(self.batch(batch)))


def _inputs(**given):
    """A control that hands the host these inputs in place of the batch's."""
    return lambda probe: Altered(probe, batch=lambda batch: batch.altered(**given))


def _grey(probe):
    """A control that loses the colour: every channel gets the mean of the three."""

    def grey(batch):
        mean = np.mean(batch.inputs["color"], axis=-1, keepdims=True)
        return batch.altered(color=np.repeat(mean, 3, axis=-1))

    return Altered(probe, batch=grey)


def _untouched(probe):
    """A control that drops every change of inputs: the host sees the first batch only."""
    return Altered(probe, batch=lambda batch: probe.few[0])


def _scaled(power):
    """A control whose values carry a power of cos(theta_o) too many."""

    def values(batch, values):
        with np.errstate(divide="ignore", invalid="ignore"):
            return values * batch.wo[:, 2:] ** power

    return lambda probe: Altered(probe, values=values)


def _rough(call):
    """A control whose last argument, the parameter, is five per cent off."""
    return lambda function, *arguments: call(function, *arguments[:-1], 0.95 * arguments[-1])


VALUE = (
    "32 roundings of float32, 2^-24 each, of numbers up to 1: three in the inputs, five in s, twelve "
    "in the two losses, twelve in the sum"
)
ENVIRONMENT = "16 roundings of float32, 2^-24 each, of numbers up to 1: half of the direct branch"
LOBE = (
    "512 roundings of float32, 2^-24 each: 16 in the place of a pixel's point, over the square of the "
    "smallest cosine judged, 1/4; 32 in the lobe; four in sums that other lobes make 48 times as large"
)
CYCLES_RAY = (
    "float32 place of a pixel's point, 2^-24 of the camera's distance over the smallest cosine "
    "judged, times the sensitivity of f cos to it"
)
NOISE = (
    "four standard errors of the mean over a picture: 2e-3 a pixel with 256 samples of a weight "
    "whose variance is at most 1, over the root of 12 000 pixels"
)

TESTRENDER = (
    "half floats, 2^-11 relative; and the light's width, a thousandth of its distance, in 64 samples: "
    "four standard errors of 1e-4"
)
TESTRENDER_NOISE = (
    "half floats, 2^-11; and four standard errors of the mean over a picture: 256 samples of a weight "
    "whose variance is at most 1, over the root of 16 384 pixels"
)

CHECKS = (
    Check(
        "value",
        "The value is the model's for every pair of directions, back-lit and grazing ones included.",
        ANY,
        measures.value,
        "roughness is dropped",
        _inputs(roughness=0.0),
        {
            "pairs": Tolerance(2e-6, "pi f cos", absolute, VALUE),
            "pictures": Tolerance(2e-4, "relative", relative, CYCLES_RAY),
            "planes": Tolerance(1e-3, "relative", relative, TESTRENDER),
        },
    ),
    Check(
        "lobe",
        "The diffuse lobe of the surface shader is the model's.",
        (*ANY, "lambert"),
        measures.value,
        "every channel gets the mean colour",
        _grey,
        {"lobes": Tolerance(512 * ROUNDING, "pi f cos", absolute, LOBE)},
    ),
    Check(
        "environment",
        "The environment branch gives the directional albedo in closed form.",
        ANY,
        measures.environment,
        "every channel gets the mean colour",
        _grey,
        {
            "pairs": Tolerance(1e-6, "albedo", absolute, ENVIRONMENT),
            "pictures": Tolerance(8e-5, "mean albedo", of_mean, NOISE),
            "planes": Tolerance(2.5e-3, "mean albedo", of_mean, TESTRENDER_NOISE),
        },
    ),
    Check(
        "albedo",
        "Values integrate to the coloured directional albedo.",
        ANY,
        measures.quadrature,
        "every channel gets the mean colour",
        _grey,
        {
            "pairs": Tolerance(
                2e-6, "albedo", absolute, "an average of values: no worse than the worst"
            )
        },
    ),
    Check(
        "furnace",
        "A white surface in a white surrounding cannot be seen.",
        ("eon",),
        measures.furnace,
        "reflectance is 0.99",
        _inputs(color=(0.99, 0.99, 0.99)),
        {
            "pairs": Tolerance(1e-6, "albedo", absolute, ENVIRONMENT),
            "pictures": Tolerance(8e-5, "mean albedo", of_mean, NOISE),
            "planes": Tolerance(2.5e-3, "mean albedo", of_mean, TESTRENDER_NOISE),
        },
    ),
    Check(
        "black",
        "A black surface reflects nothing.",
        ANY,
        measures.black,
        "reflectance is 0.001",
        _inputs(color=(0.001, 0.001, 0.001)),
        {
            "pairs": Tolerance(0.0, "pi f cos", absolute, "a product with 0 is 0 in any precision"),
            "pictures": Tolerance(
                0.0, "pi f cos", absolute, "a product with 0 is 0 in any precision"
            ),
            "planes": Tolerance(
                0.0, "pi f cos", absolute, "a product with 0 is 0 in any precision"
            ),
        },
    ),
    Check(
        "reciprocity",
        "Exchanging the two directions does not change the BRDF.",
        ANY,
        measures.reciprocity,
        "the value carries cos(theta_o) once more",
        _scaled(1),
        {"pairs": Tolerance(2e-6, "pi f cos cos", absolute, VALUE)},
    ),
    Check(
        "lambert",
        "Roughness 0 is Lambert.",
        ANY,
        measures.lambert,
        "roughness is 0.1",
        _inputs(roughness=0.1),
        {
            "pairs": Tolerance(
                5e-7, "pi f cos", absolute, "eight roundings of float32, 2^-24 each"
            ),
            "pictures": Tolerance(2e-4, "relative", relative, CYCLES_RAY),
            "planes": Tolerance(1e-3, "relative", relative, TESTRENDER),
        },
    ),
    Check(
        "flag",
        "energy_compensation changes the value by as much as the models differ.",
        ANY,
        measures.flag,
        "the flag is dropped",
        _inputs(**{FLAG: True}),
        {
            "pairs": Tolerance(
                1e-5, "relative", absolute, "two values, each within its own tolerance"
            ),
            "pictures": Tolerance(
                1e-3, "relative", absolute, "two values within 2e-4 of 1, over 0.4"
            ),
            "planes": Tolerance(
                5e-3, "relative", absolute, "two values within 1e-3 of 1, over 0.4"
            ),
        },
    ),
    Check(
        "inputs",
        "Every input of the node changes the value.",
        ANY,
        measures.inputs,
        "every change is dropped",
        _untouched,
        {
            "pairs": Tolerance(0, "inputs", absolute, "a count"),
            "pictures": Tolerance(0, "inputs", absolute, "a count"),
            "planes": Tolerance(0, "inputs", absolute, "a count"),
        },
    ),
    Check(
        "finite",
        "No value at the edges of the domain is infinite or not a number.",
        ANY,
        measures.finite,
        "the value is divided by cos(theta_o)",
        _scaled(-1),
        {"pairs": Tolerance(0, "values", absolute, "a count")},
    ),
    Check(
        "twins",
        "The functions of the shader twins are the NumPy models.",
        (),
        measures.twins,
        "the last argument is five per cent off",
        _rough,
        {
            "pairs": Tolerance(2e-6, "pi f cos", absolute, VALUE),
            "pictures": Tolerance(2e-6, "pi f cos", absolute, VALUE),
        },
    ),
    Check(
        "loss",
        "1 - E keeps its relative accuracy down to a cosine of 1e-6.",
        (),
        measures.loss,
        "the last argument is five per cent off",
        _rough,
        {
            "pairs": Tolerance(1e-5, "relative", relative, "the fit's 3e-7 and a dozen roundings"),
            "pictures": Tolerance(
                1e-5, "relative", relative, "the fit's 3e-7 and a dozen roundings"
            ),
        },
    ),
)
