# SPDX-License-Identifier: Apache-2.0
"""Calls every public function of the models with bad values.

Introspection finds the functions that accept arrays. For a bad value, a function must return finite
results or raise a ValueError whose message starts with names of the function's arguments.
"""

import importlib
import inspect
import math
import pkgutil
import re
import warnings
from decimal import Decimal
from fractions import Fraction
from functools import cache
from itertools import combinations, product
from types import SimpleNamespace

import numpy as np

import mxeon.models
from mxeon.models.core.arguments import RANGES
from mxeon.models.core.arrays import ArrayLike
from mxeon.models.core.layering import Bsdf
from mxeon.models.microfacet import SCHLICK_CURVE, Lobe, uncompensated
from mxeon.models.microfacet.fresnel import schlick
from mxeon.models.thin_film import PRINTED

UP, LOW = (0.0, 0.6, 0.8), (0.0, 0.6, -0.8)
COLORS = {"color0": np.array([0.5]), "color82": np.array([0.5]), "color90": np.array([1.0])}
FILM = {"tint": np.ones(3), "ior": 1.5, "roughness": (0.5, 0.4), "thinfilm_thickness": 100.0}
PAIR, FIVE = (0.5, 0.4), np.array(5.0)
LOBE = Bsdf(np.array(0.5), np.array(0.5))

# Valid values by argument name. A function gets the first value that the function accepts. All
# other arguments keep their defaults, or get 0.5.
COLOR, BSDF = ((0.5, 0.4, 0.3),), (LOBE,)
VALID = {
    **dict.fromkeys(("wo", "wh", "normal"), ((0.6, 0.0, 0.8),)),
    "wi": (UP, LOW),
    "roughness": (0.5, PAIR),
    "u": (0.5, (0.5, 0.25)),
    **dict.fromkeys(("eumelanin_color", "pheomelanin_color", "hair_color"), COLOR),
    **dict.fromkeys(("ior", "specular_ior", "extinction", "exponent", "film_ior"), (1.5,)),
    "temperature": (500.0,),
    **dict.fromkeys(("fg", "bg", "in1"), BSDF),
    "form": (PRINTED,),
    "category": ("dielectric_bsdf",),
    "inputs": (FILM | {"thinfilm_ior": 1.4}, {"tint_R": 0.5}),
    "lobe": (Lobe(factor=uncompensated),),
    "compensate": (False,),  # compensation would be slow
    "curve": (SCHLICK_CURVE,),
    "at": (lambda cosine, ior, **colors: schlick(cosine, **colors),),
    "brdf": (lambda wo, wi, rho, *parameter: rho * wi[..., :1],),
    "nodes": (4,),
    "parameter": ((),),
    "vectors": (COLORS,),
    "numbers": ({"exponent": FIVE}, {"exponent": FIVE, "ior": np.array(1.5)}, {}),
}
# Prefixes of the names of private functions and of functions that check arguments.
CHECKS = ("_", "checked", "unpack")
PLUMBING = (
    "mxeon.models.core.arguments",
    "mxeon.models.catalog",
    *(f"mxeon.models.coat.{name}" for name in ("coat_of", "checked_", "mixed_", "varnish_of")),
    "mxeon.models.core.evaluation",
    "mxeon.models.microfacet.lobe_albedo",
    "mxeon.models.microfacet.node_",
    "mxeon.models.shading_model",
    "mxeon.models.surfaces",
)  # beginnings of full names of functions that are not tested
TAKEN = (bool, str, float, int)  # argument types that get bad values, in addition to arrays

ACCEPTED, REFUSED = 0, 2
SMALLEST, LEAST = math.ulp(0.0), np.finfo(np.float64).tiny
# Bad values for arguments. Most arguments accept only a few of these values.
BAD = (
    None, True, False, "x", "", "0.5", b"x", {}, [], (), {0.5}, print, Decimal("0.5"),
    Fraction(1, 2), 1j, math.nan, math.inf, -math.inf, SMALLEST, 1e-320, LEAST, -SMALLEST, -0.0, 0.0,
    1e-160, 1e160, 1.7e308, -1.0, 2.0, 10**400, np.ma.masked, [[0.5], [0.5, 0.5]], [None],
    np.zeros((0, 3)), np.full(7, 0.5), np.full((5, 7), 0.5), np.full(3, math.nan),
    np.datetime64(0, "s"), np.float16(math.inf), np.str_("0.5"),
)  # fmt: skip


@cache
def functions():
    """Public functions of the models that accept arrays, by full name."""
    return {
        f"{module.__name__}.{name}": each
        for module in modules()
        for name, each in vars(module).items()
        if not f"{module.__name__}.{name}".startswith(PLUMBING)
        if inspect.isfunction(each) and each.__module__ == module.__name__
        if not name.startswith(CHECKS) and any(map(_is_array, _parameters(each).values()))
    }


