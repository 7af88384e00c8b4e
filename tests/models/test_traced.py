# SPDX-License-Identifier: Apache-2.0
"""Functions of every model under transformations of PyTorch and JAX.

The tests cover all functions of all models. At the ends of input ranges, no operation returns NaN,
and gradients are finite, also in float32. Inside the ranges, gradients match finite differences of NumPy's values.
`vmap`, `jit` and `compile` return NumPy's values.
"""

from contextlib import nullcontext
from functools import partial
from itertools import product

import numpy as np
import pytest

import mxeon
from mxeon.models import hair, model_names
from mxeon.models.core.arguments import RANGES
from tests.support.availability import package
from tests.support.cases import direction
from tests.support.tracing import untraced

SEED, ROWS = 5, 3
STEP, SLOPE = 1e-5, 3e-5  # step of central differences, and error near a kink
VALUE = 1e-11  # absolute and relative tolerance for values
# INSIDE has ranges of random inputs (default: [0.3, 0.7]). ENDS has ends of ranges (0 and 1).
INSIDE = {"ior": (1.2, 2.0), "extinction": (1.0, 3.0), "thinfilm_thickness": (200.0, 900.0)}
INSIDE |= {"thinfilm_ior": (1.2, 1.9), "exponent": (2.0, 6.0), "coat_ior": (1.2, 2.0)}
INSIDE |= dict.fromkeys(hair.ROUGHNESSES, (0.1, 0.6))
ENDS = {"ior": (0.0, 1.0, 0.5, 2.0, 1.0), "extinction": (0.0, 3.0), "exponent": (1.0, 5.0)}
ENDS |= {"thinfilm_thickness": (1.0, 900.0)}  # a thickness of 0 has a different formula
# Smallest values inside the ranges that float32 can represent.
ENDS |= {"radius": (1e-30, 1.0), **dict.fromkeys(hair.ROUGHNESSES, (1.01e-12, 1.0))}
FUNCTIONS = [
    (name, function)
    for name in model_names()
    for function in mxeon.model(name).functions
    if function != "brdf"  # `brdf` is another name of `bsdf`
]
# JAX takes seconds to trace films. test_arrays.py covers the curves of films.
TRACED = [row for row in FUNCTIONS if row[0] not in ("conductor_film", "schlick_film")]


def vectors(row, function, ends=False):
    """Arguments that precede the inputs. If `ends` is true, views include normal and horizon."""
    rng, mu = np.random.default_rng(SEED), np.array([1.0, 0.0, 0.6] if ends else [0.7, 0.3, 0.9])
    wo = direction(mu, [0.0, 0.3, 2.0])
    wi = np.roll(wo, 1, axis=0) * (-1.0, 1.0, 1.0)
    wi[:, 2] *= -1.0 if row.lights == "back" else 1.0
    u = rng.uniform(0.2, 0.8, (ROWS, 2))
    given = {"bsdf": (wo, wi), "pdf": (wo, wi), "sample": (wo, u), "albedo_avg": ()}
    return given.get(function, (mu,))


def one_for_all(parameter):
    """Whether an input must have a single value for all rows."""
    return parameter.quantity.startswith("coat_")


def inside(row):
    """Random inputs, away from the ends of their ranges. Most inputs have one value per row."""
    rng, inputs = np.random.default_rng(SEED), {}
    for each in row.parameters:
        shape = (*(ROWS,) * (not one_for_all(each)), *(each.channels,) * bool(each.channels))
        inputs[each.name] = rng.uniform(*INSIDE.get(each.quantity, (0.3, 0.7)), shape)
    return inputs


def at_ends(row, function):
    """Calls with all inputs at an end of their ranges.

    If inputs may differ between rows, the call also contains rows with one input at an end.
    """
    middle, ends = inside(row), {}
    for each in row.parameters:
        low, high, _ = RANGES[each.quantity]
        found = ENDS.get(each.quantity, (max(low, -1.0), min(high, 1.0)))
        ends[each.name] = [np.full_like(middle[each.name], end) for end in found]
    given, count = vectors(row, function, ends=True), max(map(len, ends.values()))
    corners = [{name: each[k % len(each)] for name, each in ends.items()} for k in range(count)]
    if any(map(one_for_all, row.parameters)):
        return [(given, corner) for corner in corners]
    cases = [*corners, *(middle | {name: c[name]} for c in corners for name in c)]
    tiled = [np.tile(each, (len(cases), *(1,) * (each.ndim - 1))) for each in given]
    return [(tiled, {name: np.concatenate([each[name] for each in cases]) for name in middle})]


def numbers(result):
    """The result as an array, or only the density if the result is a sample."""
    return result[1] if isinstance(result, tuple) else result


def no_nan(torch):
    """Context in which PyTorch stops at the first NaN, even if the result is not used."""
    from torch.utils._python_dispatch import TorchDispatchMode

    class NoNan(TorchDispatchMode):
        def __torch_dispatch__(self, step, types, args=(), kwargs=None):
            result = step(*args, **(kwargs or {}))
            parts = result if isinstance(result, tuple | list) else (result,)
            assert not any(torch.is_tensor(each) and each.isnan().any() for each in parts), step
            return result

    return NoNan()


