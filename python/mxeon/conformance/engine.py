# SPDX-License-Identifier: Apache-2.0
"""Errors of an engine's own functions, measured on the host."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.conformance.samples import Array
from mxeon.conformance.tolerance import ROUNDING
from mxeon.hosts.base import Host

COUNT = 1 << 14  # arguments


@dataclass(frozen=True)
class EngineFunction:
    """A function that engines have themselves."""

    name: str  # in GLSL, of x or of x and y
    expression: str
    exact: Callable[..., Array]  # the same in NumPy

    def errors(self, host: Host, *arguments: Array) -> Array:
        """Errors of a host's values of arguments that are float32 numbers, (N,)."""
        function = f"mxeon_{self.name}"
        parameters = ", ".join(f"float {name}" for name in "xy"[: len(arguments)])
        text = f"float {function}({parameters})\n{{\n    return {self.expression};\n}}\n"
        values = host.execute(text, function, *arguments)[:, 0]
        return np.abs(values - self.exact(*arguments))


POWER = EngineFunction("power", "pow(x, y)", np.power)
EXPONENTIAL = EngineFunction("exponential", "exp(-x)", lambda x: np.exp(-x))
LOGARITHM = EngineFunction("logarithm", "log(x)", np.log)
WAVE = EngineFunction("wave", "max(cos(x), sin(x))", lambda x: np.maximum(np.cos(x), np.sin(x)))
TURN = EngineFunction(
    "turn",
    "max(abs(cos(6.28318530718 * x)), abs(sin(6.28318530718 * x)))",
    lambda x: np.maximum(np.abs(np.cos(2.0 * np.pi * x)), np.abs(np.sin(2.0 * np.pi * x))),
)


def beside_rounding(errors: Array, allowed: float = 1.0) -> float:
    """The largest error beyond so many roundings of 1."""
    return max(float(errors.max()) - allowed * ROUNDING, 0.0)
