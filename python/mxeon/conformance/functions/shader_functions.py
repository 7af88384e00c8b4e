# SPDX-License-Identifier: Apache-2.0
"""Checks of the shader functions of a library, each against the NumPy one, on a host.

The host compiles one program for all of them, with one function more that calls each by its number.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np

from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.diagnosis.verdicts import judge, not_measured
from mxeon.conformance.engine import TURN
from mxeon.conformance.functions.numpy_functions import (
    POINTS,
    argument_names,
    moved,
    numbers,
    random_columns,
)
from mxeon.conformance.functions.numpy_functions import expected as expected_values
from mxeon.conformance.results import SHADER_FUNCTIONS, Place, Result
from mxeon.conformance.samples import Array
from mxeon.conformance.specs.diffuse import LOSS_FIT
from mxeon.conformance.specs.diffuse import VALUE as MODEL_VALUE
from mxeon.conformance.tolerance import (
    Measurement,
    Term,
    Tolerance,
    absolute,
    relative,
    roundings,
    sum_of,
)
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts.base import Host
from mxeon.shaders import functions

KINDS = ("pairs", "pictures", "rendered")  # of probes whose hosts evaluate functions
ROTATIONS = ("eon_around", "eon_azimuth_frame", "eon_rotate_z", "eon_towards")
SAMPLES = re.compile(rf"\w+_(sample|draw|clipped|transformed)|{'|'.join(ROTATIONS)}")
DENSITIES = re.compile(r"\w+_pdf|ltc_(density|[abcd])")
STEP = 2.0**-22  # of the arguments by which a function's condition is measured

CONDITIONED = "over 1, the value, and its change with each argument"
LOSS = sum_of(Term(LOSS_FIT, "the fit of H"), roundings(12), unit="relative", metric=relative)
PART = sum_of(roundings(16), unit=CONDITIONED, metric=absolute)
# An inverse fourth power takes the 8 of an entry of a matrix four times, and 16 beside them.
DENSITY = sum_of(
    roundings(48, "four times the 8 of a matrix entry, and 16"), unit=CONDITIONED, metric=absolute
)


def _direction(sine_error: float) -> Tolerance:
    """Tolerance of sampled directions on an engine whose own sine is off by so much."""
    turned = Term(4.0 * sine_error, "the engine's sine and cosine, which turn a direction twice")
    return sum_of(roundings(16), turned, unit=CONDITIONED, metric=absolute)


@dataclass(frozen=True)
class FunctionProbe:
    """The shader functions of a library, which brings such functions, on a host."""

    host: Host
    library: str

    @cached_property
    def text(self) -> str:
        return functions.source(self.host.language, library=self.library)

    @cached_property
    def missing_functions(self) -> tuple[str, ...]:
        """Functions of eonlib that the library lacks, or has with other parameters."""
        own = functions.signatures(self.text)
        ours = functions.signatures(functions.source(self.host.language))
        return tuple(name for name in ours if own.get(name) != ours[name])

    @cached_property
    def values(self) -> Mapping[str, Array]:
        """Values of every function of eonlib that the library has."""
        return self.scaled_values(1.0)

    @cached_property
    def wrong_values(self) -> Mapping[str, Array]:
        return self.scaled_values(0.95)

    @cached_property
    def sine_error(self) -> float:
        """Error of the engine's own cosine and sine over a turn, of which samples are made."""
        return float(TURN.errors(self.host, random_columns()["u2"]).max())

    def scaled_values(self, scale: float) -> Mapping[str, Array]:
        """Values of the functions whose last argument is scaled, in one call; each has POINTS rows."""
        language, columns = self.host.language, random_columns()
        names = [name for name in functions.names(language) if name not in self.missing_functions]
        text = functions.dispatched(self.text, names, language)
        slots = functions.parameters(text, functions.EACH)
        rows = {
            name: np.zeros((len(names), POINTS, 1 if kind == "float" else 3))
            for kind, name in slots
        }
        for number, name in enumerate(names):
            rows["which"][number] = number
            own = functions.slot_names([kind for kind, _ in functions.signature(language, name)])
            *others, last = (columns[each] for each in argument_names(name))
            for slot, values in zip(own, [*others, scale * last], strict=True):
                rows[slot][number] = values.reshape(POINTS, -1)
        given = [
            rows[name].reshape(-1, 3) if kind != "float" else rows[name].ravel()
            for kind, name in slots
        ]
        values = self.host.execute(text, functions.EACH, *given).astype(np.float64)
        return dict(zip(names, np.split(values, len(names)), strict=True))


