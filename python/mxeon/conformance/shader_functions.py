# SPDX-License-Identifier: Apache-2.0
"""Compare a library's shader functions with the NumPy versions of the functions, on a host.

The host compiles a program that contains all functions and a dispatcher, which calls a function by
its number. The parameter names in eonlib's GLSL select random arguments for the shader and for
NumPy.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product
from typing import NamedTuple

import numpy as np

from mxeon.conformance import results, spec, tolerance
from mxeon.conformance.check import judge, not_measured
from mxeon.conformance.results import Cause, Diagnosis, Kind, Quantity, Result
from mxeon.conformance.samples import GRAZING, Array, directions, float32, generator
from mxeon.conformance.specs.diffuse import LOSS_FIT
from mxeon.conformance.specs.diffuse import VALUE as MODEL_VALUE
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.base import Host
from mxeon.models import diffuse, sampling
from mxeon.shaders import functions

KINDS = ("pairs", "pictures", "rendered")  # host types that can call shader functions
STEP = 2.0**-22  # change of an argument by which a function's condition number is measured
PART = tolerance.sum_in(Quantity.CONDITIONED, tolerance.roundings(16))


class FunctionCheck(NamedTuple):
    """A check of the shader functions that match a pattern."""

    key: str  # a single word
    claim: str  # a full sentence
    names: str  # pattern of function names; the first row that matches a function applies
    error: tolerance.Tolerance
    turns: bool = False  # whether the functions rotate vectors with the engine's sine and cosine


# fmt: off
FUNCTION_CHECKS = (
    FunctionCheck("twins", "The shader functions of models and albedos match the NumPy models.",
                  r"\w+(_brdf|_albedo_)\w*", MODEL_VALUE),
    FunctionCheck("loss", "1 - E keeps its relative accuracy down to a cosine of 1e-6.",
                  "fon_loss",
                  tolerance.sum_of(tolerance.Term(LOSS_FIT, "the fit of H"), tolerance.roundings(12),
                         quantity=Quantity.RELATIVE, metric=tolerance.relative)),
    FunctionCheck("samples", "The sampling functions return the same directions as NumPy's.",
                  r"\w+_(sample|draw|clipped|transformed)|eon_(around|azimuth_frame|rotate_z|towards)",
                  PART, turns=True),
    FunctionCheck("densities",
                  "The sampling densities and the matrix of linearly transformed cosines match NumPy's.",
                  r"\w+_pdf|ltc_(density|m[abcd])",
                  # A matrix entry has 8 roundings. The inverse fourth power multiplies the 8 by 4
                  # and adds 16.
                  tolerance.sum_in(Quantity.CONDITIONED, tolerance.roundings(48, "(four times the 8 of a matrix entry, plus 16)"))),
    FunctionCheck("parts", "The functions that models and sampling are built from match NumPy's.",
                  r"\w+", PART),
)
# fmt: on


@cache
def row_of(function: str) -> FunctionCheck:
    return next(row for row in FUNCTION_CHECKS if re.fullmatch(row.names, function))


def _error(function: str, values: Array) -> float:
    """Largest error of a shader function's values, relative to the sensitivity of the values."""
    expected, scale = exact(function)
    return float(row_of(function).error.metric(scale * values, scale * expected).max())


@cache
def exact(function: str) -> tuple[Array, Array]:
    """Values of a shader function in NumPy, and a factor for the errors of the shader function.

    The factor is pi cos(theta_i) for a BRDF and 1 for an albedo. For other functions, the factor is
    the inverse of the condition number. The condition number is the sum of max(1, |value|) and of
    the absolute derivatives of the value with respect to all arguments.
    """
    columns = random_columns()
    values = _expected(function, columns)
    if row_of(function).error.quantity is not Quantity.CONDITIONED:
        brdf = "_brdf" in function
        return values, np.pi * columns["mu_i"][:, np.newaxis] if brdf else np.ones((1, 1))
    total: Array = np.maximum(1.0, np.abs(values).max(axis=1))
    for name in arguments(function):
        # Skip divisors, because quotients have relative errors and huge slopes near a divisor of 0.
        if name == "divisor" or (columns[name].ndim > 1 and name != "wo"):
            continue
        # Move the argument toward the middle of its range. Change only the cosine of a direction.
        steps = np.where(columns[name] > 0.5, -STEP, STEP)
        if name == "wo":
            steps[:, :2] = 0.0
        changed = _expected(function, {**columns, name: columns[name] + steps})
        total = total + np.abs(changed - values).max(axis=1) / STEP
    return values, 1.0 / total[:, np.newaxis]


def arguments(function: str) -> list[str]:
    """Names of the columns of random numbers that are a function's arguments, in order."""
    parameters = functions.signature("glsl", function)
    return ["gray" if each == ("float", "rho") else each[1] for each in parameters]


