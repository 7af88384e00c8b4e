# SPDX-License-Identifier: Apache-2.0
"""The shader functions as NumPy has them: arguments by the names of parameters, and values.

A function of a shader has its parameters' names in common with its NumPy version, and so takes the
columns of those names. All are float32 numbers, so that a float32 host sees the same arguments.
"""

import inspect
from collections.abc import Callable, Mapping
from functools import cache
from itertools import product

import numpy as np

from mxeon.conformance.samples import GRAZING, SEED, Array, directions, float32
from mxeon.models import sampling
from mxeon.models.diffuse import albedo, formulas, qon_albedo
from mxeon.models.sampling import cltc, eon, hemisphere, ltc
from mxeon.shaders import functions

POINTS = 4096  # of each function
CORNERS = 64  # of which so many have arguments at the ends of their ranges

# Along the normal and beyond it by a rounding, at the horizon, and between.
AXES = (
    (0.0, 0.0, 1.0),
    (0.0, 0.0, 1.0 + 2.0**-23),
    (1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0),
    (0.6, 0.0, 0.8),
)

Columns = Mapping[str, Array]


def _upper_root(m: Array) -> Array:
    """y of the angle whose cosine is 1 - m, by the integral of which the shader has a fit."""
    return eon.eon_upper_limit(1.0 - m, np.sqrt(m * (2.0 - m)))


# Functions that have another name in NumPy, or other parameters.
NAMED: Mapping[str, Callable[..., Array]] = {
    "eon_around": hemisphere.around,
    "eon_azimuth_frame": lambda wo: hemisphere.stack_xyz(*hemisphere.azimuth_frame(wo)),
    "eon_gray_weight": lambda gray, roughness: formulas.eon_multiple_weight(gray, roughness),
    "eon_rotate_z": lambda wi, cosine, sine: hemisphere.rotate_z(wi, cosine, sine),
    "eon_upper_root": _upper_root,
    "ltc_transformed": lambda wo, wh, roughness, d: ltc.ltc_transformed(wo, wh, roughness, d)[0],
    "oren_nayar_s": lambda wo, wi: formulas.cosines(wo, wi)[2],
}


def expected(function: str, columns: Columns) -> Array:
    """Values of a shader function in NumPy, (N, 1) or (N, 3)."""
    version, channels_first = _version(function)
    arguments = {
        name: columns[name] for name in inspect.signature(version).parameters if name in columns
    }
    # Colors have their channels first in some, and one channel in others.
    if "rho" in arguments:
        arguments["rho"] = columns["gray"] if _takes_gray(function) else columns["rho"]
        arguments["rho"] = arguments["rho"].T if channels_first else arguments["rho"]
    values = version(**arguments)
    values = np.asarray(values[0] if isinstance(values, tuple) else values)
    if channels_first and values.ndim == 2 and "rho" in arguments:
        values = values.T
    return values.reshape(len(columns["mu"]), -1)


def argument_names(function: str) -> list[str]:
    """Names of the columns of a function's parameters, in their order."""
    names = [name for _, name in functions.signature("glsl", function)]
    return ["gray" if name == "rho" and _takes_gray(function) else name for name in names]


def numbers(function: str) -> list[str]:
    """Names of the columns of a function's parameters that are floats, or wo for its cosine.

    Divisors are left out: a quotient is off in proportion to itself, and huge beside a divisor of 0.
    """
    return [
        "gray" if name == "rho" else name
        for kind, name in functions.signature("glsl", function)
        if (kind == "float" and name != "divisor") or name == "wo"
    ]


def moved(columns: Columns, name: str, step: float) -> Columns:
    """The columns with one of `numbers` moved by a step, towards the middle of its range."""
    middle = np.array([0.0, 0.0, 0.5]) if name == "wo" else 0.5
    moves = np.where(columns[name] > middle, -step, step) * (middle != 0.0)
    result = {**columns, name: columns[name] + moves}
    if name in ("u1", "u2"):
        result["u"] = np.stack([result["u1"], result["u2"]], axis=-1)
    return result


def _takes_gray(function: str) -> bool:
    return ("float", "rho") in functions.signature("glsl", function)


@cache
def _version(function: str) -> tuple[Callable[..., Array], bool]:
    """NumPy's version of a shader function, and whether colors have their channels first."""
    if function in NAMED:
        return NAMED[function], False
    for module in (sampling, albedo, qon_albedo, formulas, eon, ltc, cltc):
        if hasattr(module, function):
            return getattr(module, function), module is formulas
    raise LookupError(f"the shader function {function} has no version in NumPy")


@cache
def random_columns() -> Columns:
    """Random arguments by the names of parameters; those of one name may be of several functions."""
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng, POINTS), directions(rng, POINTS)
    pairs = np.array(list(product(AXES, AXES)))
    wo[: len(pairs)], wi[: len(pairs)] = pairs[:, 0], pairs[:, 1]
    unit = {
        name: _unit(rng) for name in ("u1", "u2", "v", "q", "m", "t", "y_o", "gray", "roughness")
    }
    azimuth, elevation = 2.0 * np.pi * rng.random(POINTS), 0.5 * np.pi * _unit(rng)
    mu, roughness = np.clip(wo[:, 2], GRAZING, 1.0), unit["roughness"]
    return {
        name: float32(values)
        for name, values in {
            **unit,
            "wo": wo,
            "wi": wi,
            "wh": hemisphere.around(np.sqrt(1.0 - unit["u1"]), np.sqrt(unit["u1"]), unit["u2"]),
            "u": np.stack([unit["u1"], unit["u2"]], axis=-1),
            "rho": np.stack([_unit(rng) for _ in range(3)], axis=-1),
            "sigma": 1.5707963 * roughness,
            "mu": mu,
            "mu_o": np.minimum(wo[:, 2], 1.0),
            "mu_i": np.minimum(wi[:, 2], 1.0),
            "s": formulas.cosines(wo, wi)[2],
            "S": np.sqrt((1.0 - mu) * (1.0 + mu)),
            "S_o": np.hypot(wo[:, 0], wo[:, 1]),
            "S_i": np.hypot(wi[:, 0], wi[:, 1]),
            "d": ltc.ltc_d(mu, roughness),
            "cosine": np.cos(azimuth),
            "sine": np.sin(azimuth),
            "x": np.cos(elevation),
            "y": np.sin(elevation),
            "value": 2.0 * _unit(rng) - 1.0,
            "divisor": _divisors(rng),
        }.items()
    }


def _divisors(rng: np.random.Generator) -> Array:
    """Numbers in [0, 1), a quarter of them log-uniform down to 1e-36: a shader takes 1e-37 for 0."""
    divisors = _unit(rng)
    divisors[CORNERS : POINTS // 4] = 10.0 ** (-36.0 * divisors[CORNERS : POINTS // 4])
    return divisors


def _unit(rng: np.random.Generator) -> Array:
    """Numbers of 24 bits in [0, 1), as shaders' random numbers; the first lie on either end."""
    numbers = rng.integers(0, 1 << 24, POINTS).astype(np.float64)
    numbers[:CORNERS] = (numbers[:CORNERS] % 2.0) * (2.0**24 - 1.0)
    return numbers * 2.0**-24
