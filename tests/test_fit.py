# SPDX-License-Identifier: Apache-2.0
"""Fits of measured BRDFs state the errors of parameters, read MERL files, and refuse bad inputs."""

import re
import runpy
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import mxeon
from mxeon.errors import InputError, PackageError
from mxeon.fit import MERL_CELLS, MERL_SCALES, MeasuredBrdf, fit_brdf, merl_directions, read_merl
from mxeon.models import eon_brdf
from tests.support.availability import available, package
from tests.support.cases import directions
from tools.site import research

EXAMPLE = Path(__file__).parents[1] / "examples" / "fit_measured.py"
SEED = 5
CLAY = {"color": np.array([0.7, 0.35, 0.12]), "roughness": 0.62}
COATED = CLAY | {"alpha": 0.3, "ior": 1.5}
PAGE_COAT = {"color": [0.55, 0.28, 0.18], "roughness": 0.7, "alpha": 0.25, "ior": 1.45}
NOISE = 0.05
# 24 fits have 4 or 6 normal deviates each. By chance, a deviate exceeds 4.5 in one of 1200 runs,
# and the spread of 96 deviates is off by more than 30 % in one of 10,000 runs.
LARGEST_DEVIATE, FITS, SPREAD = 4.5, 24, (0.7, 1.3)


def noisy(rng, model, parameters, count=200, known=True):
    """Simulated measurement with normal noise. If `known` is true, the data state the noise."""
    wo, wi = directions((2, count), rng, least=0.05)
    value = mxeon.model(model).brdf(wo, wi, **parameters)
    error = NOISE * (value if known else np.full_like(value, 0.2))
    value = value + error * rng.normal(size=value.shape)
    return MeasuredBrdf(wo, wi, value, error if known else None)


def deviates(fit, parameters):
    """Differences of fitted and true parameters, divided by the errors that the fit reports."""
    found = [(fit.values[name] - parameters[name]) / fit.errors[name] for name in fit.values]
    return np.hstack(found)


@pytest.mark.parametrize("known", (True, False))
def test_the_parameters_of_eon_lie_within_their_errors(known):
    rng = np.random.default_rng(SEED)
    fits = [fit_brdf(noisy(rng, "eon", CLAY, known=known)) for _ in range(FITS)]
    off = np.concatenate([deviates(fit, CLAY) for fit in fits])
    assert np.abs(off).max() < LARGEST_DEVIATE
    assert SPREAD[0] < off.std() < SPREAD[1]
    scatter = np.mean([fit.scatter for fit in fits])
    assert scatter == pytest.approx(1.0 if known else 0.2 * NOISE, rel=0.05)


def test_the_parameters_of_a_dielectric_over_eon_lie_within_their_errors():
    data = noisy(np.random.default_rng(SEED), "dielectric_over_eon", COATED)
    fit = fit_brdf(data, "dielectric_over_eon")
    assert np.abs(deviates(fit, COATED)).max() < LARGEST_DEVIATE
    assert max(each.max() for each in fit.errors.values()) < 0.1
    other = fit_brdf(data, "eon")  # control: EON must not fit data of another model
    assert fit.fits and not other.fits and other.scatter > 2.0
    first = str(other).splitlines()[0]
    assert first.endswith(": the model does not fit; its errors assume that it does")


def test_a_fit_says_its_parameters_and_evaluates_its_model():
    data = noisy(np.random.default_rng(SEED), "eon", CLAY)
    fit = fit_brdf(data)
    title, color, roughness = str(fit).splitlines()
    assert title.startswith("eon, scatter ") and color.count("+-") == 3 and "roughness" in roughness
    expected = eon_brdf(data.wo, data.wi, fit.values["color"], fit.values["roughness"])
    assert np.array_equal(fit.brdf(data.wo, data.wi), expected)
    assert np.array_equal(mxeon.model(fit.model).brdf(data.wo, data.wi, **fit.values), expected)
    one = fit.brdf(data.wo[0], data.wi[0])
    assert one.shape == (3,) and np.array_equal(one, expected[0])
    assert fit.brdf(data.wo[0], data.wi).shape == expected.shape
    assert fit.brdf(data.wo[:4, np.newaxis], data.wi).shape == (4, *expected.shape)


SIDES = np.array([[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, 0.0, 1.0]])
ONE = MeasuredBrdf(SIDES[:1], SIDES[1:2], np.array([[0.2, 0.1, 0.05]]), np.array(0.001))


@pytest.mark.parametrize(
    ("data", "numbers"),
    (
        (ONE, 0),  # there are fewer values than parameters
        (replace(ONE, error=None), 0),
        (MeasuredBrdf(*(np.repeat(each, 2, 0) for each in (ONE.wo, ONE.wi, ONE.value))), 0),
        # Measurements of a black surface determine only the color.
        (MeasuredBrdf(SIDES, SIDES[::-1], np.zeros((3, 1)), 0.001), 1),
    ),
)
def test_a_parameter_that_the_data_do_not_determine_has_no_number(data, numbers):
    assert str(fit_brdf(data)).count("+-") == numbers


