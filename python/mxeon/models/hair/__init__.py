# SPDX-License-Identifier: Apache-2.0
"""The hair model of [MaterialX2026], section `chiang_hair_bsdf`, after [Chiang2016] and [dEon2011].

The fiber is +x, and the normal +z is turned to the viewer. Light comes from the whole sphere.

- `wo` (..., 3): Direction to the viewer, unit vector to 1e-6, fiber +x, normal +z, z >= 0.
- `wi` (..., 3): Direction to the light, unit vector to 1e-6, on either side.

Raises `ValueError`, which names the first bad element, if an argument leaves its range or the
shapes do not broadcast.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from mxeon.models.core.arguments import (
    checked,
    checked_color,
    checked_directions,
    checked_numbers,
    checked_pairs,
    checked_sphere,
    checked_vector,
)
from mxeon.models.core.arrays import Array, ArrayLike, Numbers
from mxeon.models.core.evaluation import evaluate_material
from mxeon.models.core.namespaces import any_array, array_namespace, library, like
from mxeon.models.core.shapes import channel_count
from mxeon.models.hair import formulas as formulas
from mxeon.models.hair.formulas import LOBES, TEXT, HairForm

__all__ = [
    "LOBES",
    "chiang_hair_attenuation",
    "chiang_hair_bcsdf",
    "hair_azimuthal",
    "hair_longitudinal",
]

BLOCK = 4096  # elements at a time: a lobe keeps many numbers for each
TINTS, ROUGHNESSES = (
    tuple(f"{prefix}_{lobe}" for lobe in ("R", "TT", "TRT")) for prefix in ("tint", "roughness")
)


@any_array
def chiang_hair_bcsdf(wo: ArrayLike, wi: ArrayLike, **inputs: Any) -> Array:
    """Curve-scattering distribution function of a hair fiber.

        f = 1/pi (t_R A_R M_R N_R + t_TT A_TT M_TT N_TT + t_TRT (A_TRT M_TRT N_TRT + A_TRRT+ M_TRT / 2pi))

    - `**inputs`: Values of the node's ports, which have its defaults; form is a
      `mxeon.models.hair.formulas.HairForm`: `tint_R`, `tint_TT`, `tint_TRT`, shape (..., C),
      in [0, 1]; `ior`, shape (...), in [0, 1e50]; `roughness_R`, `roughness_TT`, `roughness_TRT`,
      shape (..., 2), longitudinal variance in square radian and azimuthal scale in radian,
      in [1e-12, 1e12]; `cuticle_angle`, shape (...), in [0, 1]; `absorption_coefficient`, shape
      (..., C), per radius of the fiber, in [0, 1e50].

    Result (..., C): in 1/sr, at least 0. As the text has it, it takes no cosine of the light: its
    integral over all lights is 1/pi where nothing is absorbed and the cuticle has no tilt. The text
    has roughness (0, 0), a pure mirror: no function has its value, and it is refused. F has the
    index `ior`, as in [Chiang2016]; that the text means the effective index is another reading.
    Accuracy: relative error below 1e-13 / min(sqrt(v), s) of the value, or 1e-300. [MaterialX2026],
    Chiang Hair Scattering Equations and Chiang Hair Model; [Chiang2016].

        >>> chiang_hair_bcsdf([0.6, 0.0, 0.8], [-0.6, 0.0, 0.8]).round(6)
        array([0.137704, 0.137704, 0.137704])
    """
    form: HairForm = inputs.pop("form", TEXT)
    vectors = {"wo": checked_directions("wo", wo), "wi": checked_sphere("wi", wi)}
    values = _checked(inputs, vectors["wo"])
    numbers = {name: values.pop(name) for name in ("ior", "cuticle_angle")}
    colors = {name: values[name] for name in (*TINTS, "absorption_coefficient")}

    # Sum the tinted lobes; that of the higher orders has the tint of TRT.
    def formula(wo: Array, wi: Array, **inputs: Array) -> Array:
        lobes = _lobes(wo, wi, inputs, form)
        tints = [inputs[name] for name in (*TINTS, TINTS[-1])]
        first, *others = (tint * lobe for tint, lobe in zip(tints, lobes, strict=True))
        return form.factor * sum(others, first)

    return evaluate_material(formula, vectors | values, numbers, channel_count(colors), BLOCK)


@any_array
def chiang_hair_attenuation(
    wo: ArrayLike, ior: ArrayLike, absorption_coefficient: ArrayLike
) -> Array:
    """Attenuation factors A_R, A_TT, A_TRT and A_TRRT+ of a view.

    - `ior` (...): Index of the fiber, in [0, 1e50].
    - `absorption_coefficient` (..., C): Per radius of the fiber, in [0, 1e50].

    Result (..., C, 4): in [0, 1]. Their sum is 1 where nothing is absorbed, and less elsewhere.
    [MaterialX2026], Chiang Hair Model, Attenuation Factors.

        >>> chiang_hair_attenuation([0.0, 0.0, 1.0], 1.55, 0.0).round(6)
        array([[0.046521, 0.909123, 0.042293, 0.002063]])
    """
    absorption = checked_color("absorption_coefficient", absorption_coefficient)
    vectors = {"wo": checked_directions("wo", wo), "absorption_coefficient": absorption}
    channels = absorption.shape[-1]

    def formula(wo: Array, absorption_coefficient: Array, ior: Array) -> Array:
        view, effective = formulas.section(wo, ior)
        factors = formulas.attenuations(view, effective, ior, absorption_coefficient, TEXT)
        rows = [factors[lobe, c] for c in range(channels) for lobe in range(len(LOBES))]
        return array_namespace(factors).stack(rows)

    values = evaluate_material(formula, vectors, {"ior": checked("ior", ior)}, 4 * channels, BLOCK)
    return array_namespace(values).reshape(values, (*values.shape[:-1], channels, 4))


@any_array
def hair_longitudinal(theta_i: ArrayLike, theta_o: ArrayLike, variance: ArrayLike) -> Array:
    """Longitudinal scattering function M.

        M = exp(-sin(theta_i) sin(theta_o) / v) I_0(cos(theta_i) cos(theta_o) / v) / (2 v sinh(1 / v))

    - `theta_i`, `theta_o`: Inclinations from the plane across the fiber, in radian,
      in [-pi/2, pi/2].
    - `variance`: v, in square radian, in [1e-12, 1e12].

    Result: above 0 up to underflow. Its integral over theta_i times cos(theta_i) is 1.
    [MaterialX2026], Chiang Hair Model, Longitudinal Scattering; [dEon2011], Eq. (7).

        >>> round(float(hair_longitudinal(0.3, -0.3, 0.01)), 6)
        4.18169
    """
    i, o, v = checked_numbers(theta_i=theta_i, theta_o=theta_o, variance=variance)
    xp = array_namespace(i, o, v)
    inclined = xp.sin(i), xp.cos(i), xp.sin(o), xp.cos(o)
    return formulas.longitudinal(*inclined, v)


@any_array
def hair_azimuthal(phi: ArrayLike, scale: ArrayLike) -> Array:
    """Azimuthal scattering function N, the logistic density trimmed to [-pi, pi].

    - `phi`: Angle from that of the exit, in radian; wrapped into [-pi, pi].
    - `scale`: s, in radian, in [1e-12, 1e12].

    Result: per radian, at least 0. Its integral over [-pi, pi] is 1. [MaterialX2026], Chiang Hair
    Model, Azimuthal Scattering; [Chiang2016], Appendix A, Eq. (12).

        >>> round(float(hair_azimuthal(0.5, 0.3)), 6)
        0.325121
    """
    return formulas.azimuthal(*checked_numbers(phi=phi, scale=scale))


DEFAULTS: dict[str, float | tuple[float, ...]] = {
    **dict.fromkeys(TINTS, (1.0, 1.0, 1.0)),
    "ior": 1.55,
    "roughness_R": (0.1, 0.1),
    "roughness_TT": (0.05, 0.05),
    "roughness_TRT": (0.2, 0.2),
    "cuticle_angle": 0.5,
    "absorption_coefficient": (0.0, 0.0, 0.0),
}


def _checked(inputs: dict[str, ArrayLike], wo: Numbers) -> dict[str, Array]:
    """Values of all ports of the node, as arrays of wo's library; those of colors (..., C)."""
    unknown = set(inputs) - set(DEFAULTS)
    if unknown:
        known = ", ".join(DEFAULTS)
        raise TypeError(f"inputs must be among {known}; got {', '.join(sorted(unknown))}")
    values = {}
    for name, value in {**DEFAULTS, **inputs}.items():
        check = checked_pairs if name in ROUGHNESSES else checked
        array = check(name, value)
        values[name] = array if library(array) else like(array, wo)
    for name in (*TINTS, "absorption_coefficient"):
        values[name] = checked_vector(name, values[name])
    return values


def _lobes(wo: Array, wi: Array, inputs: dict[str, Array], form: HairForm) -> list[Array]:
    """A_p M_p N_p of the four lobes, each (C, ...)."""
    ior, alpha = inputs["ior"], np.pi * (inputs["cuticle_angle"] - 0.5)
    view, effective = formulas.section(wo, ior)
    absorption = inputs["absorption_coefficient"]
    factors = formulas.attenuations(view, effective, ior, absorption, form)
    pairs = [inputs[name] for name in (*ROUGHNESSES, ROUGHNESSES[-1])]
    return [
        factor * formulas.distribution(view, wo, wi, (v, s), alpha, lobe, form)
        for lobe, (factor, (v, s)) in enumerate(zip(factors, pairs, strict=True))
    ]
