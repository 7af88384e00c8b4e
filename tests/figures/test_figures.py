# SPDX-License-Identifier: Apache-2.0
"""`mxeon figures`: every figure and the page of claims, made small."""

import csv
import re
from types import SimpleNamespace

import numpy as np
import pytest

from mxeon import figures
from mxeon.figures import CLAIMS, FIGURES, claims

SMALL = {"size": 16, "samples": 2, "draws": 100}
RENDERS = ("01", "02", "04a", "04b", "05", "08", "09", "10", "14")
CURVES = ("03", "06", "07", "11", "13", "15")
# Claims of the paper and of the specification that measurements refute.
REFUTED = {
    "with it the albedo stays at most 1",
    "its exact albedo is exact in float32, to 1e-6",
    "the variance of cosine sampling has a peak",
    "no sample below the horizon",
    "defined for u1 in [0, 1] and r in [0, 1]",
    "within 0.3 %",
    "the B of Oren and Nayar, 0 at sigma = 0",
    "the g of Oren and Nayar",
    "a radiance",
    "Fresnel's equations",
    "r0 at normal incidence",
    "reflects no more than it receives",
}


@pytest.fixture(scope="module")
def made(tmp_path_factory, gl):
    """A small run: its page, its folder of figures and the steps it reported."""
    steps = []
    folder = tmp_path_factory.mktemp("figures")
    page = figures.figures(folder, lambda all_steps: steps.extend(all_steps) or all_steps, **SMALL)
    return SimpleNamespace(page=page.read_text(), folder=folder / "figures", steps=steps)


@pytest.mark.parametrize("number", RENDERS)
def test_each_render_leaves_a_linear_picture_and_a_plot(made, number):
    assert (made.folder / f"figure_{number}.exr").stat().st_size > 0
    assert (made.folder / f"figure_{number}.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("number", CURVES)
def test_each_plot_of_curves_is_a_drawing_with_data(made, number):
    assert "<svg" in (made.folder / f"figure_{number}.svg").read_text()
    assert list(made.folder.glob(f"figure_{number}*.csv"))


def test_tables_hold_one_number_for_each_column(made):
    for path in made.folder.glob("*.csv"):
        head, *rows = csv.reader(path.read_text().splitlines())
        assert rows and all(len(row) == len(head) for row in rows)
        assert np.isfinite(np.float64(rows)).all()


def test_every_step_is_reported(made):
    assert made.steps == [*FIGURES, claims.page]


def test_page_holds_every_claim_with_a_verdict(made):
    rows = re.findall(r"^\| .* \|$", made.page, re.MULTILINE)
    assert len(rows) == sum(map(len, CLAIMS.values())) + len(CLAIMS)
    assert all(row.count(" | ") == 3 for row in rows)


def test_page_shows_every_plot(made):
    shown = set(re.findall(r"\]\(figures/(\S+)\)", made.page))
    assert shown == {path.name for path in made.folder.iterdir() if path.suffix in (".svg", ".png")}


def test_refuted_claims_are_those_that_are_known(made):
    row = re.compile(r"^\| [^|]* \| ([^|]*) \| [^|]* \| \*\*fails\*\* \|$", re.MULTILINE)
    failed = row.findall(made.page)
    assert set(failed) == REFUTED


def test_same_run_writes_the_same_tables(made, tmp_path):
    with figures.styled():
        figures.weights.over_roughness(figures.Sheet(tmp_path, host=None, **SMALL))
    again = (tmp_path / "figure_13.csv").read_text()
    assert again == (made.folder / "figure_13.csv").read_text()
