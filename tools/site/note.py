# SPDX-License-Identifier: Apache-2.0
"""Prints the numbers and draws the figures of the technical note: `python -m tools.site.note`."""

import numpy as np
from matplotlib import style
from matplotlib.figure import Figure

from mxeon import models
from mxeon.io.files import replacing
from mxeon.models import hair, sheen, transmission
from mxeon.models.core.quadrature import albedo_dir_quadrature
from mxeon.models.diffuse import C1, FON_G, burley_albedo_dir, oren_nayar_brdf, qon_albedo_dir
from mxeon.models.diffuse import fon_loss_mu as fon_loss
from mxeon.models.microfacet import dielectric_albedo_dir
from mxeon.models.microfacet.defects import fitted_albedo
from tools.fits import fon_loss as loss_fit
from tools.fits import ggx_albedo as albedo_fit
from tools.fits import ggx_cosine as cosine_fit
from tools.fits.minimax import shipped
from tools.paper.claims.models import listing_1_albedo
from tools.paper.samplers import BY_NAME, EXACT_VARIANCE, moments
from tools.site import DOCS, with_block

PAGE = DOCS / "note.md"
GLASS, DENSE = 1.5, 3.0
SCHLICK = (0.04, 0.25, 0.6), (1.0, 0.5, 0.8), 1.0
ROUGH = (1.0, 1.0)
VIEWS = np.linspace(0.02, 1.0, 50)
STYLE = {
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.alpha": 0.2,
    "legend.frameon": False,
    "legend.fontsize": 8,
}


# --- energy that FON loses, in float32 ------------------------------------------------------------


def quartic_loss(mu):
    """1 - E of FON at roughness 1, computed with the quartic of [Portsmouth2025], Eq. (14)."""
    one, (a, b, c, d) = np.float32(1.0), np.float32(FON_G)
    m = one - mu
    G = m * (a + m * (b + m * (c + m * d)))
    return one - (one + G) / (one + np.float32(C1))


def closed_loss(mu):
    """1 - E of FON at roughness 1, computed with the closed form of H."""
    one = np.float32(1.0)
    S = np.sqrt((one - mu) * (one + mu))
    t = mu / (one + S)
    bracket = np.float32(C1) - S * t * (np.float32(2.0) + S) / np.float32(3.0 * np.pi)
    H = mu * t * bracket + np.float32(2.0 / np.pi) * S * np.arctan(t)
    return H / (one + np.float32(C1))


def fitted_loss(mu):
    """1 - E of FON at roughness 1, computed with the polynomials in the shaders."""
    p, q = (np.float32(shipped("eon", "EON", each)) for each in "PQ")
    return loss_fit.fitted(mu, p, q) / (np.float32(1.0) + np.float32(C1))


LOSSES = {
    "Listing 1": lambda mu: np.float32(1.0) - listing_1_albedo(mu),
    "quartic, Eq. (14)": quartic_loss,
    "H, closed form": closed_loss,
    "H, polynomials": fitted_loss,
}


def loss_errors(mu):
    """Error of each formula for 1 - E, by name, and the exact 1 - E."""
    exact = fon_loss(np.float64(mu)) / (1.0 + C1)
    return {name: np.float64(each(mu)) - exact for name, each in LOSSES.items()}, exact


def loss_figures():
    """Largest absolute and relative errors of 1 - E over all float32 cosines from 1e-6 to 1.

    The paper's formulas are evaluated at only 4001 of these cosines.
    """
    mu = np.unique(np.geomspace(1e-6, 1.0, 4001).astype(np.float32))
    errors, exact = loss_errors(mu)
    listing, quartic, *_ = (np.abs(each) for each in errors.values())
    found = {
        "listing": listing.max(),
        "listing relative": (listing / exact).max(),
        "quartic": quartic.max(),
        "quartic excess": -quartic_loss(mu).min(),
        "quartic relative": (quartic / exact).max(),
    }
    low, high = np.float32([1e-6, 1.0]).view(np.int32)
    largest = []
    for start in range(low, high + 1, 1 << 20):
        bits = np.arange(start, min(start + (1 << 20), high + 1), dtype=np.int32)
        mu = bits.view(np.float32)
        exact = fon_loss(np.float64(mu)) / (1.0 + C1)
        closed, fitted = (np.abs(loss(mu) - exact) for loss in (closed_loss, fitted_loss))
        largest.append(((closed / exact).max(), fitted.max(), (fitted / exact).max()))
    names = "closed relative", "fitted", "fitted relative"
    return found | dict(zip(names, np.max(largest, axis=0).tolist(), strict=True))


