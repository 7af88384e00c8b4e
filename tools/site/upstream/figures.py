# SPDX-License-Identifier: Apache-2.0
"""Figures in the sentences of pages, by page and name; the marks of the pages ask for them."""

from functools import cache

import numpy as np
from scipy.optimize import brentq

from mxeon.models import thin_film
from mxeon.models.core.colorimetry import XYZ_TO_REC709
from mxeon.models.core.quadrature import unit_rule
from mxeon.models.diffuse import known_defects
from mxeon.models.diffuse.brdf import eon_brdf
from mxeon.models.diffuse.burley import burley_albedo_dir
from mxeon.models.diffuse.known_defect_albedos import qon_fitted_albedo_dir
from mxeon.models.diffuse.qon_albedo import qon_albedo_dir
from mxeon.models.media.blackbody import blackbody_xyz, kang_xyz
from mxeon.models.media.subsurface import subsurface_albedo, subsurface_reflectance
from mxeon.models.microfacet import materialx_fits
from mxeon.models.microfacet.defects import fitted_albedo
from mxeon.models.microfacet.ggx import smith_g1
from mxeon.models.microfacet.ggx_albedo import ggx_albedo_dir
from mxeon.models.nodes.subsurface import STEPS, circle_blur
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.models.transmission.schlick import schlick_ior
from tools.site.upstream import film_quantities as film
from tools.site.upstream.hair_figures import OF_HAIR
from tools.site.upstream.random_walk import distances, reflectance_of_h
from tools.site.upstream.shader_figures import (
    acos_error,
    blur_error,
    mirrored_sheen,
    refracted_angles,
    throughput_changes,
)
from tools.site.upstream.transmission_quantities import inside_albedo

PATHS = 20_000  # of a random walk


def floor_figures():
    """Errors of EON with a reflectance of at least 0.1, relative to the value, at roughness 1."""
    cosines = np.geomspace(1e-3, 1.0, 200)
    z = np.stack([each.ravel() for each in np.meshgrid(cosines, cosines)])
    x = np.sqrt(1.0 - z * z) * [[1.0], [-1.0]]  # back-lit pairs
    wo, wi = np.stack([x, 0.0 * x, z], axis=-1)
    rho = np.array([0.02, 0.05, 1e-4])
    right = eon_brdf(wo, wi, rho, 1.0)
    floored = known_defects.eon_floor_brdf(wo, wi, rho, 1.0)
    dark, light, _ = np.abs(floored / right - 1.0).max(axis=0)
    return {"dark": dark, "light": light}


def blackbody_figures():
    """Distances of Kang's fits from Planck's law, and the body as pale as one of 800 K by the fits."""
    warm = np.linspace(1667.0, 25000.0, 2000)
    fit, planck = kang_xyz(warm), blackbody_xyz(warm)
    xy, uv = (np.linalg.norm(each(fit) - each(planck), axis=-1).max() for each in (_xy, _uv))
    red = np.abs((fit - planck) @ XYZ_TO_REC709[0]).max()
    bodies = np.linspace(1000.0, 10000.0, 9001)
    near = np.linalg.norm(_uv(blackbody_xyz(bodies)) - _uv(kang_xyz(800.0)), axis=-1).argmin()
    return {"xy": xy, "uv": uv, "red": red, "pale": bodies[near]}


def temperatures_table():
    """Chromaticity and color of a black body by GLSL's fits, and by Planck's law."""
    head = "| temperature | x, y by the fits | x, y by Planck | distance in x, y | in u', v' "
    head += "| Rec. 709 by the fits | by Planck |\n|---|---|---|---|---|---|---|\n"
    return head + "".join(map(_temperature_row, (800.0, 1000.0, 1200.0, 1400.0, 1667.0, 5000.0)))


def _temperature_row(kelvin):
    fit, planck = kang_xyz(kelvin), blackbody_xyz(kelvin)
    cells = [", ".join(f"{x:.3f}" for x in _xy(each)) for each in (fit, planck)]
    cells += [f"{np.linalg.norm(each(fit) - each(planck)):.3f}" for each in (_xy, _uv)]
    cells += [", ".join(f"{x:.2f}" for x in XYZ_TO_REC709 @ each) for each in (fit, planck)]
    return f"| {kelvin:.0f} K | {' | '.join(cells)} |\n"


