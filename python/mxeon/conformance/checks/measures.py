# SPDX-License-Identifier: Apache-2.0
"""What the checks measure: each takes a probe and gives its worst error and where it was found."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from mxeon.conformance.checks.nodes import FLAG
from mxeon.conformance.checks.probes import (
    GRAZING,
    SEED,
    Batch,
    directions,
    random_inputs,
)
from mxeon.models import albedo
from mxeon.models import table as reference
from mxeon.models.quadrature import albedo_dir_quadrature
from mxeon.shaders.hosts import front_lit_only

CHANGES = {
    "weight": 0.5,
    "color": (0.9, 0.1, 0.6),
    "roughness": 0.3,
    "normal": (0.0, 0.6, 0.8),
}
COLORS = ((0.2, 0.2, 0.2), (0.5, 0.5, 0.5), (0.8, 0.8, 0.8), (0.8, 0.4, 0.1))
WHITE, BLACK = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)
TWIN_PAIRS = 1 << 16
QUADRATURE_NODES = 16  # reaches 1e-9 on the models judged, far below float32


@dataclass(frozen=True)
class Measurement:
    """The worst error of a check, and where it was found.

    Attributes
    ----------
    error : float
    worst : dict of str to list of float
        Inputs and values at the worst point, by name.
    """

    error: float
    worst: dict


def absolute(measured, expected):
    """Largest difference of each row; infinity for what is not a number."""
    error = np.abs(measured - expected).max(axis=-1)
    return np.where(np.isfinite(error), error, np.inf)


def relative(measured, expected):
    """Largest difference of each row, relative to what is expected."""
    return absolute(measured / expected, 1.0)


def of_mean(measured, expected):
    """Difference of the means over all rows, for every row: what is left once noise averages."""
    return np.broadcast_to(absolute(np.mean(measured - expected, axis=0), 0.0), len(measured))


def value(probe, error):
    """Values against the model's, over all pairs of the probe."""
    model = probe.subject.model
    return _worst(
        error, ((each, probe.direct(each), each.expected(model)) for each in probe.batches)
    )


def environment(probe, error):
    """The environment branch against the closed form of the directional albedo."""
    row = reference.model(probe.subject.model)
    return _worst(
        error,
        (
            (
                batch,
                probe.albedo(batch),
                row.albedo_dir(batch.wo[:, 2], batch.inputs["color"], batch.inputs["roughness"]),
            )
            for batch in probe.cosines
        ),
    )


def quadrature(probe, error):
    """Directional albedo, integrated from the host's values, against its closed form."""
    cases = []
    for mu, color, roughness in product((0.1, 0.3, 0.6, 0.95), COLORS, (0.25, 1.0)):
        wo = np.array([[np.sqrt(1.0 - mu * mu), 0.0, mu]])
        batch = Batch(wo, wo, {"color": color, "roughness": roughness})
        cases.append((batch, *integrated(probe, mu, color, roughness)))
    return _worst(error, cases)


def integrated(probe, mu, color, roughness):
    """Directional albedo at one or more cosines: from the host's values, and in closed form.

    Returns
    -------
    measured, expected : ndarray, shape (N, 3)
    """

    def brdf(wo, wi, rho, roughness):
        wo = np.broadcast_to(wo, wi.shape)
        values = probe.direct(Batch(wo, wi, {"color": rho, "roughness": roughness}))
        return values / (np.pi * wi[:, 2:])

    mu, color = np.atleast_1d(mu), np.array(color)
    row = reference.model(probe.subject.model)
    measured = albedo_dir_quadrature(brdf, mu, color, roughness, nodes=QUADRATURE_NODES)
    return measured, row.albedo_dir(mu, color, roughness)


def black(probe, error):
    """What a black surface reflects."""
    batches = [batch.altered(color=BLACK) for batch in probe.few]
    return _worst(error, ((each, probe.direct(each), np.zeros((1, 3))) for each in batches))


def furnace(probe, error):
    """Albedo of a white surface against 1."""
    batches = [batch.altered(color=WHITE) for batch in probe.cosines]
    return _worst(error, ((each, probe.albedo(each), np.ones((1, 3))) for each in batches))


def reciprocity(probe, error):
    """f(wo, wi) against f(wi, wo), both times both cosines."""
    cases = []
    for batch in probe.few:
        turned = replace(batch, wo=batch.wi, wi=batch.wo)
        there = probe.direct(batch) * batch.wo[:, 2:]
        back = probe.direct(turned) * batch.wi[:, 2:]
        cases.append((batch, there, back))
    return _worst(error, cases)


def lambert(probe, error):
    """Values at roughness 0 against Lambert's."""
    batches = [batch.altered(roughness=0.0) for batch in probe.few]
    return _worst(error, ((each, probe.direct(each), each.expected("lambert")) for each in batches))