def assert_slopes(function, inputs, found):
    """Compare the gradient of the summed result with finite differences of each component."""
    for name, gradient in found.items():
        array, rowwise = inputs[name], len(np.shape(inputs[name])) > 0
        for index in np.ndindex(array.shape[1:] if rowwise else ()):
            place, ends = (slice(None), *index) if rowwise else (), []
            for step in (STEP, -STEP):
                moved = np.array(array)
                moved[place] += step
                value = numbers(function(**inputs | {name: moved}))
                ends.append(value.reshape(ROWS, -1).sum(axis=1) if rowwise else value.sum())
            slope = (ends[0] - ends[1]) / (2.0 * STEP)
            np.testing.assert_allclose(gradient[place], slope, SLOPE, SLOPE, err_msg=name)


@pytest.mark.parametrize(("name", "function"), FUNCTIONS)
def test_torch_differentiates_and_maps_every_function_of_every_model(name, function):
    torch = package("torch")
    row = mxeon.model(name)
    model = getattr(row, function)

    def gradients(given, inputs, steps=None):
        tensors = {key: torch.tensor(each, requires_grad=True) for key, each in inputs.items()}
        with steps or nullcontext():
            value = numbers(model(*map(torch.tensor, given), **tensors))
        if value.requires_grad:
            value.sum().backward()
        none = {key: np.zeros(np.shape(each)) for key, each in inputs.items()}
        found = {k: none[k] if t.grad is None else t.grad.numpy() for k, t in tensors.items()}
        return value.detach().numpy(), found

    # Inside the ranges, values and slopes match the results of NumPy.
    given, inputs = vectors(row, function), inside(row)
    value, found = gradients(given, inputs)
    np.testing.assert_allclose(value, numbers(model(*given, **inputs)), VALUE, VALUE)
    assert_slopes(partial(model, *given), inputs, found)
    # At the ends of the ranges, results are finite in both precisions, and NumPy does not warn.
    for (given_there, inputs_there), kind in product(at_ends(row, function), (float, np.float32)):
        given_there = [each.astype(kind) for each in given_there]
        inputs_there = {key: each.astype(kind) for key, each in inputs_there.items()}
        value_there, slopes = gradients(given_there, inputs_there, no_nan(torch))
        plain = numbers(model(*given_there, **inputs_there))
        assert all(np.isfinite(each).all() for each in (value_there, plain, *slopes.values()))
    # vmap over the rows returns the same values as a call with all rows.
    if given and not any(map(one_for_all, row.parameters)):
        arrays = [torch.tensor(each) for each in (*given, *inputs.values())]
        count = len(given)
        mapped = torch.func.vmap(lambda *a: numbers(model(*a[:count], *a[count:])))(*arrays)
        np.testing.assert_allclose(mapped.numpy(), value, VALUE, VALUE)


@pytest.mark.whole
@pytest.mark.parametrize(("name", "function"), TRACED)
def test_jax_traces_derivatives_of_every_function_of_a_model(name, function):
    """JAX traces the functions without compilation, which would take minutes.

    Forward mode takes a third of the time of reverse mode.
    """
    jax = package("jax")
    jax.config.update("jax_enable_x64", True)
    row = mxeon.model(name)
    given, inputs = vectors(row, function), inside(row)
    axes = {each.name: None if one_for_all(each) else 0 for each in row.parameters}

    def change(given, inputs):
        """Summed result, and the sum's derivative when all inputs are scaled by a common factor."""
        model = partial(getattr(row, function), *given)
        return jax.jvp(lambda inputs: numbers(model(**inputs)).sum(), (inputs,), (inputs,))

    with untraced():  # JAX runs the same lines of the models as PyTorch
        found = jax.eval_shape(jax.vmap(change, in_axes=(0, axes)), given, inputs)
    assert [each.shape for each in found] == [(ROWS,)] * 2


def test_a_gradient_of_jax_needs_no_array_and_no_context():
    jax = package("jax")
    row, pair = mxeon.model("eon"), ([0.6, 0.0, 0.8], [0.0, 0.6, 0.8])
    slope = jax.grad(lambda r: row.brdf(*pair, [0.7, 0.35, 0.12], r).sum())(0.5)
    ends = [row.brdf(*pair, [0.7, 0.35, 0.12], 0.5 + h).sum() for h in (STEP, -STEP)]
    assert float(slope) == pytest.approx((ends[0] - ends[1]) / (2.0 * STEP), rel=1e-3)


@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::DeprecationWarning")
def test_torch_compiles_a_model():
    torch = package("torch")
    row = mxeon.model("eon")
    wo, wi = map(torch.tensor, vectors(row, "bsdf"))
    compiled = torch.compile(lambda r: row.brdf(wo, wi, 0.5, r), backend="eager")
    r = torch.tensor(0.4, dtype=torch.float64)
    assert torch.allclose(compiled(r), row.brdf(wo, wi, 0.5, r))
