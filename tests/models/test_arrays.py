# SPDX-License-Identifier: Apache-2.0
"""Values and gradients of every function that accepts PyTorch or JAX arrays.

Tests are skipped if the library is not installed. Gradients are compared with finite differences of
the same function wherever the differences are reliable.
"""

import inspect
import re
from contextlib import nullcontext
from functools import lru_cache, partial, wraps
from types import SimpleNamespace

import numpy as np
import pytest

import mxeon
from mxeon.models import eon_brdf, fon_albedo_dir, fon_loss, lambert_brdf, smith_g1
from mxeon.models.core import arrays as edges
from mxeon.models.core.arguments import RANGES
from mxeon.models.core.arrays import NUMPY, ArrayLike, array_namespace
from mxeon.models.sampling import eon_sample
from mxeon.models.thin_film import PRINTED, film_reflectance
from tests.fuzz import arguments
from tests.support.availability import package
from tests.support.tracing import untraced
from tools.site import arrays as table

TINTS = ("rho", "color", "tint", "radiance", "base", "absorption", "scattering")
TINTS += ("emission", "scattered", "behind")
COLORS = {"color0", "color82", "color90", "ior", "extinction", *TINTS}
# Functions whose names contain one of these words take a roughness with two components.
PAIRS = ("microfacet", "ggx_", "btdf", "transmittance_dir")
INTERFACES = "dielectric_over_eon", "varnished"
ROWS, FEW = 48, 4
# Functions whose names have these endings sum thousands of quadrature nodes per row.
FACETS = ("dielectric_albedo_dir", "conductor_albedo_dir", "schlick_albedo_dir")
QUADRATURES = (*FACETS, "film_albedo_dir", "transmittance_dir", "ggx_albedo_dir_anisotropic")
QUADRATURES += ("conty_kulla_albedo_dir",)
# JAX takes seconds to compile these functions, so tests with JAX use only the functions' parts.
LONG = ("chiang_hair_bcsdf", "film_albedo_dir", "dielectric_albedo_dir", "conty_kulla_albedo_dir")
LONG += ("transmittance_dir",)
ENDS = ("brdf", "albedo_dir", "sample", "pdf")
LONG += tuple(f"{name}_{end}" for name in INTERFACES for end in ENDS)
SEED = 11
GRADIENT = 1e-7  # error of finite differences, divided by the larger of 1 and the gradient
WIDTH = 1e-4  # step of the finite differences
# Offsets as multiples of WIDTH: three single steps and three double steps on each side.
OFFSETS = (-6, -4, -3, -2, -1, 0, 1, 2, 3, 4, 6)
RELIABLE = 2e-8  # largest difference of a reliable derivative between both step widths
COMPARED = 0.6  # minimum fraction of partial derivatives that must be compared
# Two functions have a smaller minimum fraction. The curve of a film is clamped at thousands of
# nodes, which causes kinks. In `diffusion_blur`, a root amplifies the rounding of differences.
CUT = {"film_albedo_dir": 0.3, "diffusion_blur": 0.0}
NOISE = {"diffusion_blur": 2e-8}  # root of a difference with an error of 2^-53
VALUE = 1e-12  # difference between libraries, divided by the larger of 1 and the value


def has_mapping(function):
    """Whether a function takes all its inputs as one mapping."""
    each = inspect.signature(function).parameters.get("inputs")
    return each is not None and each.kind is each.POSITIONAL_OR_KEYWORD


def named(function):
    """Function that takes each key of the mapping `inputs` as a separate argument."""
    parameters = inspect.signature(function).parameters
    if not has_mapping(function):
        return function

    @wraps(function)
    def call(**values):
        inputs = {name: values.pop(name) for name in set(values) - set(parameters)}
        return function(**values, inputs=inputs)

    return call


DOCUMENTED = set(table.public().values())
PORTABLE = {
    name: named(function)
    for name, function in arguments.functions().items()
    # Other tests cover the wrong variants of models, and quadratures that take a function.
    if inspect.unwrap(function) is not function
    and function in DOCUMENTED
    and "core.quadrature" not in name
}


