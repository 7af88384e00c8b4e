# SPDX-License-Identifier: Apache-2.0
"""Every public function of the models, found by introspection, refuses bad arguments."""

import functools
import re
import warnings
from collections import defaultdict
from inspect import ismodule
from pathlib import Path
from pkgutil import resolve_name

import numpy as np
import pytest

from mxeon.models.core.arguments import RANGES
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.models.transmission import refraction_direction
from tests.fuzz import arguments

PAGES = Path(__file__).resolve().parents[2] / "docs" / "api"
# Functions on the API pages that do not accept arrays.
NO_ARRAYS = {"layer", "add", "model", "model_names"}


@pytest.fixture(scope="module")
def rows():
    """Rows of bad arguments by function, so that each function has its own test."""
    found = defaultdict(list)
    for row in arguments.rows():
        found[row[0]].append(row)
    return found


@pytest.mark.parametrize("name", arguments.functions())
def test_bad_arguments_are_refused_by_name_or_computed(name, rows):
    judged = [(row[1], arguments.BAD[row[2]], arguments.judged(row)[1]) for row in rows[name]]
    assert [fault for fault in judged if fault[-1]] == []


def test_the_least_number_above_zero_counts_as_zero():
    for function in arguments.functions().values():
        for name in arguments.tried(function, arrays=True):
            least, zero = (result(function, name, value) for value in (arguments.SMALLEST, 0.0))
            if least and zero and name != "thickness":  # the specified model jumps at 0
                for a, b in zip(least, zero, strict=True):
                    np.testing.assert_allclose(a, b, 1e-9, 1e-12, err_msg=f"{function} {name}")


def result(function, name, value):
    """The arrays that a function returns; an empty list if it refuses the value."""
    returned = []

    @functools.wraps(function)
    def kept(*values, **named):
        returned.append(function(*values, **named))
        return 0.0

    arguments.answer(kept, arguments.base(function) | {name: value})
    values = [getattr(each, "value", each) for each in returned]
    return [part for each in values for part in (each if isinstance(each, tuple) else (each,))]


def test_every_function_on_the_pages_is_tried():
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES.glob("*.md"))
    paths = re.findall(
        r"^::: (mxeon\.(?:models|albedo|inversion|sampling)[\w.]*\.[a-z]\w+)$", text, re.M
    )
    paths = [each for each in paths if ".surfaces." not in each]  # surfaces take a light and inputs
    names = {path.rpartition(".")[2] for path in paths if not ismodule(resolve_name(path))}
    tried = {name.rpartition(".")[2] for name in arguments.functions()}
    assert len(names) > 90
    assert names - NO_ARRAYS <= tried


def computed(function, values):
    """The arrays that a function returns, or "refused" if it raises an error."""
    try:
        with warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
            result = arguments.call(function, values)
    except ValueError:
        return "refused"
    if isinstance(result, arguments.Bsdf | arguments.SimpleNamespace):
        result = tuple(vars(result).values())
    parts = map(np.asarray, result if isinstance(result, tuple) else (result,))
    return [(each.dtype, each.tolist()) for each in parts]


@pytest.mark.parametrize("kind", (np.float16, np.float32, np.longdouble))
def test_every_function_computes_in_float64_whatever_the_type_of_its_arguments(kind):
    tried = 0
    for function in arguments.functions().values():
        base = arguments.base(function)
        for name in arguments.tried(function, arrays=True):
            if isinstance(base[name], int | float | tuple | np.ndarray):
                # If the type has more digits than float64, the value needs them.
                exact = np.asarray(base[name], np.longdouble) * (1.0 - np.longdouble(2.0) ** -57)
                value = exact.astype(kind)
                found = computed(function, base | {name: value})
                assert found == computed(function, base | {name: value.astype(np.float64)}), name
                tried += 1
    assert tried > 310


@pytest.mark.parametrize("roughness", (5e-324, 1e-320, 1e-300))
def test_conty_kulla_has_no_albedo_away_from_grazing_at_the_least_roughness(roughness):
    assert conty_kulla_albedo_dir(0.5, roughness) == 0.0


@pytest.mark.parametrize("ior", (5e-324, 1e-160, 1e-51))
def test_an_index_of_nothing_reflects_all(ior):
    assert not refraction_direction([0.0, 0.0, 1.0], [0.0, 0.0, 1.0], ior).any()


def test_a_quantity_without_a_range_is_refused():
    with pytest.raises(
        LookupError, match="'sparkle' must have a range in mxeon.models.core.arguments"
    ):
        RANGES["sparkle"]