# --- sampling and albedos -------------------------------------------------------------------------


def variances(name, roughness, mu):
    """Variance of a sampler's weight at unit reflectance for each mu, by quadrature."""
    return np.array([moments(name, each, roughness)[1] for each in mu])


def albedo_errors(mu, alpha):
    """Errors of MaterialX's and eonlib's fits of E_ss."""
    exact = models.ggx_albedo_dir(mu, alpha)
    ours = albedo_fit.fitted(mu, alpha, shipped("ggx_albedo", "ggx_missing"))
    return fitted_albedo(mu, alpha, 1.0, 1.0) - exact, ours - exact


def fresnel_errors(mu, alpha, ior=GLASS):
    """Errors of three formulas for a dielectric's albedo without energy compensation.

    The formulas are E_ss F(mu), E_ss F(c), and MaterialX's fit for Schlick's curve.
    """
    curves = cosine_fit.DIELECTRIC
    shape = np.sqrt((ior - 1.0) / (ior + 1.0))
    E, (mean,) = cosine_fit.averages(mu, alpha, [lambda c: curves.reflectance(c, ior)])
    c = cosine_fit.cosine(curves, mu, alpha, shape, shipped("fresnel_dielectric", curves.function))
    F0 = ((ior - 1.0) / (ior + 1.0)) ** 2
    exact = E * mean
    return {
        "F at the view": E * curves.reflectance(mu, ior) - exact,
        "MaterialX's fit": fitted_albedo(mu, alpha, F0, 1.0) - exact,
        "F at the cosine c": E * curves.reflectance(c, ior) - exact,
    }


def largest_figures():
    """Largest variances of samplers, and largest and mean errors of E_ss and of an albedo."""
    mu = np.append(0.01, np.linspace(0.05, 1.0, 20))
    found = {
        f"{name} {r}": variances(name, r, mu).max()
        for name in ("cosine", "eon_cltc")
        for r in (0.01, 1.0)
    }
    fine, coarse = (
        [each.ravel() for each in np.meshgrid(*2 * [np.geomspace(1e-3, 1.0, count)])]
        for count in (40, 16)
    )
    stock_E, E = albedo_errors(*fine)
    view, stock_F, cosine = fresnel_errors(*coarse).values()
    *_, dense = fresnel_errors(*coarse, DENSE).values()
    errors = {"stock E": stock_E, "E": E, "view": view, "stock F": stock_F, "cosine": cosine}
    for name, error in (errors | {"cosine dense": dense}).items():
        found[name], found[f"{name} mean"] = np.abs(error).max(), np.abs(error).mean()
    return found


# --- energy of readings ---------------------------------------------------------------------------


def energy_rows():
    """Yield an equation, the interpretation of the equation, and albedos of a white surface."""
    mu = VIEWS
    wo = np.stack([np.sqrt((1.0 - mu) * (1.0 + mu)), 0.0 * mu, mu], axis=-1)
    E = models.ggx_albedo_dir(mu, 1.0)
    R, T = (
        function(wo, 1.0, ROUGH, GLASS)[:, 0]
        for function in (dielectric_albedo_dir, transmission.dielectric_transmittance_dir)
    )
    around = np.concatenate([wo, wo[:, [1, 0, 2]]])  # directions in the planes of both tangents
    yield "Microfacet BRDF, F = 1, alpha 1", "as it is", E
    compensated = dielectric_albedo_dir(wo, 1.0, ROUGH, 0.0)  # IOR 0 means total reflection
    yield "", "times 1 + F_ss (1 - E_ss) / E_ss", compensated
    stretched = models.ggx_albedo_dir_anisotropic(around, [0.001, 1.0])
    yield "alpha 0.001 and 1", "masking by direction, as corrected in July 2026", stretched
    yield "Microfacet BTDF, rough glass, alpha 1", "R compensated, T as printed", R + T
    single = models.generalized_schlick_albedo_dir(wo, *SCHLICK, (0.0, 0.0), 5.0, compensate=False)
    transmittance = transmission.generalized_schlick_transmittance_dir
    for name, reading in transmission.READINGS.items():
        head = "Generalized Schlick BTDF, smooth" if name == "text" else ""
        transmitted = transmittance(wo, *SCHLICK, (0.0, 0.0), 5.0, name)
        yield head, reading.title, single + transmitted
    yield "Burley, roughness 1", "as printed", burley_albedo_dir(mu, 1.0, 1.0)
    yield "Conty-Kulla sheen, roughness 0.05", "as printed", sheen.conty_kulla_albedo_dir(mu, 0.05)
    full, eon = (
        albedo_dir_quadrature(brdf, mu, 1.0, parameter)
        for brdf, parameter in ((oren_nayar_brdf, 0.3), (models.eon_brdf, 1.0))
    )
    yield "Oren-Nayar, sigma 0.3", "full model", full
    yield "", "QON, of the node's default", qon_albedo_dir(mu, 0.3)
    yield "EON, roughness 1", "with energy compensation", eon
    fiber = hair.chiang_hair_attenuation(wo, 1.55, 0.0).sum(axis=-1)
    yield "Chiang hair, white", "with the printed factor 1/pi", fiber / np.pi
    yield "", "without it", fiber