# `film_reflectance` for two kinds of substrates, with separate arguments like other functions.
def film_conductor(
    mu: "ArrayLike",
    thickness: "ArrayLike",
    film_ior: "ArrayLike",
    ior: "ArrayLike",
    extinction: "ArrayLike",
):
    film = {"thinfilm_thickness": thickness, "thinfilm_ior": film_ior}
    inputs = {"ior": ior, "extinction": extinction, **film}
    return film_reflectance("conductor_bsdf", mu, inputs, PRINTED)


def film_schlick(
    mu: "ArrayLike",
    thickness: "ArrayLike",
    film_ior: "ArrayLike",
    color0: "ArrayLike",
    color82: "ArrayLike",
    color90: "ArrayLike",
    exponent: "ArrayLike",
):
    film = {"thinfilm_thickness": thickness, "thinfilm_ior": film_ior}
    curve = {"color0": color0, "color82": color82, "color90": color90, "exponent": exponent}
    return film_reflectance("generalized_schlick_bsdf", mu, curve | film, PRINTED)


PORTABLE |= {each.__name__: each for each in (film_conductor, film_schlick)}
COMPENSATED = ("dielectric_brdf", "conductor_brdf", "generalized_schlick_brdf")
# Ends of tested ranges. These inputs are unbounded, or have an infinite slope at a limit.
LOW = dict.fromkeys(("eumelanin_color", "pheomelanin_color", "hair_color"), 0.05)
LOW |= dict.fromkeys(("separation", "radius", "reach"), 0.2)
LOW |= {"temperature": 500.0, "melanin_concentration": 0.0}
HIGH = {"temperature": 9000.0, "melanin_concentration": 0.9, "scatter_anisotropy": 0.95}
HIGH |= {"exponent": 8.0} | dict.fromkeys(("u", "g", "reflectivity"), 0.99)
HIGH |= dict.fromkeys(("emission", "scattered", "behind", "intensity", "exposure", "albedo"), 3.0)
HIGH |= dict.fromkeys(("absorption_coefficient", "phi", "ior"), 3.0)
HIGH |= dict.fromkeys(("separation", "radius", "reach", "scale_tt", "scale_trt"), 2.0)
HIGH |= dict.fromkeys(("extinction", "radiance", "base", "absorption"), 4.0)
HIGH |= dict.fromkeys(("scattering", "distance"), 4.0)
HIGH |= dict.fromkeys(("variance", "scale"), 1.0) | dict.fromkeys(("film_ior", "thinfilm_ior"), 2.5)
HIGH |= dict.fromkeys(("thickness", "thinfilm_thickness"), 900.0)


def pytorch():
    torch = package("torch")
    package("array_api_compat")

    def gradients(function, values):
        tensors = {k: torch.tensor(v, requires_grad=True) for k, v in values.items()}
        value = function(**tensors)
        scalar(value).sum().backward()
        found = {name: np.zeros_like(array) for name, array in values.items()}
        found |= {name: t.grad.numpy() for name, t in tensors.items() if t.grad is not None}
        return whole(value).detach().numpy(), found

    return SimpleNamespace(
        array=lambda x: torch.tensor(np.asarray(x)),
        numpy=lambda x: x.detach().numpy(),
        gradients=gradients,
        transforms=(torch.vmap,),
        grad=torch.func.grad,
    )


def jax():
    library = package("jax")
    library.config.update("jax_enable_x64", True)
    # The options make compilation fast. Emitters of fused loops would take twice as long as all
    # other steps. Shared code is compiled only once if modules are not split.
    library.config.update("jax_disable_most_optimizations", True)
    options = {"xla_cpu_use_fusion_emitters": False, "xla_cpu_parallel_codegen_split_count": 1}
    jit = partial(library.jit, compiler_options=options)

    def gradients(function, values):
        def loss(arrays):
            value = function(**arrays)
            return scalar(value).sum(), whole(value)

        found, value = jit(library.grad(loss, has_aux=True))(values)
        return np.asarray(value), {k: np.asarray(v) for k, v in found.items()}

    return SimpleNamespace(
        array=library.numpy.asarray,
        numpy=np.asarray,
        gradients=gradients,
        transforms=(jit, lambda f: jit(library.vmap(f))),
        grad=library.grad,
    )


