# SPDX-License-Identifier: Apache-2.0
"""MaterialX's OSL closures, each as the shader of one sphere by which a renderer is asked for it."""

# Calls with the arguments that MaterialX's generated text has.
_SURFACE = "N, dPdu"
CALLS = {
    "oren_nayar_diffuse_bsdf": "N, color(0.5), 0.5",
    "burley_diffuse_bsdf": "N, color(0.5), 0.5",
    "translucent_bsdf": "N, color(0.5)",
    "dielectric_bsdf": f'{_SURFACE}, color(1.0), color(0.0), 0.5, 0.5, 1.5, "ggx"',
    "conductor_bsdf": f'{_SURFACE}, 0.5, 0.5, color(0.2), color(3.9), "ggx"',
    "generalized_schlick_bsdf": f"{_SURFACE}, color(1.0), color(0.0), 0.5, 0.5, color(0.04), "
    'color(1.0), 5.0, "ggx"',
    "sheen_bsdf": "N, color(0.5), 0.5",
    "chiang_hair_bsdf": f"{_SURFACE}, color(1.0), color(1.0), color(1.0), 1.55, 0.1, 0.05, 0.2, 0.1, 0.05, "
    "0.2, 0.5, vector(0.0)",
    "subsurface_bssrdf": "N, color(0.5), color(0.1), 0.0",
    "layer": "sheen_bsdf(N, color(0.5), 0.5), oren_nayar_diffuse_bsdf(N, color(0.5), 0.5)",
}


def text(closure: str) -> str:
    call = f"{closure}({CALLS[closure]})"
    return f"shader asked(output closure color out = 0)\n{{\n    out = {call};\n}}\n"
