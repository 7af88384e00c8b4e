# SPDX-License-Identifier: Apache-2.0
"""pbrlib's utility nodes, which compute the inputs of lobes, as functions of input values.

Inputs are a mapping from port names to values of shape (N,) or (N, components). Values outside the
range of a model are clamped, as implementations do, because the specification accepts [0, 1] for
most inputs and does not define the result for other values. Constants named `LEAST_...` and
`LARGEST_...` are limits inside [0, 1].
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from mxeon.models import hair
from mxeon.models.core.arguments import checked_choice
from mxeon.models.core.arrays import Array
from mxeon.models.core.colorimetry import XYZ_TO_REC709
from mxeon.models.media import LUMINANCE, blackbody, kang_xyz
from mxeon.models.microfacet.fresnel import artistic_ior
from mxeon.models.microfacet.ggx import roughness_anisotropy, roughness_dual
from mxeon.models.nodes.node import Inputs, Node, Variant

LARGEST_REFLECTIVITY = 0.99  # limit that keeps the n of artistic_ior finite
LEAST_HAIR = 1e-3  # smallest roughness and color of hair; at 0, lobes would have no width
LARGEST_MELANIN = 1.0 - 1e-4  # limit that keeps the absorption finite
LEAST_PIGMENT = 1e-30  # smallest color of a pigment; the logarithm of 0 would be infinite
TEMPERATURES = (800.0, 25000.0)  # unit: K; bodies glow above 800 K, and common fits end at 25000 K

Outputs = Callable[[Inputs], dict[str, Array]]


@dataclass(frozen=True)
class UtilityNode(Node[Outputs]):
    """A utility node of [MaterialX2026].

    - `inputs`: The default of each input, a number or a tuple, by the name of the input.
    - `value`: Function that computes all outputs, by name, from all inputs.
    """

    inputs: Mapping[str, float | tuple[float, ...]] = field(hash=False)
    outputs: Mapping[str, str] = field(hash=False)  # output types by name


def utility(
    category: str,
    inputs: Mapping[str, float | tuple[float, ...]],
    outputs: Mapping[str, str],
    value: Outputs,
    variants: tuple[Variant[Outputs], ...],
) -> UtilityNode:
    title = f"the equations of {category}"
    return UtilityNode(category, title, category, inputs, value, outputs, variants=variants)


def _clamped(inputs: Inputs, name: str, least: float = 0.0, largest: float = 1.0) -> Array:
    return np.clip(np.asarray(inputs[name], np.float64), least, largest)


def _roughness(inputs: Inputs) -> Array:
    if "glossiness" in inputs:
        return np.asarray(1.0 - _clamped(inputs, "glossiness"))
    return _clamped(inputs, "roughness")


def _anisotropy(inputs: Inputs) -> dict[str, Array]:
    return {"out": roughness_anisotropy(_roughness(inputs), _clamped(inputs, "anisotropy"))}


def _without_square(inputs: Inputs) -> dict[str, Array]:
    """Roughnesses alpha, computed as if the input roughness were not squared."""
    function = _anisotropy if "anisotropy" in inputs else _dual
    root = {**inputs, "roughness": np.sqrt(_roughness(inputs))}
    return function({name: value for name, value in root.items() if name != "glossiness"})


def _burley_aspect(inputs: Inputs) -> dict[str, Array]:
    """Roughnesses alpha of [Burley2012] with the aspect ratio sqrt(1 - 0.9 anisotropy)."""
    alpha = np.square(_roughness(inputs))
    aspect = np.sqrt(1.0 - 0.9 * _clamped(inputs, "anisotropy"))
    return {"out": np.stack([np.minimum(alpha / aspect, 1.0), alpha * aspect], axis=-1)}


def _openpbr_aspect(inputs: Inputs) -> dict[str, Array]:
    """Roughnesses alpha of OpenPBR. The mean of alpha^2 does not depend on the anisotropy."""
    rest = 1.0 - _clamped(inputs, "anisotropy")
    along = np.square(_roughness(inputs)) * np.sqrt(2.0 / (1.0 + rest * rest))
    return {"out": np.stack([along, rest * along], axis=-1)}


def _dual(inputs: Inputs) -> dict[str, Array]:
    """Squares of two roughnesses. The first roughness replaces a negative second roughness."""
    pair = np.asarray(inputs["roughness"], np.float64)
    second = np.where(pair[..., 1] < 0.0, pair[..., 0], pair[..., 1])
    return {"out": roughness_dual(np.clip(np.stack([pair[..., 0], second], axis=-1), 0.0, 1.0))}


def _artistic(inputs: Inputs) -> dict[str, Array]:
    reflectivity = _clamped(inputs, "reflectivity", 0.0, LARGEST_REFLECTIVITY)
    ior, extinction = artistic_ior(reflectivity, _clamped(inputs, "edge_color"))
    return {"ior": ior, "extinction": extinction}


def _clipped(inputs: Inputs) -> dict[str, Array]:
    """Blackbody color, scaled to luminance 1 before negative channels are set to 0."""
    return {"out": np.maximum(blackbody(_clamped(inputs, "temperature", *TEMPERATURES)), 0.0)}


def _blackbody(inputs: Inputs) -> dict[str, Array]:
    """Blackbody color, scaled to luminance 1 after negative channels are set to 0."""
    color = _clipped(inputs)["out"]
    return {"out": color / (color @ LUMINANCE)[..., np.newaxis]}


def _hair_roughness(inputs: Inputs) -> dict[str, Array]:
    numbers = [_clamped(inputs, name, LEAST_HAIR) for name in ("longitudinal", "azimuthal")]
    scales = [np.abs(np.asarray(inputs[name], np.float64)) for name in ("scale_TT", "scale_TRT")]
    pairs = hair.chiang_hair_roughness(*numbers, *scales)
    return dict(zip(("roughness_R", "roughness_TT", "roughness_TRT"), pairs, strict=True))


def _unsquared_variance(inputs: Inputs) -> dict[str, Array]:
    """Roughness pairs whose first component is the standard deviation instead of the variance."""
    pairs = _hair_roughness(inputs)
    return {
        name: np.stack([np.sqrt(pair[..., 0]), pair[..., 1]], -1) for name, pair in pairs.items()
    }


def _melanin(inputs: Inputs) -> dict[str, Array]:
    colors = [
        _clamped(inputs, name, LEAST_PIGMENT) for name in ("eumelanin_color", "pheomelanin_color")
    ]
    concentration = _clamped(inputs, "melanin_concentration", 0.0, LARGEST_MELANIN)
    redness = _clamped(inputs, "melanin_redness")
    return {"absorption": hair.deon_hair_absorption_from_melanin(concentration, redness, *colors)}


def _absorption(inputs: Inputs) -> dict[str, Array]:
    color, roughness = (
        _clamped(inputs, "color", LEAST_HAIR),
        _clamped(inputs, "azimuthal_roughness"),
    )
    return {"absorption": hair.chiang_hair_absorption_from_color(color, roughness)}


def _constant(function: Outputs, value: float) -> Variant[Outputs]:
    """The variant of a node's function in which every output is `value`."""
    return Variant(
        f"{value:g}, whatever the inputs are",
        lambda inputs: {k: np.full_like(each, value) for k, each in function(inputs).items()},
    )


