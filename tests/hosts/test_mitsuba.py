# SPDX-License-Identifier: Apache-2.0
"""The Mitsuba plugins match the models, and Mitsuba's own BSDFs match their documentation."""

import re
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest

from mxeon import check, models
from mxeon import mitsuba as plugins
from mxeon.errors import NotRun
from mxeon.shaders.scene import BACK, FRONT, SIDE, VIEW, local_directions
from mxeon.survey.facets import facet_points
from mxeon.survey.polyhedron import mitsuba
from tests.support.availability import available, package
from tests.support.cases import directions
from tests.support.command import PLASTER
from tests.support.plans import keep
from tests.support.tolerances import MITSUBA_COAT, MITSUBA_DENSITY, MITSUBA_EVAL, MITSUBA_WEIGHT
from tests.support.verdicts import PASSED, RENDERER_NODES

PAGE = Path(__file__).parents[2] / "docs" / "mitsuba.md"
COAT, VARNISH = "dielectric_over_eon", "varnished"
PARAMETERS = {"eon": "roughness", "fon": "roughness", "qon": "sigma"}
COLOR = (0.25, 0.5, 1.0)  # each value is exact in float32
SAMPLES = 100_000  # number of samples in a chi-square test
DEVIATE = 4.5  # standard deviations; the mean exceeds this limit by chance once in 150,000 tests
STEP = 2.0**-13  # sums of a few steps are exact in float32
WO, WI = np.array([[0.6, 0.0, 0.8]]), np.array([[-0.48, 0.6, 0.64]])
MODELS = {name: getattr(models, f"{name}_brdf") for name in ("eon", "fon", "qon", COAT, VARNISH)}
INPUTS = {
    **{name: {parameter: 0.4} for name, parameter in PARAMETERS.items()},
    **{key: {"roughness": 0.6, "alpha": 0.3, "ior": 1.5} for key in (COAT, VARNISH)},
}
TEXTURES = ("roughness", "sigma")


@pytest.fixture
def mi():
    """The Python module `mitsuba` in an LLVM variant, with the plugins registered."""
    mitsuba = package("mitsuba")
    mitsuba.set_variant("llvm_ad_rgb")
    with available("mitsuba"):
        plugins.register()
    return mitsuba


def bsdf(name, color=COLOR, **inputs):
    """Plugin properties. Inputs that are not given as arguments come from INPUTS."""
    rgb = {"type": "rgb", "value": list(color)}
    return {"type": name, "reflectance": rgb} | INPUTS[name] | inputs


def expected(name, wo, wi, **inputs):
    """BRDF value of the model times the cosine, with inputs rounded to float32."""
    values = {key: float(np.float32(each)) for key, each in (INPUTS[name] | inputs).items()}
    return MODELS[name](wo, wi, COLOR, **values) * np.asarray(wi, np.float64)[..., 2:]


def allowed(name, value):
    """Tolerance of a value: MITSUBA_EVAL, or a relative tolerance for large values of coats."""
    return np.maximum(MITSUBA_EVAL, MITSUBA_COAT * value if name in (COAT, VARNISH) else 0.0)


def surface(mi, wo):
    point = mi.SurfaceInteraction3f()
    point.wi = mi.Vector3f(np.asarray(wo).T)
    return point


def chi_square(mi, angle, functions):
    """Mitsuba's chi-square test of the sampling function and density that `functions` returns."""
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
        ires=8,  # the default of 4 nodes per bin misses a grazing peak
    )


def furnace(mi, bsdf, samples):
    camera = mi.ScalarTransform4f().look_at([0, 0, 5], [0, 0, 0], [0, 1, 0])
    film = {"type": "hdrfilm", "width": 32, "height": 32, "rfilter": {"type": "box"}}
    scene = {
        "type": "scene",
        "integrator": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 1},
        "sensor": {"type": "perspective", "fov": 20, "to_world": camera, "film": film},
        "sphere": {"type": "sphere", "bsdf": bsdf},
        "light": {"type": "constant", "radiance": {"type": "rgb", "value": 1.0}},
    }
    return np.array(mi.render(mi.load_dict(scene), spp=samples))


CASES = (
    *((name, {key: each}) for name, key in PARAMETERS.items() for each in (0.0, 0.3, 1.0)),
    *((name, {"alpha": alpha, "ior": ior}) for name, alpha, ior in product(
        (COAT, VARNISH), (0.015625, 0.3, 1.0), (1.02, 1.5, 4.0))),
)  # fmt: skip


