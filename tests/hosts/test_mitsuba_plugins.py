# SPDX-License-Identifier: Apache-2.0
"""EON, FON, QON and a coat over EON as plugins of Mitsuba: values, sampling, energy and gradients."""

import re
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from benchmarks import mitsuba_noise
from mxeon import mitsuba as plugins
from mxeon import models
from mxeon.errors import NotRun, PackageError
from tests.support.availability import available
from tests.support.tolerances import MITSUBA_COAT, MITSUBA_DENSITY, MITSUBA_EVAL, MITSUBA_WEIGHT

PAGE = Path(__file__).parents[2] / "docs" / "mitsuba.md"
PARAMETERS = {"eon": "roughness", "fon": "roughness", "qon": "sigma"}
COLOR = (0.25, 0.5, 1.0)  # exact in float32
PAIRS, SEED = 512, 7
SAMPLES = 100_000  # of a chi-square test
ANGLES = (0.0, 0.8, 1.5)
COAT = "dielectric_over_eon"
DIELECTRIC = {"alpha": 0.3, "ior": 1.5}
DEVIATE = 4.5  # of a mean: exceeded once in 150,000 times


@pytest.fixture
def mi():
    """Mitsuba in an LLVM variant, with the plugins."""
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("llvm_ad_rgb")
    with available("mitsuba"):
        plugins.register()
    return mitsuba


def material(name, amount, color=COLOR):
    reflectance = {"type": "rgb", "value": list(color)}
    return {"type": name, "reflectance": reflectance, PARAMETERS[name]: amount}


def directions(rng):
    """Unit vectors in float32, some of them along the normal or grazing."""
    w = rng.normal(size=(PAIRS, 3))
    w[:, 2] = np.abs(w[:, 2])
    w[:8], w[8:16, 2] = (0.0, 0.0, 1.0), 1e-3
    return (w / np.linalg.norm(w, axis=1, keepdims=True)).astype(np.float32)


def surface(mi, wo):
    """Points that are seen from these directions."""
    point = mi.SurfaceInteraction3f()
    point.wi = mi.Vector3f(np.asarray(wo).T)
    return point


def expected(name, wo, wi, amount):
    f = getattr(models, f"{name}_brdf")(wo, wi, COLOR, float(np.float32(amount)))
    return f * np.asarray(wi, np.float64)[..., 2:]


@pytest.mark.parametrize("amount", (0.0, 0.3, 1.0))
@pytest.mark.parametrize("name", PARAMETERS)
def test_values_are_those_of_the_model(mi, name, amount):
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng), directions(rng)[::-1].copy()
    bsdf = mi.load_dict(material(name, amount))
    light = mi.Vector3f(wi.T)
    values = np.array(bsdf.eval(mi.BSDFContext(), surface(mi, wo), light)).T
    assert np.abs(values - expected(name, wo, wi, amount)).max() <= MITSUBA_EVAL
    behind = bsdf.eval(mi.BSDFContext(), surface(mi, wo), -light)
    assert not np.array(behind).any()


def test_the_benchmark_samples_the_same_values_by_the_cosine(mi):
    mitsuba_noise.register_both(mi)
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng), directions(rng)[::-1].copy()
    exact, cosine = (
        mi.load_dict(mitsuba_noise.eon(kind, COLOR, 0.7))
        for kind in (mitsuba_noise.EXACT, mitsuba_noise.COSINE)
    )
    context, point, light = mi.BSDFContext(), surface(mi, wo), mi.Vector3f(wi.T)
    values = [np.array(each.eval(context, point, light)) for each in (exact, cosine)]
    assert np.array_equal(*values)
    assert np.allclose(np.array(cosine.pdf(context, point, light)), wi[:, 2] / np.pi, 1e-6)