ASPECTS = (
    Variant("Burley's aspect of 2012", _burley_aspect, permitted=True),
    Variant("OpenPBR's aspect", _openpbr_aspect, permitted=True),
    Variant("a roughness that is not squared", _without_square),
)
UTILITIES = (
    utility(
        "roughness_anisotropy",
        {"roughness": 0.0, "anisotropy": 0.0},
        {"out": "vector2"},
        _anisotropy,
        ASPECTS,
    ),
    utility("roughness_dual", {"roughness": (0.0, 0.0)}, {"out": "vector2"}, _dual, ASPECTS[2:]),
    utility(
        "glossiness_anisotropy",
        {"glossiness": 1.0, "anisotropy": 0.0},
        {"out": "vector2"},
        _anisotropy,
        ASPECTS,
    ),
    utility(
        "artistic_ior",
        {"reflectivity": (0.944, 0.776, 0.373), "edge_color": (0.998, 0.981, 0.751)},
        {"ior": "color3", "extinction": "color3"},
        _artistic,
        (
            Variant(
                "the ends of n exchanged",
                lambda i: _artistic({**i, "edge_color": 1.0 - _clamped(i, "edge_color")}),
            ),
        ),
    ),
    utility(
        "blackbody",
        {"temperature": 5000.0},
        {"out": "color3"},
        _blackbody,
        (
            Variant("luminance 1 before negative channels are clipped", _clipped, permitted=True),
            Variant(
                "Kang's cubic, extrapolated below 1667 K",
                lambda i: {
                    "out": np.maximum(
                        kang_xyz(_clamped(i, "temperature", *TEMPERATURES)) @ XYZ_TO_REC709.T, 0.0
                    )
                },
            ),
        ),
    ),
    utility(
        "chiang_hair_roughness",
        {"longitudinal": 0.1, "azimuthal": 0.2, "scale_TT": 0.5, "scale_TRT": 2.0},
        {name: "vector2" for name in ("roughness_R", "roughness_TT", "roughness_TRT")},
        _hair_roughness,
        (
            _constant(_hair_roughness, 0.0),
            Variant(
                "scales that are not squared",
                lambda i: _hair_roughness(
                    {**i, **{n: np.sqrt(np.abs(i[n])) for n in ("scale_TT", "scale_TRT")}}
                ),
            ),
            Variant("a deviation instead of the variance", _unsquared_variance),
        ),
    ),
    utility(
        "deon_hair_absorption_from_melanin",
        {
            "melanin_concentration": 0.25,
            "melanin_redness": 0.5,
            "eumelanin_color": tuple(np.exp(-np.array(hair.EUMELANIN)).round(6).tolist()),
            "pheomelanin_color": tuple(np.exp(-np.array(hair.PHEOMELANIN)).round(6).tolist()),
        },
        {"absorption": "vector3"},
        _melanin,
        (
            _constant(_melanin, 1.0),
            Variant(
                "the shares of both melanins exchanged",
                lambda i: _melanin({**i, "melanin_redness": 1.0 - _clamped(i, "melanin_redness")}),
            ),
        ),
    ),
    utility(
        "chiang_hair_absorption_from_color",
        {"color": (1.0, 1.0, 1.0), "azimuthal_roughness": 0.2},
        {"absorption": "vector3"},
        _absorption,
        (_constant(_absorption, 1.0),),
    ),
)


def node(category: str) -> UtilityNode:
    rows = {row.category: row for row in UTILITIES}
    return rows[checked_choice("category", category, rows)]
