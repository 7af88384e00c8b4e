# SPDX-License-Identifier: Apache-2.0
"""EON, FON and QON as plugins of Mitsuba: values, sampling, energy and gradients."""

import re
import sys
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from mxeon import mitsuba as plugins
from mxeon import models
from mxeon.errors import NotRun, PackageError
from tests.support.bsdfs import (
    COLOR,
    PAIRS,
    PARAMETERS,
    SEED,
    chi_square,
    directions,
    furnace,
    material,
    surface,
)
from tests.support.tolerances import MITSUBA_EVAL, MITSUBA_WEIGHT
from tools.benchmarks import mitsuba_noise

PAGE = Path(__file__).parents[2] / "docs" / "mitsuba.md"
ANGLES = (0.0, 0.8, 1.5)


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


def brightest(picture):
    """Largest mean of 8 x 8 pixels."""
    pixels = np.array(picture)
    return pixels.reshape(16, 8, 16, 8, 3).mean(axis=(1, 3, 4)).max()


def test_the_example_of_the_page_runs_and_shows_gloss(mi, tmp_path, monkeypatch):
    blocks = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    names, seen = {}, []
    for block in blocks:
        exec(block.replace("spp=16", "spp=1"), names)
        if "coated.png" in block or "ball.png" in block:
            seen.append(brightest(names["picture"]))
    assert 0.1 < np.array(names["picture"]).mean() < 1.0
    assert seen[1] > 1.25 * seen[0]  # 1.5 measured, and 1 without a lamp
    for name in ("clay", "ball", "coated"):
        assert (tmp_path / f"{name}.png").stat().st_size > 1000