@pytest.mark.parametrize("name, inputs", CASES, ids=str)
def test_values_are_those_of_the_model(mi, name, inputs):
    rng = np.random.default_rng(7)
    wo, wi = np.float32(directions((2, 512), rng, least=1e-3))
    wo[:8] = wi[-8:] = 0.0, 0.0, 1.0
    # Include lights near the mirror direction.
    wi[100:200] = wo[100:200] * [-1, -1, 1] + 0.03 * rng.normal(size=(100, 3))
    wi[:, 2] = np.abs(wi[:, 2])
    wi = (wi / np.linalg.norm(wi, axis=1, keepdims=True)).astype(np.float32)
    made, context, light = mi.load_dict(bsdf(name, **inputs)), mi.BSDFContext(), mi.Vector3f(wi.T)
    values, pdf = made.eval_pdf(context, surface(mi, wo), light)
    right = expected(name, wo, wi, **inputs)
    assert (np.abs(np.array(values).T - right) <= allowed(name, right)).all()
    assert not np.array(made.eval(context, surface(mi, wo), -light)).any()
    if name in (COAT, VARNISH):
        numbers = {key: float(np.float32(each)) for key, each in (INPUTS[name] | inputs).items()}
        density = getattr(models, f"{name}_pdf")(wo, wi, COLOR, **numbers)
        mu = wo[:, 2].astype(np.float64)
        reflected = models.dielectric_over_eon_albedo_dir(mu, 0.0, **numbers)[:, 0]
        error = np.abs(np.array(pdf) - density) / np.maximum(1.0, density)
        assert (error <= MITSUBA_COAT + MITSUBA_DENSITY / reflected).all()


@pytest.mark.parametrize("name", MODELS)
def test_a_scalar_variant_has_the_same_values(mi, name):
    mi.set_variant("scalar_rgb")
    plugins.register()
    made, point, context = mi.load_dict(bsdf(name)), mi.SurfaceInteraction3f(), mi.BSDFContext()
    point.wi = [0.6, 0.0, 0.8]
    value = np.array(made.eval(context, point, mi.Vector3f(0.0, 0.6, 0.8)))
    right = expected(name, WO, np.array([[0.0, 0.6, 0.8]]))
    assert (np.abs(value - right) <= allowed(name, right)).all()
    record, weight = made.sample(context, point, 0.5, mi.Point2f(0.25, 0.75))
    sampled = np.array(made.eval(context, point, record.wo)) / made.pdf(context, point, record.wo)
    assert np.array(weight) == pytest.approx(sampled)


@pytest.mark.parametrize("name", MODELS)
def test_gradients_are_those_of_the_model(mi, name):
    import drjit as dr

    made = mi.load_dict(bsdf(name))
    parameters = mi.traverse(made)
    names = {key: f"{key}.value" if key in TEXTURES else key for key in INPUTS[name]}
    for each in ("reflectance.value", *names.values()):
        dr.enable_grad(parameters[each])
    parameters.update()
    dr.backward(dr.sum(made.eval(mi.BSDFContext(), surface(mi, WO), mi.Vector3f(WI.T))))
    for key, each in names.items():
        middle = float(np.float32(INPUTS[name][key]))
        ends = [expected(name, WO, WI, **{key: middle + x}).sum() for x in (STEP, -STEP)]
        found = np.array(dr.grad(parameters[each])).item()
        assert found == pytest.approx((ends[0] - ends[1]) / (2.0 * STEP), rel=1e-4, abs=1e-6)
    assert np.array(dr.grad(parameters["reflectance.value"])).min() > 0.0


CHECKS = {"type": "checkerboard"}


@pytest.mark.parametrize(
    "name, inputs, message",
    [
        ("eon", {"roughness": 1.7}, r"roughness must lie in \[0, .*\]; got 1.7"),
        ("qon", {"sigma": -0.1}, r"sigma must lie in \[0, .*\]; got -0.1"),
        (COAT, {"alpha": 0.001}, r"alpha must lie in \[0.01, 1\]; got 0.001"),
        (COAT, {"ior": 5.0}, r"ior must lie in \[1, 4\]; got 5"),
        (COAT, {"alpha": CHECKS}, "alpha must be one number for the surface; got"),
    ],
)
def test_an_input_outside_its_range_is_refused(mi, name, inputs, message):
    with pytest.raises(Exception, match=message):
        mi.load_dict(bsdf(name, **inputs))


