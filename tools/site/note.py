# SPDX-License-Identifier: Apache-2.0
"""Print the numbers of the technical note, and draw its figures: `python -m tools.site.note`."""

import numpy as np
from matplotlib.figure import Figure

from mxeon.io.files import replacing
from tools.paper.sheet import METADATA, styled
from tools.site import DOCS, with_block
from tools.site.note_measures import (
    albedo_errors,
    albedo_figures,
    energy_rows,
    fresnel_errors,
    loss_errors,
    loss_figures,
    rounding_figures,
    sampling_figures,
    variances,
)

PAGE = DOCS / "note.md"
EXACT_VARIANCE = 1.7e-10  # bound of the two fits: tools/paper/weights.py


def energy_table():
    """The table of the page."""
    head = "| equation | reading | least | largest |\n|---|---|---|---|\n"
    lines = [
        f"| {name} | {reading} | {np.min(share):.3f} | {np.max(share):.3f} |\n"
        for name, reading, share in energy_rows()
    ]
    return head + "".join(lines)


# Figures.
def exact_figure():
    """Errors of the energy that FON loses, and variance of the samples of EON."""
    figure = Figure(figsize=(7.6, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    mu = np.unique(np.geomspace(1e-6, 1.0, 400).astype(np.float32))
    errors, exact = loss_errors(mu)
    for name, error in errors.items():
        left.loglog(mu, np.maximum(np.abs(error / exact), 1e-9), label=name, linewidth=0.9)
    left.set(xlabel="$\\mu$", ylabel="relative error of $1 - E_{FON}$, float32", ylim=(1e-9, 1e3))
    left.legend()
    mu = np.cos(np.radians(np.linspace(0.0, 89.0, 60)))
    for name, title in (
        ("uniform", "uniform"),
        ("cosine", "cosine"),
        ("eon_cltc", "CLTC + uniform"),
    ):
        right.semilogy(np.degrees(np.arccos(mu)), variances(name, 1.0, mu), label=title)
    right.axhline(EXACT_VARIANCE, color="k", linestyle="--", label="exact, bound")
    right.set(xlabel="$\\theta_o$ (degrees)", ylabel="variance of the weight, $r = 1$")
    right.legend(loc="center left")
    return figure


def albedo_figure():
    """Errors of the albedo of GGX and of a dielectric over the cosine."""
    figure = Figure(figsize=(7.6, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    mu = np.geomspace(1e-3, 1.0, 120)
    for color, alpha in (("C0", 0.01), ("C1", 0.1), ("C2", 1.0)):
        theirs, ours = albedo_errors(mu, np.full_like(mu, alpha))
        left.loglog(mu, np.abs(theirs), color=color, label=f"MaterialX, $\\alpha$ = {alpha:g}")
        left.loglog(
            mu, np.abs(ours), color=color, linestyle=":", label=f"ours, $\\alpha$ = {alpha:g}"
        )
    left.set(xlabel="$\\mu$", ylabel="error of $E_{ss}$", ylim=(1e-8, 1.0))
    left.legend(ncols=2, fontsize=6)
    for name, error in fresnel_errors(mu, np.full_like(mu, 0.5)).items():
        right.loglog(mu, np.abs(error), label=name)
    right.set(
        xlabel="$\\mu$", ylabel="error of the albedo, ior 1.5, $\\alpha$ = 0.5", ylim=(1e-6, 1.0)
    )
    right.legend()
    return figure


FIGURES = {"note_exact": exact_figure, "note_albedo": albedo_figure}


def page(text):
    """The page with its table as it is now."""
    return with_block(text, "energy", energy_table())


def main():
    """Draw the figures, and print the numbers of the sentences."""
    with styled():
        for name, draw in FIGURES.items():
            with replacing(DOCS / "figures" / f"{name}.png") as path:
                draw().savefig(path, dpi=110, metadata=METADATA["png"])
    for found in (loss_figures(), rounding_figures(), sampling_figures(), albedo_figures()):
        print(*(f"{name}: {value:.3g}" for name, value in found.items()), sep="\n")


if __name__ == "__main__":
    main()
