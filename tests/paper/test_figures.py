# SPDX-License-Identifier: Apache-2.0
"""`mxeon figures`: every figure, and the page of claims."""

import csv
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import tools.paper as figures
from mxeon.cli import main
from mxeon.models import table
from mxeon.models.diffuse.brdf import lambert_brdf
from mxeon.shaders import library
from tools.paper import FIGURES, SECTIONS, claims, curves, renders, tracer
from tools.paper.claims import FAILS, HOLDS, IN_PART, inversion, sampling, specification, verdict

SMALL = {"size": 16, "samples": 2, "draws": 100}
RENDERS = ("01", "02", "04a", "04b", "05", "08", "09", "10", "14")
# The claims that cost little to measure; the bounds of all others are applied by the same function.
QUICK = (*inversion.SECTION.claims, *specification.SECTION.claims)
CURVES = ("03", "06", "07", "11", "13", "15")
# Claims of the paper and of the specification that no measured value satisfies.
REFUTED = {
    "with it the albedo stays at most 1",
    "its exact albedo is exact in float32, to 1e-6",
    "the variance of cosine sampling has a peak",
    "no sample below the horizon",
    "defined for u1 in [0, 1] and r in [0, 1]",
    "within 0.3 %",
    "the B of Oren and Nayar, 0 at sigma = 0",
    "the g of Oren and Nayar",
    "Fresnel's equations",
    "r0 at normal incidence",
    "reflects no more than it receives",
}


@pytest.fixture(scope="module")
def output(tmp_path_factory, gl):
    """A small run: its page, its folder of figures and the steps it reported."""
    steps = []
    folder = tmp_path_factory.mktemp("figures")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(sampling, "DEGREES", sampling.DEGREES[[*range(0, 30, 2), -2, -1]])
        page = figures.figures(
            folder, lambda all_steps: steps.extend(all_steps) or all_steps, **SMALL
        )
    return SimpleNamespace(page=page.read_text(), folder=folder / "figures", steps=steps)


@pytest.mark.parametrize("number", RENDERS)
def test_each_render_leaves_a_linear_picture_and_a_plot(output, number):
    assert (output.folder / f"figure_{number}.exr").stat().st_size > 0
    assert (output.folder / f"figure_{number}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("number", CURVES)
def test_each_plot_of_curves_is_a_drawing_with_data(output, number):
    assert "<svg" in (output.folder / f"figure_{number}.svg").read_text()
    assert list(output.folder.glob(f"figure_{number}*.csv"))


def test_tables_hold_one_number_for_each_column(output):
    for path in output.folder.glob("*.csv"):
        head, *rows = csv.reader(path.read_text().splitlines())
        assert rows and all(len(row) == len(head) for row in rows)
        assert np.isfinite(np.float64(rows)).all()


def test_every_step_is_reported(output):
    assert output.steps == [*FIGURES, claims.page]


def test_page_holds_every_claim_with_a_bound_and_a_verdict(output):
    rows = re.findall(r"^\| .* \|$", output.page, re.MULTILINE)
    assert len(rows) == sum(len(section.claims) for section in SECTIONS) + len(SECTIONS)
    assert all(row.count(" | ") == 4 for row in rows)


def test_counts_of_the_page_are_those_of_its_verdicts(output):
    sections = output.page.split("\n## ")[1 : len(SECTIONS) + 1]
    for text in sections:
        verdicts = re.findall(r"\| ([^|]*) \|$", text, re.MULTILINE)
        tally = [verdicts.count(each) for each in (HOLDS, IN_PART, FAILS)]
        counts = re.search(r"^(\d+) claims: (\d+) hold, (\d+) hold in part, (\d+) fail", text, re.M)
        assert [int(count) for count in counts.groups()] == [sum(tally), *tally]


@pytest.mark.parametrize("claim", QUICK, ids=lambda claim: f"{claim.where}: {claim.text}")
def test_verdict_of_a_claim_follows_its_bound(claim):
    never, always = (
        replace(claim, least=np.inf, most=np.inf),
        replace(claim, least=-np.inf, most=np.inf),
    )
    assert never.row()[-1] == FAILS
    assert always.row()[-1] == HOLDS


@pytest.mark.parametrize(
    "values, expected",
    [(1.0, HOLDS), ([1.0, 2.0], HOLDS), ([1.0, 3.0], IN_PART), ([3.0, -1.0], FAILS)]
    + [(np.nan, FAILS), ([1.0, np.nan], IN_PART), (np.inf, FAILS)],
)
def test_verdict_says_how_many_values_lie_within_the_bound(values, expected):
    assert verdict(values, 0.0, 2.0) == expected


def test_page_shows_every_plot(output):
    shown = set(re.findall(r"\]\(figures/(\S+)\)", output.page))
    assert shown == {
        path.name for path in output.folder.iterdir() if path.suffix in (".svg", ".png")
    }


def test_measurements_refute_these_claims_and_no_others(output):
    row = re.compile(r"^\| [^|]* \| ([^|]*) \| [^|]* \| [^|]* \| \*\*fails\*\* \|$", re.MULTILINE)
    assert set(row.findall(output.page)) == REFUTED


@pytest.fixture
def tables(monkeypatch, tmp_path):
    """A sheet that keeps tables alone: what plots look like does not matter."""
    monkeypatch.setattr(figures.Sheet, "plot", lambda *_: None)
    return figures.Sheet(tmp_path, host=None, **SMALL)


def test_a_model_without_a_shader_function_is_compared_by_its_title(monkeypatch, tables):
    models = (*table.MODELS, table.Model("flat", "A flat model", lambert_brdf, None))
    monkeypatch.setattr(table, "MODELS", models)
    monkeypatch.setattr(curves, "MODELS", models)
    with figures.styled():
        curves.comparison(tables)
    header = (tables.folder / "figure_03.csv").read_text().partition("\n")[0]
    assert "flat theta_i=15 phi=0" in header
    assert curves.label("flat") == "A flat model"


def test_figure_4_names_models_that_the_tracer_has():
    assert set().union(*renders.GALLERY.values()) <= set(tracer.MODELS)


def test_same_run_writes_the_same_tables(output, tables):
    with figures.styled():
        figures.weights.over_roughness(tables)
    again = (tables.folder / "figure_13.csv").read_text()
    assert again == (output.folder / "figure_13.csv").read_text()


def test_the_command_finds_the_folder_in_a_checkout(monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(figures, "figures", lambda folder, progress: f"{folder}/paper_checked.md")
    assert main(["figures", "out"]) == 0
    assert capsys.readouterr().out == "out/paper_checked.md\n"


def test_the_command_in_an_installed_package_asks_for_a_checkout(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(library, "data_folder", lambda: tmp_path)
    assert main(["figures", "out"]) == 3
    assert "install a checkout of the repository" in capsys.readouterr().err