def modules():
    package = mxeon.models
    names = (each.name for each in pkgutil.walk_packages(package.__path__, f"{package.__name__}."))
    return [package, *map(importlib.import_module, names)]


def rows():
    """Test cases: function, argument, index in BAD, and whether to replace only one element."""
    for name, function in functions().items():
        for argument in tried(function):
            first = _part(base(function), argument)
            for place, inside in product(range(len(BAD)), (False, True)):
                if not inside or (np.ndim(first) and isinstance(BAD[place], float)):
                    yield name, argument, place, inside
        for pair in combinations(tried(function, arrays=True), 2):
            yield name, pair, 0, False


def tried(function, arrays=False):
    """Names of the arguments that get bad values: arrays, numbers, switches and choices.

    For a mapping, each name ends with a dot and a key.
    """
    for name, each in _parameters(function).items():
        if _is_array(each) or (not arrays and each.annotation in TAKEN):
            yield name
        elif name == "inputs" and not arrays:
            yield from (f"{name}.{key}" for key in base(function)[name])


def judged(row):
    """Call the function of a test case. Return ACCEPTED or REFUSED, and the fault or ""."""
    name, argument, place, inside = row
    function = functions()[name]
    values = dict(base(function))
    if isinstance(argument, tuple):
        for each, count in zip(argument, (2, 3), strict=True):
            values[each] = np.tile(values[each], (count, *(1,) * np.ndim(values[each])))
    else:
        first = _part(values, argument)
        value = _inside(first, BAD[place]) if inside else BAD[place]
        name, _, key = argument.partition(".")
        values[name] = values[name] | {key: value} if key else value
    return answer(function, values)


def _part(values, argument):
    """Value of an argument, or the value of a mapping's key if `argument` is `name.key`."""
    name, _, key = argument.partition(".")
    return values[name][key] if key else values[name]


def answer(function, values):
    """Call a function. Return ACCEPTED or REFUSED, and a description of the fault or ""."""
    parameters = _parameters(function)
    more = [name for name, each in parameters.items() if each.kind is each.VAR_KEYWORD]
    try:
        with warnings.catch_warnings(action="error"), np.errstate(under="ignore"):
            result = call(function, values)
    except ValueError as error:
        first = str(error).split(" must ")[0].split(", ")
        if str(error).endswith("; give equal counts, or one"):
            first = re.findall(r"(\S+) has [\dx ]+ (?:rows|values)", str(error))
        names = set(parameters).union(*(each for each in values.values() if isinstance(each, dict)))
        names |= set(RANGES) if more or "inputs" in parameters else set()
        return REFUSED, "" if set(first) <= names else f"says {error}"
    except Exception as error:
        return REFUSED, f"raises {type(error).__name__}: {error}"
    return ACCEPTED, "" if _is_finite(result) else f"returns {result}"


def call(function, values):
    """Call a function with arguments by name, including arguments that are positional-only."""
    parameters = _parameters(function)
    more = [name for name, each in parameters.items() if each.kind is each.VAR_KEYWORD]
    named = {name: value for name, value in values.items() if name not in more}
    places = [named.pop(n) for n, each in parameters.items() if each.kind < each.VAR_POSITIONAL]
    places += [e for n, p in parameters.items() if p.kind is p.VAR_POSITIONAL for e in named.pop(n)]
    return function(*places, **named, **(values[more[0]] if more else {}))


@cache
def base(function):
    parameters, reasons = _parameters(function), []
    for chosen in product(*map(_valid, parameters.values())):
        values = dict(zip(parameters, chosen, strict=True))
        if (outcome := answer(function, values)) == (ACCEPTED, ""):
            return values
        reasons.append(outcome)
    raise LookupError(f"{function.__name__} takes none of the valid arguments: {reasons}")


@cache
def _parameters(function):
    return inspect.signature(function, eval_str=True).parameters


def _valid(parameter):
    default = parameter.default
    if default is parameter.empty:
        default = True if parameter.annotation is bool else 0.5
    return VALID.get(parameter.name, (default,))


def _is_array(parameter):
    return parameter.annotation == ArrayLike and parameter.kind < parameter.VAR_POSITIONAL


def _inside(valid, value):
    """Copy of a valid array whose first element is replaced by `value`."""
    array = np.array(valid)
    array[0] = value
    return array


def _is_finite(result):
    parts = result if isinstance(result, tuple) else (result,)
    if isinstance(result, (Bsdf, SimpleNamespace)):
        parts = vars(result).values()
    arrays = [np.asarray(part) for part in parts]
    return all(array.dtype == np.float64 and np.isfinite(array).all() for array in arrays)
