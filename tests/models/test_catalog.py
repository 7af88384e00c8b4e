# SPDX-License-Identifier: Apache-2.0
"""`mxeon.model` takes MaterialX's inputs, and returns the right functions, shapes and messages."""

import re

import MaterialX as mx
import numpy as np
import pytest
from numpy.testing import assert_array_equal

import mxeon
from mxeon import models
from mxeon.models import hair, sampling
from mxeon.models.catalog import MODELS
from mxeon.models.nodes import PBR_NODES
from mxeon.models.nodes.node import DEFAULTS
from mxeon.shaders.library import load_library
from tests.support import tolerances
from tests.support.hemispheres import hemisphere

WO, WI = np.array([0.6, 0.0, 0.8]), np.array([-0.36, 0.48, 0.8])
MANY = np.array([[0.6, 0.0, 0.8], [0.0, 0.8, 0.6], [0.0, 0.0, 1.0], [0.0, 0.6, 0.8], WI])
# Quadrature errors: 2e-4 for the albedo, and 1e-4 for the integral of the values.
TRANSMITTED = 3e-4
MODES = {"mode", "scatter_mode", "distribution", "energy_compensation"}
FRAME = {"weight", "normal", "tangent", "curve_direction", "retroreflective"}
LIGHT = {"front": WI, "back": WI * [1.0, 1.0, -1.0], "all sides": WI}
every_model = pytest.mark.parametrize("name", MODELS)
SAMPLED = [name for name in MODELS if "sample" in MODELS[name].functions]
# Inputs of the tested samplers, by name and number of channels. All other inputs have defaults.
ROUGH = {
    **{
        ("roughness", 0): 0.5,
        ("roughness", 2): (0.3, 0.6),
        ("alpha", 0): 0.3,
        ("cuticle_angle", 0): 0.6,
    },
    **{(name, 2): (0.4, 0.6) for name in hair.ROUGHNESSES},
}
OTHER_ALBEDO = ("burley_lambert",)  # wrong models whose albedo is not the integral of their values
MASS = 2e-3  # noise of the fraction of samples below the horizon


@pytest.mark.parametrize("category", DEFAULTS)
def test_inputs_have_the_names_order_and_defaults_of_the_definition(category):
    definition = load_library("stock").getNodeDef(f"ND_{category}")
    left = MODES | FRAME | ({"anisotropy"} if category == "subsurface_bsdf" else set())
    ports = [port for port in definition.getActiveInputs() if port.getName() not in left]
    assert list(DEFAULTS[category]) == [port.getName() for port in ports]
    for port in ports:
        # In MaterialX, the inputs of an EDF have no default.
        text = port.getValueString() or "0.0, 0.0, 0.0"
        numbers = [float(each) for each in text.split(",")]
        assert np.ravel(DEFAULTS[category][port.getName()]).tolist() == numbers
    assert mx.getVersionString() == "1.39.5"


@every_model
def test_inputs_are_in_the_order_of_their_node(name):
    row = MODELS[name]
    names = [each.name for each in row.parameters]
    order = list(DEFAULTS.get(row.node, names))  # layered models are not MaterialX nodes
    assert names == sorted(names, key=order.index)
    for each in row.parameters:
        low, high = each.interval
        assert all(low <= number <= high for number in np.ravel(each.default))


@every_model
def test_a_model_has_the_functions_that_it_names(name):
    row = mxeon.model(name)
    light = LIGHT[row.lights]
    value = row.bsdf(WO, light)
    assert value.shape == (3,) and np.isfinite(value).all()
    assert row.albedo_dir([0.3, 0.5, 0.8]).shape == (3, 3)
    if "brdf" in row.functions:
        assert_array_equal(row.brdf(WO, light), value)


