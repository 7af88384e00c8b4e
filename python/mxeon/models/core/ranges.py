# SPDX-License-Identifier: Apache-2.0
"""Ranges of the arguments of the models, by name."""

import numpy as np

_LARGEST = float(np.finfo(np.float64).max)

# Ends of closed ranges, and as they are printed.
_BELOW_ONE, _ABOVE_ZERO = float(np.nextafter(1.0, 0.0)), float(np.nextafter(0.0, 1.0))
_SHARE = (0.0, 1.0, "[0, 1]")
_POSITIVE = (0.0, 1e50, "[0, 1e50]")  # where a fourth power still fits
_WIDTH = (1e-12, 1e12, "[1e-12, 1e12]")  # where exponents and squares still fit
_LENGTH = (1e-150, 1e150, "[1e-150, 1e150]")  # whose products and quotients fit


def _each(names: str, ends: tuple[float, float, str]) -> dict[str, tuple[float, float, str]]:
    """The range of each of these names."""
    return dict.fromkeys(names.split(), ends)


# Ranges at whose ends rounding may step over them.
CLOSED = ("[0, 1]", "[0.01, 1]", "[0.1, 1]", "[1, 4]", "[-1, 1]", "[0, pi/2]", "[-pi/2, pi/2]")

# Ranges of the quantities, by name.
RANGES = {
    **_each("mu mu_o mu_i", _SHARE),
    **_each("rho color color0 color82 color90 tint tint_R tint_TT tint_TRT edge_color", _SHARE),
    **_each("roughness alpha anisotropy glossiness longitudinal azimuthal", _SHARE),
    **_each("azimuthal_roughness cuticle_angle amount opacity melanin_redness", _SHARE),
    **_each("reflectance transmittance single_scatter lobe_weight metalness", _SHARE),
    **_each("u reflectivity melanin_concentration", (0.0, _BELOW_ONE, "[0, 1)")),
    **_each("eumelanin_color pheomelanin_color hair_color", (_ABOVE_ZERO, 1.0, "(0, 1]")),
    **_each("exponent ior extinction absorption scattering absorption_coefficient", _POSITIVE),
    **_each("radiance base emission scattered behind light intensity distance", _POSITIVE),
    **_each("scale_tt scale_trt", _POSITIVE),
    **_each("coat_alpha", (0.01, 1.0, "[0.01, 1]")),
    **_each("specular_roughness", (0.1, 1.0, "[0.1, 1]")),  # whose square is that alpha
    **_each("coat_ior specular_ior", (1.0, 4.0, "[1, 4]")),
    **_each("thinfilm_ior film_ior", (1.0, 1e50, "[1, 1e50]")),
    **_each("thinfilm_thickness thickness", (0.0, 1e9, "[0, 1e9]")),  # nm
    **_each("temperature wavelength", (1.0, 1e9, "[1, 1e9]")),
    **_each("variance scale roughness_R roughness_TT roughness_TRT", _WIDTH),
    **_each("separation radius reach", _LENGTH),
    **_each("weight x", (0.0, _LARGEST, "[0, inf)")),
    **_each("albedo phi", (-_LARGEST, _LARGEST, "(-inf, inf)")),
    **_each("cos_theta scatter_anisotropy", (-1.0, 1.0, "[-1, 1]")),
    **_each("g", (-_BELOW_ONE, _BELOW_ONE, "(-1, 1)")),
    **_each("inner_angle outer_angle", (0.0, 360.0, "[0, 360]")),
    **_each("theta_i theta_o", (-0.5 * np.pi, 0.5 * np.pi, "[-pi/2, pi/2]")),
    **_each("sigma", (0.0, 0.5 * np.pi, "[0, pi/2]")),
    **_each("exposure", (-1000.0, 1000.0, "[-1000, 1000]")),
}