SAMPLED = [  # plugin, inputs, and polar angle of the viewer
    *(("eon", {"roughness": each}, angle) for each in (0.3, 1.0) for angle in (0.0, 0.8, 1.5)),
    *((name, {}, angle) for name in (COAT, VARNISH) for angle in (0.0, 1.4)),
]


@pytest.mark.parametrize("name, inputs, angle", SAMPLED)
def test_mitsubas_chi_square_test_accepts_the_sampling(mi, name, inputs, angle):
    color = (0.5,) * 3 if name == "eon" else COLOR
    test = chi_square(mi, angle, lambda adapter: adapter(name, bsdf(name, color, **inputs)))
    assert test.run(test_count=len(SAMPLED), quiet=True), test.messages


@pytest.mark.parametrize(("name", "lossless"), (("eon", True), ("fon", False)))
def test_a_white_furnace_keeps_its_energy(mi, name, lossless):
    off = np.abs(furnace(mi, bsdf(name, (1.0,) * 3, roughness=1.0), 4) - 1.0).max()
    assert (off <= 2 * MITSUBA_WEIGHT) == lossless


@pytest.mark.parametrize("name", (COAT, VARNISH))
@pytest.mark.parametrize("alpha", (0.05, 0.5))
def test_a_white_furnace_keeps_the_energy_of_facets_in_the_mean(mi, name, alpha):
    picture = furnace(mi, bsdf(name, (1.0,) * 3, alpha=alpha), 64)[..., 0]
    assert 1e-3 < picture.std() < 0.1
    assert abs(picture.mean() - 1.0) < DEVIATE * picture.std() / np.sqrt(picture.size)


def test_an_llvm_that_ends_the_process_is_refused_before(mi, monkeypatch):
    monkeypatch.setattr("drjit.detail.llvm_version", lambda: (15, 0, 6))
    with pytest.raises(NotRun, match="found LLVM 15, .* libllvm19.* DRJIT_LIBLLVM_PATH"):
        plugins.register()


def brightest(picture):
    """Largest mean over blocks of 8 x 8 pixels."""
    return np.array(picture).reshape(16, 8, 16, 8, 3).mean(axis=(1, 3, 4)).max()


def test_the_example_of_the_page_runs_and_shows_gloss(mi, tmp_path, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names, seen = {}, []
    for block in blocks:
        exec(block.replace("spp=16", "spp=1"), names)
        if "coated.png" in block or "ball.png" in block:
            seen.append(brightest(names["picture"]))
    assert 0.1 < np.array(names["picture"]).mean() < 1.0
    # With the lamp, the brightest block is 1.5 times as bright as without the lamp.
    assert seen[1] > 1.25 * seen[0]
    for name in ("clay", "ball", "coated"):
        assert (tmp_path / f"{name}.png").stat().st_size > 1000


# --- Mitsuba's own BSDFs, judged by pictures of faceted solids ---------------------------------

FACETS = 7e-5  # relative error of a picture, multiplied by the cosine of the light


@pytest.fixture(scope="module")
def host():
    with available("mitsuba"), mitsuba.MitsubaHost() as host:
        host.identity()
        yield host


@pytest.mark.usefixtures("host")  # skips the test if Mitsuba is missing
def test_mitsuba_has_the_models_that_it_documents(monkeypatch):
    keep(monkeypatch, lambda task: task.host == "mitsuba")
    report = check(PLASTER, ["mitsuba"], nodes=["common"])
    results = [each for each in report.results if each.library == RENDERER_NODES]
    assert {each.subject for each in results} == {each.title for each in mitsuba.NODES}
    assert {each.verdict for each in results} == {PASSED}
    assert all(each.control.caught for each in results)


@pytest.mark.parametrize("scene", [FRONT, SIDE, BACK])
def test_pictures_are_linear_and_have_float_precision(host, scene):
    """One channel is very dark, so 8-bit pixels or a tone curve would cause large errors."""
    scene = replace(scene, size=64)
    material = mitsuba.NODES[0].made((1.0, 0.02, 1e-4), 0.0)
    picture = host.node(material, scene)[facet_points(64).mask]
    normal = facet_points(scene.size).normal[facet_points(scene.size).mask]
    wo, wi = (local_directions(normal, each) for each in (VIEW, scene.light))
    mask = np.minimum(wo, wi)[:, 2] >= 0.05
    expected = wi[mask][:, 2:] * np.array([1.0, 0.02, 1e-4])
    relative = np.abs(picture[mask] / expected - 1.0) * wi[mask][:, 2:]
    assert relative.max() <= FACETS
