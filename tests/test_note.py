# SPDX-License-Identifier: Apache-2.0
"""The technical note: its numbers, its table, its figures, and its entry for a bibliography."""

import re

import numpy as np
import pytest

from mxeon.models.diffuse.albedo import eon_albedo_dir, fon_albedo_avg, fon_albedo_dir
from mxeon.models.diffuse.brdf import eon_brdf, fon_brdf
from mxeon.models.diffuse.formulas import C1, C2, fon_loss
from tools.site import marks, note
from tools.site.note_measures import rounding_figures

TEXT = note.PAGE.read_text(encoding="utf-8")
ROUNDING = 1e-14


def test_the_numbers_are_those_measured_and_another_one_is_seen():
    # Errors over every float take a minute: those over a few are a little smaller.
    few = rounding_figures(stride=997)
    stated = {name: float(re.search(rf"(\S+)<!--{name}-->", TEXT)[1]) for name in few}
    assert all(0.8 * stated[name] < few[name] < 1.02 * stated[name] for name in few)
    figures = note.figures() | stated
    assert marks.wrong(TEXT, lambda: figures) == []
    wrong = TEXT.replace("2.9e-3<!--cosine dense-->", "2.8e-3<!--cosine dense-->")
    assert len(marks.wrong(wrong, lambda: figures)) == 1


def test_the_table_is_the_one_measured():
    assert note.energy_table() in TEXT


def test_the_forms_of_section_2_are_those_of_the_paper():
    rng = np.random.default_rng(3)
    wo, wi = rng.normal(size=(2, 1000, 3))
    for w in (wo, wi):
        w[:, 2] = abs(w[:, 2])
        w /= np.linalg.norm(w, axis=1, keepdims=True)
    rho, r = rng.uniform(0.05, 1.0, (2, 1000))
    E_o, E_i = (fon_albedo_dir(w[:, 2], r) for w in (wo, wi))
    average, D = fon_albedo_avg(r), 1.0 + C1 * r - rho * r * (C1 - C2)
    # Two lobes, as the paper has them.
    many = rho**2 * average / (1.0 - rho * (1.0 - average))
    lobe = many / np.pi * (1.0 - E_o) * (1.0 - E_i) / (1.0 - average)
    printed = fon_brdf(wo, wi, rho[:, None], r)[:, 0] + lobe
    assert np.allclose(eon_brdf(wo, wi, rho[:, None], r)[:, 0], printed, rtol=1e-12)
    # Equations (1) and (3).
    H = fon_loss(wo[:, 2])
    assert np.abs(1.0 - E_o - r * H / (1.0 + C1 * r)).max() < ROUNDING
    E = rho * (1.0 - r * H * (1.0 - rho) / D)
    assert np.abs(eon_albedo_dir(wo[:, 2], rho[:, None], r)[:, 0] - E).max() < ROUNDING


def test_the_entry_of_the_bibliography_names_the_note():
    [entry] = re.findall(r"```bibtex\n(.*?)```", TEXT, re.DOTALL)
    fields = dict(re.findall(r"(\w+) += \{(.*)\},?\n", entry))
    title = TEXT.partition("\n")[0].removeprefix("# ")
    assert re.sub(r"[{}]", "", fields["title"]) == title
    citation = (note.PAGE.parents[1] / "CITATION.cff").read_text(encoding="utf-8")
    assert "  - name: The mxeon authors\n" in citation  # one name for those who made it
    assert fields["author"] == "{The mxeon authors}" and entry.count("{") == entry.count("}")


@pytest.mark.parametrize("name", note.FIGURES)
def test_a_figure_is_drawn_and_on_the_page(name):
    lines = [line for axes in note.FIGURES[name]().axes for line in axes.lines]
    assert len(lines) >= 7
    assert all(np.isfinite(line.get_ydata()).any() for line in lines)
    assert f"(figures/{name}.png)" in TEXT
    assert (note.FOLDER / "figures" / f"{name}.png").is_file()