def _xy(xyz):
    return xyz[..., :2] / xyz.sum(axis=-1, keepdims=True)


def _uv(xyz):
    """u' and v' of the CIE diagram of 1976."""
    total = xyz @ [1.0, 15.0, 3.0]
    return np.stack([4.0 * xyz[..., 0], 9.0 * xyz[..., 1]], axis=-1) / total[..., np.newaxis]


def film_figures():
    """Error of two orders on metals, and change of gold by a film that vanishes, without the clamp."""
    return {"orders": film.errors(2)[1], "gold": film.thin_gold(thin_film.MATERIALX)}


def film_white_figures():
    """Share by which the red of a white metal is too bright under the printed matrix, and digits."""
    return {"white": float(film.white().split()[0]) - 1.0, "digits": film.agreeing_digits()}


def ggx_fit_figures():
    """Errors of the fit of GGX's albedo, and its dip where cosine and alpha are equal and small."""
    mu, alpha = (v.ravel() for v in np.meshgrid(*2 * [np.geomspace(1e-3, 1.0, 40)]))
    cosine, narrow = np.geomspace(1e-3, 1.0, 200), np.full(200, 0.01)
    dip = ggx_albedo_dir(1e-3 * np.linspace(0.5, 2.0, 31), np.full(31, 1e-3)).min()
    fit, exact = fitted_albedo(mu, alpha, 1.0, 1.0), ggx_albedo_dir(mu, alpha)
    white = abs(exact / fit - 1.0)  # error of a lobe that reflects everything, compensated
    # The mean over the square of mu and alpha.
    x, weight = unit_rule(32)
    square = np.repeat(x, 32), np.tile(x, 32)
    mean = np.outer(weight, weight).ravel() @ _ggx_errors(*square)
    return {
        "largest": abs(fit - exact).max(),
        "narrow": _ggx_errors(cosine, narrow).max(),
        "dip": dip,
        "white": white.max(),
        "white from 0.1": white[mu >= 0.1].max(),
        "mean": mean,
    }


def _ggx_errors(mu, alpha):
    return abs(fitted_albedo(mu, alpha, 1.0, 1.0) - ggx_albedo_dir(mu, alpha))


def conty_kulla_figures():
    """Error of the fit of the sheen's albedo for cosines from 0.02 and roughness from 0.05 on."""
    mu, r = (v.ravel() for v in np.meshgrid(np.linspace(0.02, 1.0, 99), np.linspace(0.05, 1.0, 96)))
    wo = np.stack([0.0 * mu, 0.0 * mu, mu], axis=-1)
    fit = materialx_fits.conty_kulla_albedo(wo, {"roughness": r})[:, 0]
    error = fit - np.minimum(conty_kulla_albedo_dir(mu, r), 1.0)
    return {**mirrored_sheen(), "steep": np.abs(error).max()}


def cone_figures():
    """Slope of a falloff of 20 degrees, in the cosine: a cubic step between 0 and half of them."""
    return {"slope": 1.5 / (1.0 - np.cos(np.radians(10.0)))}


def qon_fit_figures():
    """Error of the fit of QON's albedo for sigma up to 1."""
    mu, sigma = (v.ravel() for v in np.meshgrid(np.linspace(1e-3, 1.0, 200), np.linspace(0, 1, 60)))
    error = qon_fitted_albedo_dir(mu, [1.0], sigma) - qon_albedo_dir(mu, sigma)[..., np.newaxis]
    return {"smooth": np.abs(error).max()}


def refraction_figures():
    """Largest index of generalized Schlick, and angles at which light is NaN."""
    return {"index": np.max(schlick_ior((1.0, 1.0, 1.0), "text")), **refracted_angles()}


def circle_figures():
    """What the circle of GLSL's subsurface scattering makes of a plane and of a sphere."""
    x, w = np.polynomial.legendre.leggauss(400)
    plane = circle_blur(np.ones(1), np.full((1, 3), 0.01))[0, 0]
    sphere = circle_blur(x, np.full((400, 3), 10.0), body=1.0)[:, 0]
    return {
        "step": 180.0 / STEPS,
        "plane": 1.0 - plane,
        "sphere": 2.0 * (w * sphere).sum(),
        "rings": blur_error(),
    }


