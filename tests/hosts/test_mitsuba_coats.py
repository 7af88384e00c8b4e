# SPDX-License-Identifier: Apache-2.0
"""A coat and OpenPBR's base as plugins of Mitsuba: values, sampling, energy and gradients."""

import numpy as np
import pytest

from mxeon import mitsuba as plugins
from mxeon import models
from mxeon.fit import openpbr_base
from tests.support.bsdfs import COLOR, SEED, chi_square, directions, furnace, material, surface
from tests.support.tolerances import MITSUBA_COAT, MITSUBA_DENSITY, MITSUBA_EVAL

COAT = "dielectric_over_eon"
DIELECTRIC = {"alpha": 0.3, "ior": 1.5}
BASE = {"roughness": 0.6, "specular_roughness": 0.5, "specular_ior": 1.5, "metalness": 0.25}
DEVIATE = 4.5  # of a mean: exceeded once in 150,000 times


def coat(dielectric, color=COLOR):
    return material("eon", 0.6, color) | {"type": COAT} | dielectric


def coated(dielectric):
    """Inputs of the model, as float32 has them."""
    inputs = {name: float(np.float32(value)) for name, value in dielectric.items()}
    return {"rho": COLOR, "roughness": float(np.float32(0.6))} | inputs


def openpbr(color=COLOR, **other):
    names = {"roughness": "base_diffuse_roughness", "metalness": "base_metalness"}
    inputs = {names.get(name, name): value for name, value in (BASE | other).items()}
    return {"type": "openpbr_base", "base_color": {"type": "rgb", "value": list(color)}} | inputs


def of_openpbr(wo, wi, **other):
    inputs = {name: float(np.float32(value)) for name, value in (BASE | other).items()}
    return openpbr_base(wo, wi, COLOR, **inputs) * wi[:, 2:].astype(np.float64)


@pytest.mark.parametrize("angle", (0.0, 1.4))
def test_mitsubas_chi_square_test_accepts_the_sampling_of_a_coat(mi, angle):
    test = chi_square(mi, angle, lambda adapter: adapter(COAT, coat(DIELECTRIC)))
    assert test.run(test_count=2, quiet=True), test.messages


def test_mitsubas_chi_square_test_refuses_the_density_of_another_coat(mi):
    def mismatched(adapter):
        rough, smooth = (adapter(COAT, coat(DIELECTRIC | {"alpha": a})) for a in (0.3, 0.6))
        return rough[0], smooth[1]

    assert not chi_square(mi, 0.8, mismatched).run(test_count=2, quiet=True)


@pytest.mark.parametrize("alpha", (0.05, 0.5))
def test_a_white_furnace_keeps_the_energy_of_a_coat_in_the_mean(mi, alpha):
    picture = furnace(mi, coat(DIELECTRIC | {"alpha": alpha}, (1.0,) * 3), 64)[..., 0]
    assert 1e-3 < picture.std() < 0.1
    assert abs(picture.mean() - 1.0) < DEVIATE * picture.std() / np.sqrt(picture.size)


@pytest.mark.parametrize("ior", (1.02, 1.5, 4.0))
@pytest.mark.parametrize("alpha", (0.015625, 0.3, 1.0))
def test_values_of_a_coat_are_those_of_the_model(mi, alpha, ior):
    # Let some of the lights be near the mirrored viewer.
    rng, dielectric = np.random.default_rng(SEED), {"alpha": alpha, "ior": ior}
    wo, wi = directions(rng), directions(rng)[::-1].copy()
    wi[100:200] = wo[100:200] * [-1, -1, 1] + 0.03 * rng.normal(size=(100, 3))
    wi[:, 2] = np.abs(wi[:, 2])
    wi = (wi / np.linalg.norm(wi, axis=1, keepdims=True)).astype(np.float32)
    # Compare values and densities.
    bsdf, context, light = mi.load_dict(coat(dielectric)), mi.BSDFContext(), mi.Vector3f(wi.T)
    values, pdf = bsdf.eval_pdf(context, surface(mi, wo), light)
    inputs, cosine = coated(dielectric), wi[:, 2:].astype(np.float64)
    expected = models.dielectric_over_eon_brdf(wo, wi, **inputs) * cosine
    error = np.abs(np.array(values).T - expected)
    assert (error <= np.maximum(MITSUBA_EVAL, MITSUBA_COAT * expected)).all()
    density = models.dielectric_over_eon_pdf(wo, wi, **inputs)
    black = inputs | {"rho": 0.0}
    reflected = models.dielectric_over_eon_albedo_dir(wo[:, 2].astype(np.float64), **black)[:, 0]
    error = np.abs(np.array(pdf) - density) / np.maximum(1.0, density)
    assert (error <= MITSUBA_COAT + MITSUBA_DENSITY / reflected).all()


def test_a_coat_has_two_lobes_that_are_asked_for_alone(mi):
    bsdf, light = mi.load_dict(coat(DIELECTRIC)), mi.Vector3f(-0.48, 0.0, 0.877)
    context, point = mi.BSDFContext(), surface(mi, [[0.6, 0.0, 0.8]])
    u = 0.5, mi.Point2f(0.25, 0.75)
    whole, parts = np.array(bsdf.eval(context, point, light)), []
    for component, kind in enumerate(("GlossyReflection", "DiffuseReflection")):
        context.component = component
        parts.append(np.array(bsdf.eval(context, point, light)))
        record, weight = bsdf.sample(context, point, *u)
        value = np.array(bsdf.eval(context, point, record.wo))
        assert np.array(record.sampled_type)[0] == int(getattr(mi.BSDFFlags, kind))
        assert np.array(weight) * np.array(record.pdf) == pytest.approx(value, rel=1e-5)
    assert sum(parts) == pytest.approx(whole, rel=1e-6) and min(map(np.min, parts)) > 0.0
    context.type_mask = int(mi.BSDFFlags.Null)
    assert not np.array(bsdf.eval(context, point, light)).any()


