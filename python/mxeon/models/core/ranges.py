# SPDX-License-Identifier: Apache-2.0
"""Ranges of the arguments of the models, by name."""

import numpy as np

_LARGEST = float(np.finfo(np.float64).max)

# Closed ranges of the quantities, by name: least, largest, as printed.
RANGES = {
    "mu": (0.0, 1.0, "[0, 1]"),
    "rho": (0.0, 1.0, "[0, 1]"),
    "roughness": (0.0, 1.0, "[0, 1]"),
    "sigma": (0.0, 0.5 * np.pi, "[0, pi/2]"),
    "color": (0.0, 1.0, "[0, 1]"),
    "amount": (0.0, 1.0, "[0, 1]"),
    "weight": (0.0, _LARGEST, "[0, inf)"),
    "albedo": (-_LARGEST, _LARGEST, "(-inf, inf)"),
    "mu_o": (0.0, 1.0, "[0, 1]"),
    "mu_i": (0.0, 1.0, "[0, 1]"),
    "alpha": (0.0, 1.0, "[0, 1]"),
    "tint": (0.0, 1.0, "[0, 1]"),
    "color0": (0.0, 1.0, "[0, 1]"),
    "color82": (0.0, 1.0, "[0, 1]"),
    "color90": (0.0, 1.0, "[0, 1]"),
    "exponent": (0.0, 1e50, "[0, 1e50]"),  # these three end where a fourth power still fits
    "ior": (0.0, 1e50, "[0, 1e50]"),
    "extinction": (0.0, 1e50, "[0, 1e50]"),
    **dict.fromkeys(
        ("radiance", "base", "emission", "scattered", "behind", "light"), (0.0, 1e50, "[0, 1e50]")
    ),
    "intensity": (0.0, 1e50, "[0, 1e50]"),
    "exposure": (-1000.0, 1000.0, "[-1000, 1000]"),
    "opacity": (0.0, 1.0, "[0, 1]"),
    "inner_angle": (0.0, 360.0, "[0, 360]"),
    "outer_angle": (0.0, 360.0, "[0, 360]"),
    "absorption": (0.0, 1e50, "[0, 1e50]"),
    "scattering": (0.0, 1e50, "[0, 1e50]"),
    "distance": (0.0, 1e50, "[0, 1e50]"),
    "cos_theta": (-1.0, 1.0, "[-1, 1]"),
    "g": (-float(np.nextafter(1.0, 0.0)), float(np.nextafter(1.0, 0.0)), "(-1, 1)"),
    "anisotropy": (0.0, 1.0, "[0, 1]"),
    "glossiness": (0.0, 1.0, "[0, 1]"),
    "reflectivity": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
    "edge_color": (0.0, 1.0, "[0, 1]"),
    "temperature": (1.0, 1e9, "[1, 1e9]"),
    "wavelength": (1.0, 1e9, "[1, 1e9]"),
    "longitudinal": (0.0, 1.0, "[0, 1]"),
    "azimuthal": (0.0, 1.0, "[0, 1]"),
    "scale_tt": (0.0, 1e50, "[0, 1e50]"),
    "scale_trt": (0.0, 1e50, "[0, 1e50]"),
    "melanin_concentration": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
    "melanin_redness": (0.0, 1.0, "[0, 1]"),
    "eumelanin_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "pheomelanin_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "hair_color": (float(np.nextafter(0.0, 1.0)), 1.0, "(0, 1]"),
    "azimuthal_roughness": (0.0, 1.0, "[0, 1]"),
    **dict.fromkeys(("thinfilm_thickness", "thickness"), (0.0, 1e9, "[0, 1e9]")),  # nm
    **dict.fromkeys(("thinfilm_ior", "film_ior"), (1.0, 1e50, "[1, 1e50]")),
    **dict.fromkeys(("tint_R", "tint_TT", "tint_TRT"), (0.0, 1.0, "[0, 1]")),
    "variance": (1e-12, 1e12, "[1e-12, 1e12]"),  # where exponents and squares still fit
    "scale": (1e-12, 1e12, "[1e-12, 1e12]"),
    **dict.fromkeys(
        ("roughness_R", "roughness_TT", "roughness_TRT"), (1e-12, 1e12, "[1e-12, 1e12]")
    ),
    "cuticle_angle": (0.0, 1.0, "[0, 1]"),
    "absorption_coefficient": (0.0, 1e50, "[0, 1e50]"),
    "x": (0.0, _LARGEST, "[0, inf)"),
    **dict.fromkeys(("theta_i", "theta_o"), (-0.5 * np.pi, 0.5 * np.pi, "[-pi/2, pi/2]")),
    "phi": (-_LARGEST, _LARGEST, "(-inf, inf)"),
    "reflectance": (0.0, 1.0, "[0, 1]"),
    "transmittance": (0.0, 1.0, "[0, 1]"),
    "single_scatter": (0.0, 1.0, "[0, 1]"),
    "scatter_anisotropy": (-1.0, 1.0, "[-1, 1]"),
    # lengths whose products and quotients fit
    **dict.fromkeys(("separation", "radius", "reach"), (1e-150, 1e150, "[1e-150, 1e150]")),
    "u": (0.0, float(np.nextafter(1.0, 0.0)), "[0, 1)"),
}