POINTS = 4096  # number of points per function
CORNERS = 64  # number of points with arguments at the ends of their ranges

# Two directions along the normal (cosines 1 and 1 + 2^-23), two on the horizon, and one oblique.
AXES = tuple((x, 0.0, z) for x, z in ((0, 1), (0, 1 + 2.0**-23), (1, 0), (-1, 0), (0.6, 0.8)))

Columns = Mapping[str, Array]


# For each shader function whose NumPy version has another name or argument order, the version.
NAMED: Mapping[str, Callable[..., Array | tuple[Array, ...]]] = {
    "eon_around": sampling.around,
    "eon_azimuth_frame": lambda wo: sampling.stack_xyz(*sampling.azimuth_frame(wo)),
    "eon_gray_ratio": diffuse.eon_multiple_ratio,
    "eon_pdf": lambda wo, wi, rho, roughness: sampling.eon_pdf(wo, wi, roughness, rho=rho),
    "eon_rotate_z": sampling.rotate_z,
    "eon_sample": lambda wo, u, rho, roughness: sampling.eon_sample(wo, u, roughness, rho=rho),
    # The shader function is a fit. NumPy evaluates the exact integral for the cosine 1 - m.
    "eon_upper_root": lambda m: sampling.eon_upper_limit(1.0 - m, np.sqrt(m * (2.0 - m))),
    "oren_nayar_s": lambda wo, wi: diffuse.cosines(wo, wi)[2],
}
# Functions whose NumPy versions take color channels on the first axis.
CHANNELS_FIRST = re.compile(r"fon_lambert|eon_(denominator|multiple_ratio)|(qon|eon)_brdf_mu")


def _expected(function: str, columns: Columns) -> Array:
    """Values of a shader function in NumPy, (N, 1) or (N, 3)."""
    version = NAMED.get(function) or getattr(sampling, function, None) or getattr(diffuse, function)
    channels_first = CHANNELS_FIRST.fullmatch(function)
    names = arguments(function)
    inputs = [columns[name].T if channels_first else columns[name] for name in names]
    if function.endswith("_sample"):  # NumPy takes both random numbers as a single argument
        first = names.index("u1")
        inputs[first : first + 2] = [np.stack(inputs[first : first + 2], axis=-1)]
    values = version(*inputs)
    values = np.asarray(values[0] if isinstance(values, tuple) else values)
    return (values.T if channels_first else values).reshape(POINTS, -1)