def flag(probe, _):
    """The change that the flag makes, against the one it has to make, relative to the largest."""
    error = largest = 0.0
    for batch in probe.few:
        batch = batch.altered(roughness=np.minimum(batch.inputs["roughness"], 1.0))
        judged = slice(None)
        if front_lit_only(probe.host.name, "qon"):
            judged = (batch.wo[:, :2] * batch.wi[:, :2]).sum(axis=1) >= 0.0
        on, off = (probe.direct(batch.altered(**{FLAG: state})) for state in (True, False))
        models = batch.expected("eon") - batch.expected("qon")
        error = np.maximum(error, absolute(on - off, models)[judged].max(initial=0.0))
        largest = max(largest, np.abs(models[judged]).max(initial=0.0))
    return Measurement(float(error / largest), {"expected": [float(largest)]})


def inputs(probe, _):
    """How many inputs of the node change nothing."""
    batch = probe.few[0]
    before = probe.direct(batch)
    changes = {**CHANGES, FLAG: not probe.subject.flag}
    dead = [
        name
        for name in probe.subject.inputs
        if np.array_equal(before, probe.direct(batch.altered(**{name: changes[name]})))
    ]
    return Measurement(len(dead), {name: [0.0] for name in dead})


def finite(probe, _):
    """How many values at the edges of the domain are not finite."""
    cosine = [0.0, 1e-30, 1e-6, 0.5, 1.0]
    rows = product(cosine, cosine, [0.0, 1.0, 2.0, np.pi], [0.0, 1e-6, 1.0], [0.0, 0.5, 1.0])
    mu_o, mu_i, azimuth, roughness, color = np.array(list(rows)).T
    S_o, S_i = np.sqrt(1.0 - mu_o**2), np.sqrt(1.0 - mu_i**2)
    wo = np.stack([S_o, 0.0 * S_o, mu_o], axis=-1)
    wi = np.stack([S_i * np.cos(azimuth), S_i * np.sin(azimuth), mu_i], axis=-1)
    batch = Batch(wo, wi, {"color": np.stack([color] * 3, axis=-1), "roughness": roughness})
    values = np.concatenate([probe.direct(batch), probe.albedo(batch)], axis=1)
    bad = ~np.isfinite(values).all(axis=1)
    return Measurement(int(bad.sum()), _point(batch, int(bad.argmax())) if bad.any() else {})


def twins(call, _):
    """Values and albedos of all models as functions of the shader twins, against NumPy."""
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng, TWIN_PAIRS), directions(rng, TWIN_PAIRS)
    worst = {}
    for row in reference.MODELS:
        given = random_inputs(rng, TWIN_PAIRS, row)
        parameter = [given["roughness"]] if row.parameter else []
        name = row.brdf.__name__
        measured = call(name, wo, wi, given["color"], *parameter)
        expected = row.brdf(wo, wi, given["color"], *parameter)
        worst[name] = np.pi * absolute(measured * wi[:, 2:], expected * wi[:, 2:])
    given = random_inputs(rng, TWIN_PAIRS, reference.model("eon"))
    mu, r, sigma = wo[:, 2], given["roughness"], 0.5 * np.pi * given["roughness"]
    for name, arguments in (
        ("qon_albedo_dir", (mu, sigma)),
        ("qon_albedo_avg", (sigma,)),
        ("fon_albedo_dir", (mu, r)),
        ("fon_albedo_avg", (r,)),
        ("eon_albedo_dir", (mu, given["color"], r)),
        ("eon_albedo_avg", (given["color"], r)),
    ):
        expected = getattr(albedo, name)(*arguments).reshape(TWIN_PAIRS, -1)
        worst[name] = absolute(call(name, *arguments), expected)
    figures = {name: float(error.max()) for name, error in worst.items()}
    name = max(figures, key=figures.get)
    return Measurement(figures[name], {name: [figures[name]]})


def loss(call, _):
    """1 - E of FON, relative, down to grazing: as H(mu), which the shader twins compute."""
    mu = np.float64(np.float32(np.geomspace(GRAZING, 1.0, TWIN_PAIRS)))
    error = relative(call("fon_loss", mu), albedo.fon_loss(mu)[:, None])
    return Measurement(float(error.max()), {"mu": [float(mu[error.argmax()])]})


def _worst(error, cases):
    """The worst row of (batch, measured, expected) cases."""
    found = Measurement(-1.0, {})
    for batch, measured, expected in cases:
        errors = error(measured, expected)
        row = int(np.argmax(errors))
        if errors[row] > found.error:
            expected = np.broadcast_to(expected, measured.shape)
            values = {"measured": measured[row].tolist(), "expected": expected[row].tolist()}
            found = Measurement(float(errors[row]), {**_point(batch, row), **values})
    return found


def _point(batch, row):
    """Directions and inputs of one row of a batch."""
    given = {"wo": batch.wo, "wi": batch.wi, **batch.inputs}
    return {
        name: np.ravel(each[row] if len(np.shape(each)) and len(each) == len(batch.wo) else each)
        .astype(float)
        .tolist()
        for name, each in given.items()
    }