def masking_figures():
    """1 / G1 of alpha 1 at 60 degrees."""
    return {"masking": 1.0 / smith_g1([np.sqrt(0.75), 0.0, 0.5], [1.0, 1.0])}


def sum_figures():
    """What two lobes of albedo 0.9, added and halved, pass by GLSL, and return over a white base."""
    E = 0.9
    passed = 0.5 * max(2.0 * (1.0 - E) - 1.0, 0.0) + 0.5  # half of the sum, half of nothing
    return {"right": 1.0 - E, "passed": passed, "total": E + passed}


def multiple_figures():
    """What lobes of albedo 0.7 return in all where GLSL halves them, or scales them to nothing."""
    E = 0.7
    return {**sum_figures(), "half": 0.5 * E + 1.0 - E, "none": 1.0 - E}


def energy_figures():
    """Roughnesses at which the albedos of Conty-Kulla and Burley reach 1 at grazing angles."""
    grazing = np.geomspace(1e-6, 0.3, 200)
    cosines = np.linspace(0.0, 1.0, 201)
    return {
        "sheen": brentq(lambda r: conty_kulla_albedo_dir(grazing, r).max() - 1.0, 0.1, 0.3),
        "diffuse": brentq(lambda r: burley_albedo_dir(cosines, [1.0], r).max() - 1.0, 0.3, 0.5),
    }


@cache
def profile_figures():
    """Errors of the albedo inversion, and of the profile's width with the repair."""
    colors = np.linspace(0.02, 0.98, 25)
    exact = [reflectance_of_h(each) for each in subsurface_albedo(colors)]
    return {
        "isotropic": np.abs(exact - colors).max(),
        "width": max(map(_width_error, WIDTHS)),
        "dark": _walk_width(0.05, 0.0) / 2.5,
        "bright": _walk_width(0.95, 0.0) / 2.5,
    }


WIDTHS = ((0.2, -0.5), (0.5, 0.0), (0.8, 0.0), (0.5, 0.5), (0.2, 0.5), (0.8, 0.5), (0.8, -0.5))


def _width_error(case):
    """Relative error of the mean distance 5/2 l / (s (1 - g)) against a random walk's."""
    color, g = case
    s = 1.9 - color + 3.5 * (color - 0.8) ** 2
    return abs(2.5 / (s * (1.0 - g)) / _walk_width(color, g) - 1.0)


def _walk_width(color, g):
    """Mean distance of a random walk, in mean free paths."""
    return distances(float(subsurface_albedo(color, g)), g, PATHS).mean()


def specification_figures():
    """Figures of the specification's part on subsurface scattering."""
    missed = 0.5 - float(subsurface_reflectance(subsurface_albedo(0.5), 0.5))
    return {**profile_figures(), "dissimilar": missed, "rings": blur_error()}


FIGURES = {
    **OF_HAIR,
    "babylon_reflectance_floor": floor_figures,
    "genglsl_add_throughput": sum_figures,
    "genglsl_albedo_acos": acos_error,
    "genglsl_blackbody_cold": blackbody_figures,
    "genglsl_conty_kulla_fit": conty_kulla_figures,
    "genglsl_film_choices": film_figures,
    "genglsl_ggx_fit": ggx_fit_figures,
    "genglsl_microfacet_throughput": throughput_changes,
    "genglsl_missing_nodes": cone_figures,
    "genglsl_multiply_throughput": multiple_figures,
    "genglsl_qon_albedo_fit": qon_fit_figures,
    "genglsl_refraction_nan": refraction_figures,
    "genglsl_subsurface_circle": circle_figures,
    "genglsl_transmission_masking": masking_figures,
    "pbrlib_diffusion_profile": profile_figures,
    "pbrlib_energy": energy_figures,
    "pbrlib_thin_film": film_white_figures,
    "pbrlib_transmission_energy": inside_albedo,
    "specification": specification_figures,
}
# Tables of pages beside that of checks, by page and name.
TABLES = {("genglsl_blackbody_cold", "temperatures"): temperatures_table}
