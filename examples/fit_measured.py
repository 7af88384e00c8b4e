# SPDX-License-Identifier: Apache-2.0
"""Fits a measured BRDF and draws its lobes: `python fit_measured.py [FILE.binary] [--out FOLDER]`.

FILE is a material of the MERL database. Without FILE, the script writes a file with noisy values of
a coated clay, so that the fit can be compared with the parameters of the clay. The script needs
scipy and matplotlib: `pip install '.[fit,report]'` in a checkout.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np

import mxeon
from mxeon.fit import MERL_CELLS, MERL_SCALES, fit_brdf, merl_directions, read_merl

CLAY = {"color": [0.55, 0.28, 0.18], "roughness": 0.7, "alpha": 0.25, "ior": 1.45}
NOISE, FLOOR, SEED = 0.03, 1e-4, 20261122  # relative noise, and additional noise in 1/sr
STEP = 9  # stride over the cells of each angle
VIEW = np.radians(50.0)  # polar angle of the viewer in the plot


def write_clay(path):
    """Write noisy values of the coated clay as a MERL file."""
    rng, values = np.random.default_rng(SEED), np.full((3, *MERL_CELLS), -1.0)
    cells = np.meshgrid(*(np.arange(STEP // 2, n, STEP) for n in MERL_CELLS), indexing="ij")
    h, d, phi = ((each.ravel() + 0.5) / n for each, n in zip(cells, MERL_CELLS, strict=True))
    wo, wi = merl_directions(0.5 * np.pi * h**2, 0.5 * np.pi * d, np.pi * phi)
    above = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0)
    clay = mxeon.model("dielectric_over_eon").brdf(wo[above], wi[above], **CLAY)
    clay = clay + (NOISE * clay + FLOOR) * rng.normal(size=clay.shape)
    values[:, *(each.ravel()[above] for each in cells)] = (clay / MERL_SCALES).T
    path.write_bytes(np.array(MERL_CELLS, "<i4").tobytes() + values.astype("<f8").tobytes())


def draw(path, data, fits):
    """Draw the red channel of data and of fitted lobes in the plane of incidence."""
    matplotlib.use("agg")
    from matplotlib import pyplot

    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 361)
    wi = np.stack([np.sin(theta), np.zeros_like(theta), np.cos(theta).clip(0.0)], axis=-1)
    wo = np.broadcast_to([-np.sin(VIEW), 0.0, np.cos(VIEW)], wi.shape)
    figure, (lobe, against) = pyplot.subplots(1, 2, figsize=(9.0, 4.0), layout="constrained")
    for fit in fits:
        lobe.plot(np.degrees(theta), fit.brdf(wo, wi)[:, 0], label=fit.model)
        against.plot(data.value[:, 0], fit.brdf(data.wo, data.wi)[:, 0], ".", ms=2, label=fit.model)
    title = "viewer at -50 degrees"
    lobe.set(xlabel="angle of the light, degrees", ylabel="BRDF, 1/sr", title=title)
    against.set(xlabel="measured, 1/sr", ylabel="fitted, 1/sr", xscale="log", yscale="log")
    against.axline((0.1, 0.1), (1.0, 1.0), color="gray", lw=0.8)
    lobe.legend()
    figure.savefig(path, dpi=120)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file", nargs="?", type=Path)
    parser.add_argument("--out", default=Path("out"), type=Path)
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    path = options.file or options.out / "coated_clay.binary"
    if options.file is None:
        write_clay(path)
        print("put in:", CLAY)
    # The first fit has errors in proportion to the data, which give more weight to values that
    # noise has lowered. So the errors of the second fit are in proportion to the first fit.
    data, models = read_merl(path, STEP), ("eon", "dielectric_over_eon")
    first = fit_brdf(replace(data, error=NOISE * data.value + FLOOR), models[-1])
    data = replace(data, error=NOISE * first.brdf(data.wo, data.wi) + FLOOR)
    fits = [fit_brdf(data, model) for model in models]
    print(*fits, sep="\n")
    draw(options.out / "fit.png", data, fits)
    print(options.out / "fit.png")


if __name__ == "__main__":
    main()
