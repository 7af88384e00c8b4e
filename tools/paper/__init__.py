# SPDX-License-Identifier: Apache-2.0
"""The figures of [Portsmouth2025] as data and as plots, and the page "The paper, checked"."""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path
from typing import Any

from mxeon.hosts.gl import GlHost
from mxeon.io.files import write_text
from tools.paper import claims, curves, renders, weights
from tools.paper.claims import inversion as claims_inversion
from tools.paper.claims import models as claims_models
from tools.paper.claims import sampling as claims_sampling
from tools.paper.claims import specification as claims_specification
from tools.paper.sheet import Sheet, styled

# In the order of the paper.
FIGURES = (
    renders.title,
    renders.backscattering,
    curves.comparison,
    renders.gallery,
    curves.qon_albedos,
    curves.fon_albedos,
    renders.furnaces,
    renders.lobes,
    weights.over_angle,
    weights.over_roughness,
    renders.noise,
    curves.inverted,
)
SECTIONS = (
    claims_models.SECTION,
    claims_sampling.SECTION,
    claims_inversion.SECTION,
    claims_specification.SECTION,
)


def figures(
    folder: str | PathLike[str],
    progress: Callable[[Sequence[Any]], Iterable[Any]] = iter,
    **work: Any,
) -> Path:
    """Write every figure to `folder`/figures, and `folder`/paper_checked.md."""
    folder = Path(folder)
    sheet = replace(Sheet(folder / "figures", GlHost()), **work)
    page = folder / "paper_checked.md"
    with styled():
        for step in progress((*FIGURES, claims.page)):
            if step is claims.page:
                write_text(page, claims.page(SECTIONS) + _gallery(sheet.folder))
            else:
                step(sheet)
    return page


def _gallery(folder: Path) -> str:
    """Every plot below the description of its figure, as Markdown."""
    lines = ["", "## The figures", ""]
    for step in FIGURES:
        caption = str(step.__doc__)
        lines += [caption, ""]
        for number in re.findall(r"\d+", caption.partition(":")[0]):
            plots = sorted(folder.glob(f"figure_{number:0>2}*.[ps][nv]g"))
            lines += [f"![Figure {number}]({folder.name}/{plot.name})" for plot in plots] + [""]
    return "\n".join(lines)