@cache
def random_columns() -> Columns:
    """For each name of a parameter, random arguments that all functions share."""
    rng = generator()
    wo, wi = directions(rng, POINTS), directions(rng, POINTS)
    pairs = np.array(list(product(AXES, AXES)))
    wo[: len(pairs)], wi[: len(pairs)] = pairs[:, 0], pairs[:, 1]
    names = ("u1", "u2", "v", "q", "m", "t", "y_o", "gray", "roughness")
    unit = {name: _unit(rng) for name in names}
    azimuth, elevation = 2.0 * np.pi * rng.random(POINTS), 0.5 * np.pi * _unit(rng)
    mu, roughness = np.clip(wo[:, 2], GRAZING, 1.0), unit["roughness"]
    rho, value = np.stack([_unit(rng) for _ in range(3)], axis=-1), 2.0 * _unit(rng) - 1.0
    # A quarter of the divisors is log-uniform down to 1e-36, because shaders treat 1e-37 as 0.
    divisors = _unit(rng)
    divisors[CORNERS : POINTS // 4] = 10.0 ** (-36.0 * divisors[CORNERS : POINTS // 4])
    u1, u2 = unit["u1"], unit["u2"]
    # fmt: off
    columns = {
        **unit, "wo": wo, "wi": wi, "rho": rho, "mu": mu, "value": value, "divisor": divisors,
        "wh": sampling.around(np.sqrt(1.0 - u1), np.sqrt(u1), u2),
        "sigma": 1.5707963 * roughness, "d": sampling.ltc_md(mu, roughness),
        "mu_o": np.minimum(wo[:, 2], 1.0), "mu_i": np.minimum(wi[:, 2], 1.0),
        "s": diffuse.cosines(wo, wi)[2], "S": np.sqrt((1.0 - mu) * (1.0 + mu)),
        "S_o": np.hypot(wo[:, 0], wo[:, 1]), "S_i": np.hypot(wi[:, 0], wi[:, 1]),
        "cosine": np.cos(azimuth), "sine": np.sin(azimuth), "x": np.cos(elevation), "y": np.sin(elevation),
    }
    # fmt: on
    return {name: float32(values) for name, values in columns.items()}


def _unit(rng: np.random.Generator) -> Array:
    """Random multiples of 2^-24 in [0, 1). The first CORNERS numbers are 0 or 1 - 2^-24."""
    numbers = rng.integers(0, 1 << 24, POINTS).astype(np.float64)
    numbers[:CORNERS] = (numbers[:CORNERS] % 2.0) * (2.0**24 - 1.0)
    return numbers * 2.0**-24


@dataclass(frozen=True)
class FunctionProbe:
    """The shader functions of a library on a host."""

    host: Host
    library: str

    @cached_property
    def text(self) -> str:
        return functions.source(self.host.language, library=self.library)

    @cached_property
    def missing_functions(self) -> tuple[str, ...]:
        """Functions of eonlib that the library lacks or declares with different parameters."""
        library = functions.signatures(self.text)
        eonlib = functions.signatures(functions.source(self.host.language))
        return tuple(name for name in eonlib if library.get(name) != eonlib[name])

    @cached_property
    def values(self) -> Mapping[bool, Mapping[str, Array]]:
        """Values of the library's functions, for right (False) and for wrong (True) arguments."""
        return {False: self._values(1.0), True: self._values(0.95)}

    @cached_property
    def turn(self) -> tolerance.Term:
        """The error of the engine's cosine and sine for angles up to a full turn."""
        error = float(spec.TURN.errors(self.host, random_columns()["u2"]).max())
        words = "the engine's sine and cosine, which turn a direction twice"
        return tolerance.Term(4.0 * error, words)

    def tolerance(self, row: FunctionCheck) -> tolerance.Tolerance:
        return row.error.plus(self.turn) if row.turns else row.error

    def _values(self, scale: float) -> Mapping[str, Array]:
        """Values of all functions that the library and eonlib both define.

        The last argument of each function is multiplied by `scale`. The host is called once.
        """
        language, columns = self.host.language, random_columns()
        names = [name for name in functions.names(language) if name not in self.missing_functions]
        text = functions.dispatched(self.text, names, language)
        widths = {
            name: 1 if kind == "float" else 3
            for kind, name in functions.parameters(text, functions.EACH)
        }
        rows = {name: np.zeros((len(names), POINTS, width)) for name, width in widths.items()}
        for number, name in enumerate(names):
            rows["which"][number] = number
            slots = functions.slot_names([kind for kind, _ in functions.signature(language, name)])
            *others, last = (columns[each] for each in arguments(name))
            for slot, values in zip(slots, [*others, scale * last], strict=True):
                rows[slot][number] = values.reshape(POINTS, -1)
        shapes = {name: (-1,) if width == 1 else (-1, width) for name, width in widths.items()}
        inputs = (rows[name].reshape(shape) for name, shape in shapes.items())
        values = self.host.execute(text, functions.EACH, *inputs).astype(np.float64)
        return dict(zip(names, np.split(values, len(names)), strict=True))


def judge_functions(host: Host, library: str) -> tuple[Result, ...]:
    probe = FunctionProbe(host, library)
    return tuple(_judged(check, probe) for check in FUNCTION_CHECKS)


def _judged(check: FunctionCheck, probe: FunctionProbe) -> Result:
    names = check.key, check.claim, results.SHADER_FUNCTIONS, probe.host.name, probe.library
    place = Result(*names, results.NOT_RUN)
    try:
        limit = probe.tolerance(check)
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)

    def measure(wrong: bool) -> tolerance.Measurement:
        values = probe.values[wrong]
        errors = {name: _error(name, values[name]) for name in values}
        errors |= dict.fromkeys(probe.missing_functions, np.inf)
        name = max((each for each in errors if row_of(each) is check), key=errors.__getitem__)
        return tolerance.Measurement(errors[name], {name: [errors[name]]})

    words = "the last argument is 5 % off"
    return judge(place, limit, measure, words, lambda: Diagnosis(_causes(check, probe)))


def _causes(check: FunctionCheck, probe: FunctionProbe) -> tuple[Cause, ...]:
    """Missing functions, wrong functions with correct callees, and functions with wrong callees."""
    values = probe.values[False]
    errors = {name: _error(name, each) for name, each in values.items()}
    wrong = [name for name in errors if errors[name] > probe.tolerance(row_of(name)).value]
    uses = functions.uses(probe.text)
    affected = [name for name in wrong if row_of(name) is check]
    reached = {*affected}.union(*(uses[each] for each in affected))
    origins = [name for name in wrong if name in reached and uses[name].isdisjoint(wrong)]
    users = tuple(name for name in affected if name not in origins)
    causes = [Cause(Kind.DEFECT, "not_defined", (name,)) for name in probe.missing_functions]
    causes += [Cause(Kind.DEFECT, "function_off", (name,), (errors[name],)) for name in origins]
    if users:
        causes.append(Cause(Kind.DEFECT, "functions_that_use_it", users))
    return tuple(causes)