@pytest.mark.parametrize("name, value", [("eon", 1.7), ("qon", -0.1)])
def test_a_parameter_outside_its_range_is_refused(mi, name, value):
    with pytest.raises(Exception, match=rf"{PARAMETERS[name]} must lie in \[0, .*\]; got {value}"):
        mi.load_dict(material(name, value))


def test_a_scalar_variant_has_the_same_values(mi):
    mi.set_variant("scalar_rgb")
    plugins.register()
    bsdf, point = mi.load_dict(material("eon", 0.3)), mi.SurfaceInteraction3f()
    point.wi = [0.6, 0.0, 0.8]
    value = bsdf.eval(mi.BSDFContext(), point, mi.Vector3f(0.0, 0.6, 0.8))
    reference = expected("eon", [0.6, 0.0, 0.8], [0.0, 0.6, 0.8], 0.3)
    assert np.abs(np.array(value) - reference).max() <= MITSUBA_EVAL
    _, weight = bsdf.sample(mi.BSDFContext(), point, 0.5, mi.Point2f(0.25, 0.75))
    assert np.array(weight).min() > 0.2
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


@pytest.mark.parametrize("amount", (0.3, 1.0))
@pytest.mark.parametrize("angle", ANGLES)
def test_mitsubas_chi_square_test_accepts_the_sampling_of_eon(mi, angle, amount):
    test = chi_square(
        mi, angle, lambda adapter: adapter("eon", material("eon", amount, (0.5,) * 3))
    )
    assert test.run(test_count=2 * len(ANGLES), quiet=True), test.messages


def test_mitsubas_chi_square_test_refuses_the_density_of_another_roughness(mi):
    def mismatched(adapter):
        rough, smooth = (adapter("eon", material("eon", each, (0.5,) * 3)) for each in (1.0, 0.5))
        return rough[0], smooth[1]

    assert not chi_square(mi, 0.8, mismatched).run(test_count=2 * len(ANGLES), quiet=True)


@pytest.mark.parametrize("angle", (0.0, 1.4))
def test_mitsubas_chi_square_test_accepts_the_sampling_of_a_coat(mi, angle):
    test = chi_square(mi, angle, lambda adapter: adapter(COAT, coat(DIELECTRIC)))
    assert test.run(test_count=2, quiet=True), test.messages


def test_mitsubas_chi_square_test_refuses_the_density_of_another_coat(mi):
    def mismatched(adapter):
        rough, smooth = (adapter(COAT, coat(DIELECTRIC | {"alpha": a})) for a in (0.3, 0.6))
        return rough[0], smooth[1]

    assert not chi_square(mi, 0.8, mismatched).run(test_count=2, quiet=True)


def chi_square(mi, angle, functions):
    """Mitsuba's test of the pair of functions that its adapter makes of a BSDF."""
    from mitsuba.chi2 import BSDFAdapter, ChiSquareTest, SphericalDomain

    wi = [float(0.8 * np.sin(angle)), float(0.6 * np.sin(angle)), float(np.cos(angle))]
    sample, pdf = functions(lambda *arguments: BSDFAdapter(*arguments, wi=wi))
    return ChiSquareTest(
        domain=SphericalDomain(),
        sample_func=sample,
        pdf_func=pdf,
        sample_dim=3,
        sample_count=SAMPLES,
        res=31,
        ires=8,  # a peak at grazing takes more than 4 nodes of a bin
    )


@pytest.mark.parametrize("amount", (0.0, 0.5, 1.0))
def test_every_sample_of_a_white_surface_has_the_weight_1(mi, amount):
    rng = np.random.default_rng(SEED)
    bsdf = mi.load_dict(material("eon", amount, (1.0,) * 3))
    u = mi.Float(rng.random(PAIRS)), mi.Point2f(rng.random((2, PAIRS)))
    record, weight = bsdf.sample(mi.BSDFContext(), surface(mi, directions(rng)), *u)
    assert np.abs(np.array(weight) - 1.0).max() <= MITSUBA_WEIGHT
    assert np.array(record.pdf).min() > 0.0