@pytest.mark.parametrize("name", SAMPLED)
def test_every_drawn_direction_has_a_value_and_its_density(name):
    row, wo = mxeon.model(name), np.array([np.sqrt(0.84), 0.0, 0.4])
    keys = {each.name: (each.name, each.channels) for each in row.parameters}
    inputs = {each: ROUGH[key] for each, key in keys.items() if key in ROUGH}
    k, count = np.random.default_rng(1), 96
    grid = np.stack(np.meshgrid(*[np.arange(count)] * 2), axis=-1).reshape(-1, 2)
    wi, pdf = row.sample(wo, (grid + k.random(grid.shape)) / count, **inputs)
    assert np.allclose(row.pdf(wo, wi, **inputs), pdf, rtol=1e-9)
    # If a model scatters no light to a side of the surface, the values on this side are 0.
    value, below = row.bsdf(wo, wi, **inputs), wi[:, 2] < 0.0
    if row.lights != "all sides":
        assert not value[below if row.lights == "front" else ~below].any()
    # The mean weight equals the albedo. The density's integral above the horizon, plus the fraction
    # of samples below the horizon, is 1.
    cosine = 1.0 if name == "hair" else np.abs(wi[:, 2:])
    weights = value * cosine / pdf[:, np.newaxis]
    error = np.abs(weights.mean(axis=0) - row.albedo_dir(0.4, **inputs))
    assert name in OTHER_ALBEDO or (error <= weights.std(axis=0) / count + 1e-9).all()
    up, solid_angle = hemisphere(0.4, 48)
    assert row.pdf(wo, up, **inputs) @ solid_angle + below.mean() == pytest.approx(1.0, abs=MASS)


@every_model
def test_what_a_model_has_is_in_dir_and_what_it_lacks_is_said(name):
    row = mxeon.model(name)
    verbs = ("brdf", "bsdf", "albedo_dir", "albedo_avg", "sample", "pdf")
    for verb in verbs:
        assert (verb in dir(row)) == (verb in row.functions)
        if verb not in row.functions:
            with pytest.raises(ValueError, match=f"^{name} has no {verb}.*; it has"):
                getattr(row, verb)(WO, WI) if verb != "albedo_avg" else row.albedo_avg()


@every_model
def test_a_viewer_below_the_horizon_is_refused_but_by_a_fiber(name):
    row = mxeon.model(name)
    for call in {"bsdf", "sample", "pdf"} & set(row.functions) if name != "hair" else ():
        with pytest.raises(ValueError, match="^wo must not point below the horizon"):
            getattr(row, call)(-WO, [0.4, 0.3] if call == "sample" else LIGHT[row.lights])


def test_the_words_of_a_model_show_its_inputs_with_ranges_and_units():
    words = repr(mxeon.model("qon")).splitlines()
    assert words[0].startswith("qon: qualitative Oren-Nayar (QON); brdf, bsdf, albedo_dir")
    color, roughness = "color = (0.18, 0.18, 0.18), in [0, 1]", "roughness = 0.0, in [0, pi/2] rad"
    assert words[1:] == [f"  {color}", f"  {roughness}"]
    assert "without a cosine" in repr(mxeon.model("hair"))


def test_a_model_has_other_names():
    assert mxeon.model("eon_diffuse_bsdf") is mxeon.model("eon")
    assert mxeon.model("generalized_schlick") is mxeon.model("schlick")


@pytest.mark.parametrize("category", DEFAULTS)
def test_a_node_gives_the_model_of_its_default_mode(category):
    row = mxeon.model(category)
    assert row.node == category
    ports = load_library("stock").getNodeDef(f"ND_{category}").getActiveInputs()
    modes = {port.getName(): port.getValueString() for port in ports if port.getName() in MODES}
    own = {each.name: each.fixed for each in PBR_NODES}.get(row.name, {})
    assert own.items() <= modes.items()
    assert modes.get("energy_compensation") in (None, "false") or row.name == "eon"


@every_model
def test_a_material_each_gives_the_values_of_single_calls(name):
    row, rng, inputs = mxeon.model(name), np.random.default_rng(0), {}
    given = {"albedo_dir": (0.4,), "albedo_avg": (), "sample": (WO, [0.3, 0.6])}
    for each in row.parameters:
        shift = 0.1 * rng.random((2, *np.shape(each.default)))
        inputs[each.name] = 0.9 * np.asarray(each.default) + shift[[0, 1, 1]]  # two equal channels
    for function in row.functions:
        call, at = getattr(row, function), given.get(function, (WO, LIGHT[row.lights]))
        for chosen in (inputs, *({key: inputs[key]} for key in inputs)):
            values = call(*at, **chosen)
            for n in range(3):
                own = call(*at, **{key: value[n] for key, value in chosen.items()})
                pairs = zip(values, own, strict=True) if function == "sample" else [(values, own)]
                for many, one in pairs:
                    assert np.allclose(many[n], one, rtol=tolerances.MICROFACET)


@every_model
def test_colors_that_are_numbers_have_no_channels(name):
    row = mxeon.model(name)
    numbers = {e.name: np.mean(e.default) for e in row.parameters if e.channels == 3}
    last = (3,) if name.endswith("film") else ()
    assert row.bsdf(WO, LIGHT[row.lights], **numbers).shape == last
    assert row.albedo_dir([0.3, 0.5], **numbers).shape == (2, *last)