# --- MERL files ------------------------------------------------------------------------------


def merl_file(path, value, cells=MERL_CELLS):
    grid = np.meshgrid(*((np.arange(n) + 0.5) / n for n in MERL_CELLS), indexing="ij")
    h, d, phi = (each.ravel() for each in grid)
    wo, wi = merl_directions(0.5 * np.pi * h**2, 0.5 * np.pi * d, np.pi * phi)
    above = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0)
    values = np.full((3, len(h)), -1.0)
    values[:, above] = value(wo[above], wi[above]).T / np.array(MERL_SCALES)[:, np.newaxis]
    path.write_bytes(np.array(cells, "<i4").tobytes() + values.astype("<f8").tobytes())
    return path


def test_a_file_of_merl_is_read_and_fitted(tmp_path):
    path = merl_file(tmp_path / "clay.binary", lambda wo, wi: eon_brdf(wo, wi, *CLAY.values()))
    data = read_merl(path, 15)
    assert len(data.wo) > 200 and (data.wo[:, 2] > 0.0).all()
    fit = fit_brdf(data)
    assert fit.values["color"] == pytest.approx(CLAY["color"], abs=1e-6)
    assert fit.values["roughness"] == pytest.approx(CLAY["roughness"], abs=1e-6)


# --- refused inputs --------------------------------------------------------------------------

UP = np.array([[0.0, 0.0, 1.0]])
# Bad inputs, by error message: fields of a measurement, or bytes of a file.
BAD = {
    "wo, wi must have shape (N, 3); got (3,), (1, 3)": {"wo": UP[0]},
    "value must have shape (1, C); got (3,)": {"value": [0.2, 0.1, 0.05]},
    "value must be finite; got nan at index (0, 1)": {"value": [[0.2, np.nan, 0.05]]},
    "error must broadcast to the shape of value, (1, 3); got (7,)": {"error": np.ones(7)},
    "error must be above 0; got 0.0 at index (2,)": {"error": [0.1, 0.1, 0.0]},
    "error must be above 0; got -1.0": {"error": -1.0},
    "got 3 that start with 616263": b"abc",
}


@pytest.mark.parametrize("message", BAD)
def test_a_measurement_that_cannot_be_used_is_refused(message, tmp_path):
    path, bad = tmp_path / "bad.binary", BAD[message]
    path.write_bytes(bad if isinstance(bad, bytes) else b"")
    with pytest.raises(InputError, match=f"{re.escape(message)}$"):
        replace(ONE, **bad) if isinstance(bad, dict) else read_merl(path)


def test_scipy_is_named_where_it_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "scipy.optimize", None)
    with pytest.raises(PackageError, match=r"pip install '\.\[fit\]'"):
        fit_brdf(MeasuredBrdf(UP, UP, np.array([[0.1]])))


def test_the_example_finds_what_it_put_in(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["fit_measured.py", "--out", str(tmp_path)])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    found = {line.split()[0]: line.split()[1:] for line in lines[4:-1]}
    clay = runpy.run_path(str(EXAMPLE))["CLAY"]
    for name in ("roughness", "alpha", "ior"):
        value, error = float(found[name][0]), float(found[name][2])
        assert abs(value - clay[name]) < LARGEST_DEVIATE * error + 5e-5
    assert (tmp_path / "fit.png").stat().st_size > 10_000


# --- the examples in the documentation -------------------------------------------------------


def test_the_blocks_of_the_page_run_one_after_another(tmp_path, monkeypatch, capsys):
    for name in ("torch", "array_api_compat", "mitsuba"):
        package(name)
    monkeypatch.chdir(tmp_path)
    names = {}
    weights = []
    for block in research.blocks(research.PAGE.read_text(encoding="utf-8")):
        with available("mitsuba"):
            exec(block.replace("spp=16", "spp=1"), names)
        if "weight = " in block:
            weights.append(names["weight"].mean(axis=0))
    fitted = names["fit"].values
    by_gradients = names["torch"].sigmoid(names["x"]).tolist()
    assert by_gradients == pytest.approx([*fitted["color"], fitted["roughness"]], abs=1e-5)
    J, errors = names["J"].numpy(), names["fit"].errors
    found = np.sqrt(np.linalg.inv(J.T @ J).diagonal())
    assert found == pytest.approx([*errors["color"], errors["roughness"]], rel=1e-3)
    albedo = names["eon_albedo_dir"](0.8, fitted["color"], fitted["roughness"])
    # The mean weight has a standard deviation of 0.4 %.
    assert weights[0] == pytest.approx(albedo, rel=0.02)
    coated = names["coated"]
    assert np.abs(deviates(coated, PAGE_COAT)).max() < LARGEST_DEVIATE and coated.fits
    albedo = names["coat"].albedo_dir(0.8, **coated.values)
    # The mean weight has a standard deviation of 1.5 %.
    assert weights[1] == pytest.approx(albedo, rel=0.1)
    pictures = ("rendered.png", "coated.png")
    assert all((tmp_path / name).stat().st_size > 1000 for name in pictures)