def page(text):
    lines = [
        f"| {name} | {reading} | {np.min(share):.3f} | {np.max(share):.3f} |\n"
        for name, reading, share in energy_rows()
    ]
    head = "| equation | reading | least | largest |\n|---|---|---|---|\n"
    return with_block(text, "energy", head + "".join(lines))


# --- figures ---


def exact_figure():
    """Plot the errors of FON's energy loss, and the variance of EON's samplers."""
    figure = Figure(figsize=(7.6, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    mu = np.unique(np.geomspace(1e-6, 1.0, 400).astype(np.float32))
    errors, exact = loss_errors(mu)
    for name, error in errors.items():
        left.loglog(mu, np.maximum(np.abs(error / exact), 1e-9), label=name, linewidth=0.9)
    left.set(xlabel="$\\mu$", ylabel="relative error of $1 - E_{FON}$, float32", ylim=(1e-9, 1e3))
    left.legend()
    mu = np.cos(np.radians(np.linspace(0.0, 89.0, 60)))
    for name in ("uniform", "cosine", "eon_cltc"):
        label = BY_NAME[name].title
        right.semilogy(np.degrees(np.arccos(mu)), variances(name, 1.0, mu), label=label)
    right.axhline(EXACT_VARIANCE, color="k", linestyle="--", label="exact, bound")
    right.set(xlabel="$\\theta_o$ (degrees)", ylabel="variance of the weight, $r = 1$")
    right.legend(loc="center left")
    return figure


def albedo_figure():
    """Plot the errors of the albedos of GGX and of a dielectric."""
    figure = Figure(figsize=(7.6, 3.0), layout="constrained")
    left, right = figure.subplots(1, 2)
    mu = np.geomspace(1e-3, 1.0, 120)
    for color, alpha in (("C0", 0.01), ("C1", 0.1), ("C2", 1.0)):
        labels = ("-", "MaterialX"), (":", "ours")
        errors = albedo_errors(mu, np.full_like(mu, alpha))
        for (line, name), error in zip(labels, errors, strict=True):
            label = f"{name}, $\\alpha$ = {alpha:g}"
            left.loglog(mu, np.abs(error), color=color, linestyle=line, label=label)
    left.set(xlabel="$\\mu$", ylabel="error of $E_{ss}$", ylim=(1e-8, 1.0))
    left.legend(ncols=2, fontsize=6)
    for name, error in fresnel_errors(mu, np.full_like(mu, 0.5)).items():
        right.loglog(mu, np.abs(error), label=name)
    right.set(
        xlabel="$\\mu$", ylabel="error of the albedo, ior 1.5, $\\alpha$ = 0.5", ylim=(1e-6, 1.0)
    )
    right.legend()
    return figure


if __name__ == "__main__":
    with style.context(["default", STYLE]):
        for name, draw in (("note_exact", exact_figure), ("note_albedo", albedo_figure)):
            with replacing(DOCS / "figures" / f"{name}.png") as path:
                draw().savefig(path, dpi=110, metadata={"Software": None})
    for name, value in (loss_figures() | largest_figures()).items():
        print(f"{name}: {value:.3g}")