def test_inputs_go_to_the_functions_of_the_models():
    gold = {"ior": [0.183, 1.373], "extinction": [3.424, 1.770]}
    conductor = mxeon.model("conductor").brdf(WO, WI, *gold.values(), 0.3)
    assert_array_equal(conductor, models.conductor_brdf(WO, WI, 0.3, **gold))
    dielectric = mxeon.model("dielectric").brdf(WO, WI, 0.7, 1.4, [0.3, 0.2])
    assert dielectric == models.dielectric_brdf(WO, WI, 0.7, [0.3, 0.2], 1.4)[0]
    qon = mxeon.model("qon").brdf(WO, WI, rho=0.5, sigma=1.2)
    assert qon == models.qon_brdf(WO, WI, 0.5, 1.2)[0]
    assert mxeon.model("eon").albedo_dir(0.3, 0.5, 1.0) == models.eon_albedo_dir(0.3, 0.5, 1.0)[0]
    assert mxeon.model("eon").albedo_avg(0.5, 1.0) == models.eon_albedo_avg(0.5, 1.0)[0]


@pytest.mark.parametrize("name", ["dielectric", "schlick"])
def test_scatter_modes_t_and_rt_are_transmission_and_both(name):
    inputs, below = {"roughness": 0.4}, LIGHT["back"]
    if name == "schlick":
        inputs |= {"color0": 0.04}
    R, T, RT = (mxeon.model(f"{name}{mode}") for mode in ("", "_t", "_rt"))
    assert_array_equal(RT.bsdf(WO, [WI, below], **inputs)[0], R.bsdf(WO, WI, **inputs))
    assert_array_equal(RT.bsdf(WO, [WI, below], **inputs)[1], T.bsdf(WO, below, **inputs))

    # The integral of the BTDF equals the albedo.
    def below_of(wo, wi, rho):
        return T.bsdf(wo, wi * [1.0, 1.0, -1.0], **inputs)

    integral = models.albedo_dir_quadrature(below_of, 0.8, np.ones(3), nodes=128)
    albedo = T.albedo_dir(0.8, **inputs)
    assert np.allclose(integral, albedo, atol=TRANSMITTED)
    both = RT.albedo_dir(0.8, **inputs)
    assert np.allclose(both, albedo + R.albedo_dir(0.8, **inputs))


def test_an_albedo_without_a_closed_form_is_the_integral():
    albedo = mxeon.model("oren_nayar").albedo_dir(0.4, 0.8, 0.5)
    exact = models.albedo_dir_quadrature(models.oren_nayar_brdf, 0.4, 0.8, 0.5)
    assert albedo == exact[0]


def test_an_anisotropic_albedo_depends_on_the_azimuth():
    inputs = {"roughness": [0.1, 0.5], "azimuth": [0.0, np.pi / 2]}
    albedo = mxeon.model("schlick").albedo_dir(0.3, color0=0.04, **inputs)
    assert abs(albedo[0] - albedo[1]).min() > 0.01
    white = mxeon.model("schlick").albedo_dir(0.3, **inputs)
    assert abs(white - 1.0).max() < 1e-9  # facets with a reflectance of 1 reflect all light


def test_numbers_have_no_channels_and_colors_keep_theirs():
    eon = mxeon.model("eon")
    assert eon.brdf(WO, WI, 0.5, 0.2).shape == ()
    assert eon.brdf(MANY, WI, 0.5, [0.1, 0.2, 0.3, 0.4, 0.5]).shape == (5,)
    assert eon.brdf(MANY, WI, [0.5], 0.2).shape == (5, 1)
    assert eon.brdf(MANY[:, None], MANY, [0.5, 0.2, 0.1], 0.2).shape == (5, 5, 3)
    assert eon.brdf(MANY, MANY, np.full((5, 1), 0.5), 0.2).shape == (5, 1)
    assert eon.brdf(MANY[:3], WI, [0.5, 0.2, 0.1], 0.2).shape == (3, 3)
    assert eon.brdf(MANY, WI, np.full((1, 5), 0.5), 0.2).shape == (5, 5)