def test_gradients_by_a_coat_are_those_of_the_model_and_it_takes_new_numbers(mi):
    import drjit as dr

    # Differentiate a value.
    wo, wi = np.array([[0.6, 0.0, 0.8]]), np.array([[-0.48, 0.6, 0.64]])
    bsdf, light = mi.load_dict(coat(DIELECTRIC)), mi.Vector3f(wi.T)
    parameters, names = mi.traverse(bsdf), ["roughness.value", *DIELECTRIC]
    for name in names:
        dr.enable_grad(parameters[name])
    parameters.update()
    dr.backward(dr.sum(bsdf.eval(mi.BSDFContext(), surface(mi, wo), light)))

    # Compare it with differences of the model.
    def total(name="ior", step=0.0):
        inputs = coated(DIELECTRIC)
        inputs[name] += step
        return models.dielectric_over_eon_brdf(wo, wi, **inputs).sum() * 0.64

    for name in names:
        key = name.removesuffix(".value")
        slope = (total(key, 1e-4) - total(key, -1e-4)) / 2e-4
        assert np.array(dr.grad(parameters[name])).item() == pytest.approx(slope, rel=1e-5)
    # Take a number beyond the range, which counts as its end.
    parameters["ior"] = mi.Float(5.0)
    parameters.update()
    value = np.array(bsdf.eval(mi.BSDFContext(), surface(mi, wo), light)).sum()
    assert value == pytest.approx(total("ior", 4.0 - DIELECTRIC["ior"]), rel=1e-5)


@pytest.mark.parametrize("metalness", (0.0, 0.25, 1.0))
def test_values_of_openpbrs_base_are_those_of_the_model(mi, metalness):
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng), directions(rng)[::-1].copy()
    bsdf, light = mi.load_dict(openpbr(metalness=metalness)), mi.Vector3f(wi.T)
    expected = of_openpbr(wo, wi, metalness=metalness)
    values = np.array(bsdf.eval(mi.BSDFContext(), surface(mi, wo), light)).T
    assert (np.abs(values - expected) <= np.maximum(MITSUBA_EVAL, MITSUBA_COAT * expected)).all()


def test_openpbrs_base_is_sampled_by_its_density_and_keeps_energy(mi):
    test = chi_square(mi, 0.8, lambda adapter: adapter("openpbr_base", openpbr()))
    assert test.run(test_count=1, quiet=True), test.messages
    picture = furnace(mi, openpbr((1.0,) * 3), 64)[..., 0]
    assert 1e-3 < picture.std() < 0.1
    assert abs(picture.mean() - 1.0) < DEVIATE * picture.std() / np.sqrt(picture.size)


def test_gradients_by_openpbrs_base_are_those_of_the_model(mi):
    import drjit as dr

    wo, wi = np.array([[0.6, 0.0, 0.8]]), np.array([[-0.48, 0.6, 0.64]])
    bsdf = mi.load_dict(openpbr())
    parameters = mi.traverse(bsdf)
    names = {
        "base_metalness.value": "metalness",
        "base_diffuse_roughness.value": "roughness",
        **{name: name for name in ("specular_roughness", "specular_ior")},
    }
    for name in names:
        dr.enable_grad(parameters[name])
    parameters.update()
    dr.backward(dr.sum(bsdf.eval(mi.BSDFContext(), surface(mi, wo), mi.Vector3f(wi.T))))
    for name, key in names.items():
        step = 2.0**-13  # which float32 adds without a rounding
        ends = [of_openpbr(wo, wi, **{key: BASE[key] + each}).sum() for each in (step, -step)]
        found = np.array(dr.grad(parameters[name])).item()
        assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-4)


@pytest.mark.parametrize(
    ("other", "message"),
    [
        ({"alpha": 0.001}, r"alpha must lie in \[0.01, 1\]; got 0.001"),
        ({"ior": 5.0}, r"ior must lie in \[1, 4\]; got 5"),
        (
            {"alpha": {"type": "checkerboard"}},
            "alpha must be one number for the surface; got Check",
        ),
    ],
)
def test_what_is_no_coat_is_refused(mi, other, message):
    with pytest.raises(Exception, match=message):
        mi.load_dict(coat(DIELECTRIC | other))


def test_a_scalar_variant_has_the_same_values_of_coats(mi):
    mi.set_variant("scalar_rgb")
    plugins.register()
    point = mi.SurfaceInteraction3f()
    point.wi = [0.6, 0.0, 0.8]
    bsdf, light = mi.load_dict(coat(DIELECTRIC)), mi.Vector3f(0.0, 0.6, 0.8)
    inputs = coated(DIELECTRIC)
    reference = models.dielectric_over_eon_brdf([0.6, 0.0, 0.8], [0.0, 0.6, 0.8], **inputs) * 0.8
    assert (
        np.abs(np.array(bsdf.eval(mi.BSDFContext(), point, light)) - reference).max()
        <= MITSUBA_EVAL
    )
    record, weight = bsdf.sample(mi.BSDFContext(), point, 0.5, mi.Point2f(0.25, 0.75))
    value = np.array(bsdf.eval(mi.BSDFContext(), point, record.wo))
    assert np.array(weight) == pytest.approx(value / bsdf.pdf(mi.BSDFContext(), point, record.wo))
    value = mi.load_dict(openpbr()).eval(mi.BSDFContext(), point, light)
    reference = of_openpbr(np.array([[0.6, 0.0, 0.8]]), np.array([[0.0, 0.6, 0.8]]))
    assert np.abs(np.array(value) - reference).max() <= MITSUBA_EVAL