@pytest.mark.parametrize(("name", "lossless"), (("eon", True), ("fon", False)))
def test_a_white_furnace_keeps_its_energy(mi, name, lossless):
    off = np.abs(furnace(mi, material(name, 1.0, (1.0,) * 3), 4) - 1.0).max()
    assert (off <= 2 * MITSUBA_WEIGHT) == lossless


@pytest.mark.parametrize("alpha", (0.05, 0.5))
def test_a_white_furnace_keeps_the_energy_of_a_coat_in_the_mean(mi, alpha):
    picture = furnace(mi, coat(DIELECTRIC | {"alpha": alpha}, (1.0,) * 3), 64)[..., 0]
    assert 1e-3 < picture.std() < 0.1
    assert abs(picture.mean() - 1.0) < DEVIATE * picture.std() / np.sqrt(picture.size)


def furnace(mi, bsdf, samples):
    """Picture of a sphere in a white environment."""
    camera = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"}}
    picture = mi.render(
        mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1},
                "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": film},
                "sphere": {"type": "sphere", "bsdf": bsdf},
                "light": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
            }
        ),
        spp=samples,
    )
    return np.array(picture)


@pytest.mark.parametrize("name", PARAMETERS)
def test_gradients_are_those_of_the_model(mi, name):
    import drjit as dr

    amount, wo, wi = 0.4, np.array([[0.6, 0.0, 0.8]]), np.array([[-0.48, 0.6, 0.64]])
    bsdf = mi.load_dict(material(name, amount))
    parameters = mi.traverse(bsdf)
    for each in ("reflectance.value", f"{PARAMETERS[name]}.value"):
        dr.enable_grad(parameters[each])
    parameters.update()
    value = bsdf.eval(mi.BSDFContext(), surface(mi, wo), mi.Vector3f(wi.T))
    dr.backward(dr.sum(value))
    step = 1e-4
    ends = [expected(name, wo, wi, np.float64(amount) + each).sum() for each in (step, -step)]
    slope = (ends[0] - ends[1]) / (
        np.float64(np.float32(amount + step)) - np.float32(amount - step)
    )
    found = np.array(dr.grad(parameters[f"{PARAMETERS[name]}.value"])).item()
    assert found == pytest.approx(slope, abs=1e-6)
    assert np.array(dr.grad(parameters["reflectance.value"])).min() > 0.0


def coat(dielectric, color=COLOR):
    return material("eon", 0.6, color) | {"type": COAT} | dielectric


def coated(dielectric):
    """Inputs of the model, as float32 has them."""
    inputs = {name: float(np.float32(value)) for name, value in dielectric.items()}
    return {"rho": COLOR, "roughness": float(np.float32(0.6))} | inputs


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
    reflected = models.dielectric_albedo_dir(wo, 1.0, inputs["alpha"], inputs["ior"])[:, 0]
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


def test_an_llvm_that_ends_the_process_is_refused_before(mi, monkeypatch):
    monkeypatch.setattr("drjit.detail.llvm_version", lambda: (15, 0, 6))
    with pytest.raises(NotRun, match="found LLVM 15, .* libllvm19.* DRJIT_LIBLLVM_PATH"):
        plugins.register()


def test_a_variant_has_to_be_set_first(monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", SimpleNamespace(variant=lambda: None))
    with pytest.raises(NotRun, match=r"call mitsuba.set_variant\('llvm_ad_rgb'\) first"):
        plugins.register()


def test_mitsuba_is_named_where_it_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "mitsuba", None)
    with pytest.raises(PackageError, match=r"pip install '\.\[mitsuba\]'"):
        plugins.register()


def test_the_example_of_the_page_runs(mi, tmp_path, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in blocks:
        exec(block.replace("spp=16", "spp=1"), names)
    assert 0.1 < np.array(names["picture"]).mean() < 1.0
    assert (tmp_path / "clay.png").stat().st_size > 1000