@pytest.fixture(params=[pytorch, jax])
def library(request):
    return request.param()


def count(function):
    """Number of random rows of arguments with which a function is tested."""
    return FEW if function.__name__.endswith(QUADRATURES) else ROWS


def directions(rng, below, rows=ROWS):
    """Random unit vectors. Some vectors are the normal, and some are grazing."""
    w = rng.normal(size=(rows, 3))
    w[: max(rows // 12, 1)] = 0.0, 0.0, 1.0
    w[max(rows // 12, 1) : max(rows // 4, 2), 2] = 0.0
    w[:, 2] = np.abs(w[:, 2])
    w /= np.linalg.norm(w, axis=1, keepdims=True)
    return rng.permutation(w) * (1.0, 1.0, -1.0 if below else 1.0)


def sampled(function):
    """A mapping with random array arguments, and a mapping with the other arguments."""
    rng, arrays, switches, rows = np.random.default_rng(SEED), {}, {}, count(function)
    values, names = dict(arguments.base(inspect.unwrap(function))), table.arrays(function)
    if has_mapping(function):
        names = [*names, *values["inputs"]]
        values |= values.pop("inputs")
    for name, value in values.items():
        is_array = isinstance(value, float | tuple | np.ndarray) and name in names
        if not is_array or name == "light":
            switches[name] = value  # one value for all rows
        elif np.shape(value) == (3,) and name[0] in "wn":
            arrays[name] = directions(rng, value[2] < 0.0, rows)
        else:
            low, high, _ = RANGES[name]
            place = f"{function.__module__}.{function.__name__}"
            pairs = name == "roughness" and any(each in place for each in PAIRS)
            pairs &= "anisotropy" not in place
            low = LOW.get(name, max(low, -HIGH.get(name, np.inf)))
            high, shape = HIGH.get(name, high), (rows, 2) if pairs else (rows, *np.shape(value))
            inside = low + (high - low) * rng.uniform(0.2, 0.95, shape)
            ends = rng.choice([low, min(1.0, high), high], shape)
            arrays[name] = np.where(rng.random(shape) < 0.25, ends, inside)
    for name in [name for name, value in switches.items() if isinstance(value, dict)]:
        switches |= switches.pop(name)  # the keys of a mapping become separate arguments
    value = arguments.call(inspect.unwrap(function), arguments.base(inspect.unwrap(function)))
    # Samplers return no colors, so their color inputs have one number per row.
    channels = 0 if isinstance(value, tuple) else np.ndim(value)
    # Only samplers of interfaces need color channels.
    channels = channels or function.__name__.startswith(INTERFACES)
    for name in COLORS & set(arrays) if channels else ():
        if arrays[name].ndim < 2 and (name.startswith(TINTS) or "conductor" in function.__name__):
            arrays[name] = arrays[name][:, np.newaxis]
    return arrays, switches


def whole(value):
    if not isinstance(value, tuple):
        return value
    w, pdf, *others = value
    if w.ndim != pdf.ndim:
        w, pdf, *others = w[..., 0], w[..., 1], w[..., 2], pdf + 0.0 * w[..., 0]
    return array_namespace(w).stack([w, pdf, *others], axis=-1)


def scalar(value, axes=1):
    """One number per row: the first color channel of a value, or the sum of a sampler's results."""
    value = whole(value).sum(-1) if isinstance(value, tuple) else value
    while value.ndim > axes:
        value = value[..., 0]
    return value


def moved(function, arrays, switches, name):
    """Values of `scalar` by offset, where the offset is added to each component of an array."""
    array = arrays[name]
    rows, size = len(array), array[0].size
    several = np.tile(array.reshape(rows, size), (size, len(OFFSETS), 1, 1))
    for k in range(size):
        several[k, ..., k] += WIDTH * np.array(OFFSETS)[:, np.newaxis]
    count = size * len(OFFSETS)
    values = {k: np.tile(each, (count, *np.ones(each.ndim - 1, int))) for k, each in arrays.items()}
    values[name] = several.reshape(values[name].shape)
    # vmap traces the values, so the functions check no argument. Shifted arguments may leave their
    # ranges, and directions need not have unit length.
    torch = package("torch")

    def row(*arguments):
        return scalar(function(**dict(zip(values, arguments, strict=True)), **switches), 0)

    found = torch.func.vmap(row)(*map(torch.tensor, values.values())).numpy()
    return [dict(zip(OFFSETS, each, strict=True)) for each in found.reshape(size, -1, rows)]


def slopes(f, step):
    """Forward and backward differences with errors of third order, with steps of `step` * WIDTH."""
    with np.errstate(invalid="ignore"):
        changes = [18 * f[k] - 9 * f[2 * k] + 2 * f[3 * k] - 11 * f[0] for k in (step, -step)]
        return [each / (6 * k * WIDTH) for each, k in zip(changes, (step, -step), strict=True)]


def differences(function, arrays, switches, name):
    """For each component of an array, finite differences of rows, and a mask of reliable rows."""
    for k, f in enumerate(moved(function, arrays, switches, name)):
        low, high, _ = RANGES[name] if name in RANGES else RANGES["mu" if k == 2 else "cos_theta"]
        x = arrays[name].reshape(len(arrays[name]), -1)[:, k]
        coarse, fine, reach = slopes(f, 2), slopes(f, 1), WIDTH * max(OFFSETS)
        usable = [x + reach <= high, x - reach >= low]
        best = np.where(usable[0], fine[0], fine[1])
        spread = np.zeros(len(x))
        with np.errstate(invalid="ignore"):  # offsets beyond the range return NaN
            for side, each in ((0, coarse[0]), (0, fine[0]), (1, coarse[1]), (1, fine[1])):
                spread = np.maximum(spread, np.where(usable[side], np.abs(each - best), 0.0))
        yield best, spread <= RELIABLE * np.maximum(1.0, np.abs(best))


CASES = [(make, name) for name in PORTABLE for make in (pytorch, jax)]
CASES = [(make, name) for make, name in CASES if make is pytorch or not name.endswith(LONG)]


@pytest.mark.parametrize(("make", "name"), CASES)
def test_gradients_are_finite_and_those_of_differences(make, name):
    # JAX runs the same lines of the models as PyTorch, so lines are traced only for PyTorch.
    with untraced() if make is jax else nullcontext():
        assert_gradients(make(), name, False)


@pytest.mark.parametrize("name", COMPENSATED)
def test_gradients_of_the_compensation_are_those_of_differences(name):
    # Only PyTorch is tested, because JAX takes seconds to compile the polynomials.
    assert_gradients(pytorch(), f"mxeon.models.microfacet.{name}", True)


@lru_cache(maxsize=4)  # PyTorch and JAX use the same reference
def reference(name, compensate):
    """Arguments of a function, NumPy's values, and finite differences by array and component."""
    function = PORTABLE[name]
    arrays, switches = sampled(function)
    switches |= {"compensate": True} if compensate else {}
    slopes = {each: list(differences(function, arrays, switches, each)) for each in arrays}
    return arrays, switches, whole(function(**arrays, **switches)), slopes


def assert_gradients(library, name, compensate):
    """Assert that a library's gradients match the finite differences that are reliable."""
    function = PORTABLE[name]
    arrays, switches, expected_value, slopes = reference(name, compensate)
    value, found = library.gradients(partial(function, **switches), arrays)
    assert_values(value, expected_value, NOISE.get(function.__name__, VALUE))
    for argument, gradient in found.items():
        assert np.isfinite(gradient).all(), argument
        kink = np.zeros(count(function), bool)
        if function.__name__.endswith("_sample") and argument == "wo":
            kink = arrays["wo"][:, 2] == 1.0  # the azimuth of wo jumps at the normal
        if function.__name__.endswith("_anisotropy"):  # the larger of two alphas is clamped at 1
            kink = (function(**arrays)[:, 0] == 1.0) & (arrays["anisotropy"] == 0.0)
        if function.__name__.endswith("transmittance_dir") and argument == "roughness":
            # At roughness 0 the transmittance is defined as 0, so its slope is meaningless.
            kink = (arrays["roughness"] == 0.0).any(axis=1)
        if function.__name__ == "film_schlick":  # the reflectance is clamped at 0
            kink = (arrays["color0"] * arrays["color90"] == 0.0)[:, 0]
        columns, judged = gradient.reshape(count(function), -1).T, 0
        for k, column in enumerate(columns):
            expected, reliable = slopes[argument][k]
            reliable = reliable & ~kink
            error = np.abs(column - expected) / np.maximum(1.0, np.abs(expected))
            worst = np.where(reliable, error, 0.0).argmax()
            row = {each: value[worst] for each, value in arrays.items()}
            place = argument, k, column[worst], expected[worst], row
            assert error[reliable].max(initial=0.0) <= GRADIENT, place
            judged += reliable.sum()
        assert judged >= CUT.get(function.__name__, COMPARED) * columns[:, ~kink].size, argument


def assert_values(value, expected, allowed=VALUE):
    """Assert that a library's values match NumPy's values."""
    assert value.shape == expected.shape
    error = np.abs(value - expected) / np.maximum(1.0, np.abs(expected))
    assert (error <= allowed).all()


@pytest.mark.parametrize("name", COMPENSATED)
def test_values_with_compensation_are_those_of_numpy(name):
    function, library = PORTABLE[f"mxeon.models.microfacet.{name}"], jax()
    arrays, switches = sampled(function)
    switches |= {"compensate": True}
    value = library.transforms[0](partial(function, **switches))(**arrays)
    assert_values(library.numpy(value), whole(function(**arrays, **switches)))


def test_numpy_gets_its_own_functions_to_the_last_bit():
    x, y = np.random.default_rng(SEED).uniform(0.0, 1.0, (2, 1000))
    assert array_namespace(x, 0.5, [1.0]) is NUMPY
    pairs = (
        (edges.cosine(x), np.minimum(x, 1.0)),
        (edges.at_most(x, 0.5), np.minimum(x, 0.5)),
        (edges.trimmed(x, 0.5), np.minimum(x, 0.5)),
        (edges.at_least_0(x - 0.5), np.maximum(x - 0.5, 0.0)),
        (edges.root(x), np.sqrt(x)),
        (edges.power(x, 1.0 / 3.0), x ** (1.0 / 3.0)),
        (edges.hypot(x, y), np.hypot(x, y)),
        (edges.power(x, y), x**y),
        (edges.guarded(x, x > 0.5, 0.0), x),
    )
    assert all(np.array_equal(ours, plain) for ours, plain in pairs)
    assert NUMPY.sqrt is np.sqrt and NUMPY.atan is np.arctan and NUMPY.atan2 is np.arctan2


def test_transformations_of_jax_and_torch(library):
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng, False), directions(rng, False)
    expected = eon_brdf(wo, wi, [0.2, 0.8], 0.5)
    for transform in library.transforms:
        traced = transform(lambda wo, wi: eon_brdf(wo, wi, [0.2, 0.8], 0.5))
        values = traced(library.array(wo), library.array(wi))
        np.testing.assert_allclose(library.numpy(values), expected, VALUE, VALUE)


def test_values_are_checked_wherever_there_are_any(library):
    up, rho = library.array([0.0, 0.0, 1.0]), library.array([0.5])
    with pytest.raises(ValueError, match=r"^rho must lie in \[0, 1\]; got 1.5$"):
        lambert_brdf(up, up, library.array([1.5]))
    with pytest.raises(ValueError, match="^wi must not point below the horizon"):
        lambert_brdf(up, -up, rho)
    with pytest.raises(ValueError, match="^roughness must be real numbers"):
        eon_brdf(up, up, rho, "rough")


def test_a_number_for_the_roughness_stands_for_both(library):
    wo = library.array([0.6, 0.0, 0.8])
    both = smith_g1(wo, library.array([0.4, 0.4]))
    for roughness in (0.4, library.array(0.4)):
        assert library.numpy(smith_g1(wo, roughness)) == library.numpy(both)


def test_precision_is_that_of_the_arrays(library):
    single = library.array(np.array([0.5], np.float32))
    value = lambert_brdf(np.array([[0.6, 0.0, 0.8]]), [0, 0, 1], single)
    assert library.numpy(value).dtype == np.float32 and tuple(value.shape) == (1, 1)
    # Integers do not determine a floating-point precision.
    whole = lambert_brdf(library.array([0, 0, 1]), [0, 0, 1], 0.5)
    assert library.numpy(whole).dtype in (np.float32, np.float64)


def test_numbers_that_are_defaults_come_to_the_library_too(library):
    wo, u = library.array([0.6, 0.0, 0.8]), library.array([0.5, 0.25])
    wi, pdf = eon_sample(wo, u, library.array(0.5))
    assert library.numpy(wi) == pytest.approx(eon_sample(wo, u, library.array(0.5), rho=1.0)[0])
    assert library.numpy(pdf) == pytest.approx(eon_sample([0.6, 0.0, 0.8], [0.5, 0.25], 0.5)[1])


def test_one_rounding_beyond_an_edge_counts_as_the_edge(library):
    up, tilted, flat = [0.0, 0.0, 1.0], [0.6, 0.0, 0.8], [1.0, 0.0, -1e-17]
    edge = eon_brdf(up, tilted, 1.0, 1.0), eon_brdf([1.0, 0.0, 0.0], tilted, 1.0, 1.0)
    assert eon_brdf([0.0, 0.0, 1.0 + 1e-9], tilted, 1.0 + 1e-9, 1.0) == edge[0]
    assert eon_brdf(flat, tilted, 1.0, 1.0) == edge[1]
    other = eon_brdf(library.array(flat), tilted, 1.0, 1.0)
    assert library.numpy(other) == pytest.approx(edge[1], abs=VALUE)
    beyond = library.array(1.0 + 1e-9)
    assert library.numpy(fon_loss(beyond)) == pytest.approx(fon_loss(1.0), abs=VALUE)
    with pytest.raises(ValueError, match="^mu must lie"):
        fon_loss(1.0 + 1e-6)


def test_arrays_of_two_libraries_do_not_mix():
    tensor, array = package("torch").ones(1), package("jax").numpy.ones(1)
    with pytest.raises(ValueError, match="^arrays must be of one library; got jax and torch"):
        fon_albedo_dir(tensor, array)


def test_arrays_of_jax_without_numbers_are_refused():
    library = package("jax")
    deleted = library.numpy.asarray([0.0, 0.6, 0.8])
    deleted.delete()
    for array, rule in (
        (library.random.key(0), "arrays must be of real numbers; got one of key<fry>"),
        (deleted, "arrays must have values; got one that was deleted"),
    ):
        with pytest.raises(ValueError, match=f"^{rule}$"):
            eon_brdf(array, [0.0, 0.6, 0.8], 0.5, 0.5)


@pytest.mark.parametrize("name", ("torch", "jax"))
def test_the_examples_of_the_page_run(name):
    package(name)
    blocks = re.findall(r"```python\n(.*?)```", table.PAGE.read_text(encoding="utf-8"), re.DOTALL)
    chosen = [each for each in blocks if f"import {name}" in each]
    assert chosen
    for block in chosen:
        exec(block, {})


def test_models_by_name_run_under_jit():
    library, row = jax(), mxeon.model("eon")
    wo, wi = np.array([0.6, 0.0, 0.8]), np.array([0.0, 0.6, 0.8])
    traced = library.transforms[0](lambda rough: row.brdf(wo, wi, 0.5, rough))
    assert library.numpy(traced(0.4)) == pytest.approx(row.brdf(wo, wi, 0.5, 0.4))