@pytest.mark.parametrize("call", ["model", "function", "microfacets"])
def test_a_list_beside_as_many_directions_is_refused_with_the_remedy(call):
    color = np.full(5, 0.5)
    calls = {
        "model": lambda: mxeon.model("eon").brdf(MANY, WI, color, 0.2),
        "function": lambda: models.eon_brdf(MANY, WI, color, 0.2),
        "microfacets": lambda: models.dielectric_brdf(MANY, WI, color, 0.2, 1.5),
    }
    with pytest.raises(ValueError, match=r"with 5 directions is ambiguous: write \w+\[:, np"):
        calls[call]()


@pytest.mark.parametrize(
    ("function", "inputs"),
    [
        (models.conductor_brdf, (0.3, 1.5, 2.0)),
        (models.generalized_schlick_brdf, (0.3, 1.0, 1.0, 0.3, 5.0)),
        (sampling.ggx_pdf, (0.3,)),
        (models.smith_g2_anisotropic, (0.3,)),
    ],
)
def test_a_number_for_roughness_is_isotropic(function, inputs):
    place = max(k for k, value in enumerate(inputs) if value == 0.3)
    pair = (*inputs[:place], [0.3, 0.3], *inputs[place + 1 :])
    assert_array_equal(function(WO, WI, *inputs), function(WO, WI, *pair))
    each = (*inputs[:place], [[0.3], [0.3]], *inputs[place + 1 :])
    assert_array_equal(function(WO, WI, *each)[0], function(WO, WI, *pair))


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: mxeon.model("conducter"), ValueError, "did you mean conductor?"),
        (lambda: mxeon.model("conductor_bdsf"), ValueError, "did you mean conductor_bsdf?"),
        (lambda: mxeon.model("EON"), ValueError, "no model 'EON': did you mean eon? see mxeon.model_names()"),
        (lambda: mxeon.model("sheen"), ValueError, "did you mean conty_kulla or zeltner?"),
        (lambda: mxeon.model("conductor_bsdf_"), ValueError, "did you mean conductor_bsdf?"),
        (lambda: mxeon.model(["eon"]), ValueError, "no model ['eon']; see"),
        (lambda: mxeon.model("nope"), ValueError, "no model 'nope'; see mxeon.model_names()"),
        (lambda: mxeon.model("ggx"), ValueError, "no model 'ggx': did you mean dielectric or conductor or schlick?"),
        (lambda: mxeon.model("schlick_t").sample(WO, [0.1, 0.2]), ValueError, "schlick_t has no sample: no density of refracted light is implemented; it has bsdf"),
        (lambda: mxeon.model("hair").albedo_dir(MANY[:4]), ValueError, "mu must be cosines; got shape (4, 3) of unit length, a direction: pass its z"),
        (lambda: mxeon.model("eon").brdf(WO[:2], WI), ValueError, "wo must have shape (..., 3); got shape (2,)"),
        (lambda: mxeon.model("eon").sample(WO, 0.5), ValueError, "u must have shape (..., 2); got shape ()"),
        (lambda: mxeon.model("hair").brdf(WO, WI), ValueError, "hair has no brdf: light passes through it, so call bsdf; it has bsdf"),
        (lambda: mxeon.model("eon").brdf(WO, WI, tint=1.0), TypeError, "inputs are color, roughness; got 'tint'"),
        (lambda: mxeon.model("eon").brdf(WO, WI, 1.0, rho=1.0), TypeError, "got 'rho' twice"),
        (lambda: mxeon.model("eon").brdf(WO, WI, 1.0, 1.0, 1.0), TypeError, "got 3 inputs"),
        (lambda: mxeon.model("qon").brdf(WO, WI, 1.0, 2.0), ValueError, "roughness must lie in [0, pi/2]; got 2.0"),
        (lambda: mxeon.model("eon").brdf(MANY, MANY[:2]), ValueError, "wo has 5 rows, wi has 2 rows; give equal counts, or one"),
    ],
)  # fmt: skip
def test_messages_say_what_there_is(call, error, message):
    with pytest.raises(error, match=re.escape(message)):
        call()


def test_three_samples_of_one_direction_take_no_color_for_their_reflectances():
    u, color = np.full((3, 2), 0.4), np.array([0.8, 0.4, 0.1])
    with pytest.raises(ValueError, match=r"^rho of shape \(3,\) with 3 samples .* rho.mean\(\)"):
        sampling.eon_sample(WO, u, 0.5, rho=color)
    each = sampling.eon_sample(np.tile(WO, (3, 1)), u, 0.5, rho=color)[1]
    assert len(set(each)) == 3
    _, pdf = mxeon.model("eon").sample(WO, u, color=color[:, np.newaxis], roughness=0.5)
    assert np.allclose(pdf, each)
