# SPDX-License-Identifier: Apache-2.0
"""Numbers of a page that a script measures: each has the figure's name in a comment behind it.

0.11<!--color82-->       the figure of this name
5.7e-6<!--text-->        a number printed in the paper
"""

import re
from collections.abc import Callable, Mapping

MARK = re.compile(r"(-?\d+(?:\.\d+)?(?:e-?\d+)?)<!--([^>\n]+?)-->( %)?")
ROUNDING = 1e-3  # units of the last digit, by which libraries of sines part


def filled(text: str, figures: Callable[[], Mapping[str, float]]) -> str:
    """A page with its figures as they are measured, with the digits that they have there."""

    def number(found: re.Match[str]) -> str:
        return found[0].replace(found[1], _as_printed(_value(found, figures), found[1]), 1)

    return MARK.sub(lambda found: found[0] if found[2] == "text" else number(found), text)


def wrong(text: str, figures: Callable[[], Mapping[str, float]]) -> list[str]:
    """Marked numbers of a page that are not those measured here, rounded."""
    return [
        f"{found[0]} is {value:.6g}"
        for found in MARK.finditer(text)
        if found[2] != "text"
        for value in [_value(found, figures)]
        if abs(float(found[1]) - value) > (0.5 + ROUNDING) * _unit(found[1])
    ]


def _value(found: re.Match[str], figures: Callable[[], Mapping[str, float]]) -> float:
    return figures()[found[2]] * (100.0 if found[3] else 1.0)


def _as_printed(value: float, like: str) -> str:
    """A number with the digits of another one."""
    mantissa, _, power = like.partition("e")
    digits = len(mantissa.partition(".")[2])
    if power:
        number, _, exponent = f"{value:.{digits}e}".partition("e")
        return f"{number}e{int(exponent)}"
    unit = _unit(like)
    return f"{unit * round(value / unit):.{digits}f}"


def _unit(printed: str) -> float:
    """The unit of the last digit of a number; zeros at the end of an integer are no digits."""
    mantissa, _, power = printed.partition("e")
    zeros = 0 if "." in mantissa or power else len(mantissa) - len(mantissa.rstrip("0"))
    return float(10.0 ** (zeros - len(mantissa.partition(".")[2]) + int(power or 0)))