@dataclass(frozen=True)
class FunctionCheck:
    """A row of the table: what is asked of some of the shader functions."""

    key: str  # one word, and a sentence
    claim: str
    holds: Callable[[str], bool]  # whether it asks a function; the first row that does takes it
    error: Callable[[str, Array], float]  # largest error of a function's values
    tolerance: Callable[[FunctionProbe], Tolerance]


def value_error(function: str, values: Array) -> float:
    """Largest error of a model, in pi f cos, or of an albedo."""
    columns = random_columns()
    scale = np.pi * columns["mu_i"][:, None] if "_brdf" in function else 1.0
    return float(absolute(scale * (values - _expected(function)), 0.0).max())


def loss_error(function: str, values: Array) -> float:
    """Largest relative error."""
    return float(relative(values, _expected(function)).max())


def part_error(function: str, values: Array) -> float:
    """Largest error, over 1, the value, and the change that a change of an argument makes."""
    error = absolute(values - _expected(function), 0.0)
    return float((error / _condition(function)).max())


FUNCTION_CHECKS = (
    FunctionCheck(
        "twins",
        "The shader functions of models and albedos match the NumPy models.",
        lambda name: "_brdf" in name or "_albedo_" in name,
        value_error,
        lambda probe: MODEL_VALUE,
    ),
    FunctionCheck(
        "loss",
        "1 - E keeps its relative accuracy down to a cosine of 1e-6.",
        lambda name: name == "fon_loss",
        loss_error,
        lambda probe: LOSS,
    ),
    FunctionCheck(
        "samples",
        "The sampling functions return the same directions as NumPy's.",
        lambda name: bool(SAMPLES.fullmatch(name)),
        part_error,
        lambda probe: _direction(probe.sine_error),
    ),
    FunctionCheck(
        "densities",
        "The sampling densities and the matrix of linearly transformed cosines match NumPy's.",
        lambda name: bool(DENSITIES.fullmatch(name)),
        part_error,
        lambda probe: DENSITY,
    ),
    FunctionCheck(
        "parts",
        "The functions that models and sampling are built from match NumPy's.",
        lambda name: True,
        part_error,
        lambda probe: PART,
    ),
)
VARIANT = "the last argument is 5 % off"


def row_of(function: str) -> FunctionCheck:
    return next(row for row in FUNCTION_CHECKS if row.holds(function))


def judge_functions(probe: FunctionProbe) -> tuple[Result, ...]:
    return tuple(_judged(check, probe) for check in FUNCTION_CHECKS)


def _judged(check: FunctionCheck, probe: FunctionProbe) -> Result:
    host, library = probe.host.name, probe.library
    place = Place(
        check=check.key, claim=check.claim, subject=SHADER_FUNCTIONS, host=host, library=library
    )
    try:
        tolerance = check.tolerance(probe)
    except (NotRun, ShaderError) as error:
        return not_measured(place, error)

    def measure(wrong: bool) -> Measurement:
        """The function of the row that is furthest from its NumPy version."""
        values = probe.wrong_values if wrong else probe.values
        errors = {
            name: check.error(name, each) for name, each in values.items() if row_of(name) is check
        }
        errors |= {name: np.inf for name in probe.missing_functions if row_of(name) is check}
        name = max(errors, key=lambda function: errors[function])
        return Measurement(errors[name], {name: [errors[name]]})

    return judge(place, tolerance, measure, VARIANT, lambda: Diagnosis(_causes(check, probe)))


def _causes(check: FunctionCheck, probe: FunctionProbe) -> str:
    """The functions that are wrong by themselves, and those of the row that use them."""
    errors = {name: row_of(name).error(name, values) for name, values in probe.values.items()}
    wrong = [name for name in errors if errors[name] > row_of(name).tolerance(probe).value]
    uses = functions.uses(probe.text)
    causes = [name for name in wrong if not any(other in wrong for other in uses[name])]
    affected = [name for name in wrong if row_of(name) is check]
    reached = {*affected}.union(*(uses[each] for each in affected))
    own = [name for name in causes if name in reached]
    users = [name for name in affected if name not in own]
    parts = [f"{name} is not defined as eonlib has it" for name in probe.missing_functions]
    parts += [f"{name} is off by {errors[name]:.2g}" for name in own]
    parts += [f"with it {', '.join(users)}"] if users else []
    return "; ".join(parts)


@cache
def _expected(function: str) -> Array:
    return expected_values(function, random_columns())


@cache
def _condition(function: str) -> Array:
    """1, or the value if larger, and by how much it changes with each of its numbers, (N,)."""
    columns, exact = random_columns(), _expected(function)
    total: Array = np.maximum(1.0, np.abs(exact).max(axis=1))
    for name in numbers(function):
        change = expected_values(function, moved(columns, name, STEP)) - exact
        total = total + np.abs(change).max(axis=1) / STEP
    return np.asarray(total)
