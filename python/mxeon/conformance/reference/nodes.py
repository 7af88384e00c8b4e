# SPDX-License-Identifier: Apache-2.0
"""Functions that evaluate nodes: lobes with a model, combinations of lobes, and number operations.

The last axis of a value holds the components. A number has the shape () or (N, 1) and applies to
all components if combined with a color or a vector.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from operator import add, mul, pow, sub, truediv
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray

from mxeon.conformance.cache import Recent, contents
from mxeon.conformance.samples import Array
from mxeon.errors import NotRun, OutsideModel
from mxeon.models.core import layering
from mxeon.models.core.layering import Bsdf, throughput
from mxeon.models.media import diffusion_blur, transmittance
from mxeon.models.microfacet import node_albedo
from mxeon.models.nodes import PBR_NODES, microfacets
from mxeon.models.nodes.lobes import HAIR_NODE, SUBSURFACE_NODE
from mxeon.models.nodes.media import METER
from mxeon.models.nodes.microfacets import MICROFACET_NODES, TRANSMISSION_NODES, TRANSMISSIONS
from mxeon.models.nodes.node import Inputs, PbrNode, white
from mxeon.models.shading_model import ALONG, UP
from mxeon.models.table import diffuse_model
from mxeon.models.thin_film import FILM
from mxeon.shaders.document.notes import out_of_range
from mxeon.shaders.document.values import Plain, label
from mxeon.shaders.nodes import DIFFUSE_NODES, EON, FLAG, value_text

Albedo: TypeAlias = Callable[[Array, Inputs], Array]

# Over a picture, a lobe's albedo is interpolated by a Chebyshev series in sqrt(mu) and cos(2 phi).
# The degrees increase until the last coefficients are below TAIL.
TAIL = 1e-6
ISOTROPIC = ((32, 0), (64, 0), (128, 0), (256, 0))
ANISOTROPIC = ((24, 12), (48, 32))
AT_ONCE = 1 << 12  # number of arguments for which a series is summed at once
CACHED = 4  # maximum number of cached lobes of a picture, up to 2.5 megabytes each
SEPARATE = 1000  # minimum number of directions for which a series is faster


class ManyMaterialsError(Exception):
    """Too many points have different materials, so integrals would take too long."""


def _directions(mu: Array, phi: Array) -> Array:
    sine = np.sqrt((1.0 - mu) * (1.0 + mu))
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=1)


def _interpolated(series: Array, wo: Array, low: float, turns: bool) -> Array:
    """Values (N, 3) of a Chebyshev series in cos(2 phi) and in sqrt(mu) from `low` to 1."""
    root = np.sqrt(np.minimum(wo[:, 2], 1.0))
    u = np.clip(2.0 * (root - low) / (1.0 - low) - 1.0, -1.0, 1.0)
    x, y = np.square(wo[:, 0]), np.square(wo[:, 1])
    v = np.zeros_like(u) if turns else (x - y) / np.maximum(x + y, 1e-300)
    # Evaluate each distinct direction once, because a picture has many equal directions.
    each, indices = np.unique(np.round(u + 1j * v, 13), return_inverse=True)
    parts = np.array_split(each, 1 + len(each) // AT_ONCE)
    sums = [chebyshev.chebval2d(part.real, part.imag, series).T for part in parts]
    return np.asarray(np.concatenate(sums)[indices], np.float64)


ALBEDOS, SERIES = Recent[Array](8), Recent[Array | None](32)  # caches of albedos and series


def _series(
    albedo: Albedo, inputs: Inputs, low: float, degrees: tuple[tuple[int, int], ...]
) -> Array | None:
    """Chebyshev coefficients of an albedo, (X, Y, 3), or None if coefficients decay too slowly."""
    for degree, turns in degrees:
        x, y = chebyshev.chebpts1(degree + 1), chebyshev.chebpts1(turns + 1)
        cosines = np.square(low + (1.0 - low) * 0.5 * (1.0 + x))
        mu, phi = np.meshgrid(cosines, 0.5 * np.arccos(y), indexing="ij")
        values = albedo(_directions(mu.ravel(), phi.ravel()), inputs).reshape(*mu.shape, 3)
        vanders = (chebyshev.chebvander(points, len(points) - 1) for points in (x, y))
        along, around = map(np.linalg.inv, vanders)
        series = np.einsum("ix,jy,xyc->ijc", along, around, values)
        tails = [series[-degree // 8 :], series[:, -2:] if turns else np.zeros(1)]
        if max(float(np.abs(tail).max()) for tail in tails) < TAIL:
            return np.asarray(series, np.float64)
    return None


COSINES = np.linspace(-1.0, 1.0, 1025)  # cosines at which diffused light is computed
REACHES = (1e-6, 1e3)  # range of mean free paths, relative to the sphere's radius


def _not_reflected(category: str, wo: Array, inputs: Inputs) -> Array:
    functions = TRANSMISSIONS[category]
    rest = 1.0 - functions.reflected(wo, microfacets.isotropic(inputs))
    return np.asarray(functions.tint(inputs) * np.maximum(rest, 0.0))


def _spread(wo: Array, wi: Array, inputs: Inputs) -> Array:
    """Radiance of subsurface scattering, relative to the irradiance of a distant light."""
    count = len(wi)
    forward = np.broadcast_to(inputs["anisotropy"], (count,))[:, np.newaxis]
    radius = np.broadcast_to(inputs["radius"], (count, 3))
    reach = np.clip(radius / np.maximum(1.0 - forward, 1e-3), *REACHES)
    mu = np.clip(wi[:, 2], -1.0, 1.0)
    if np.ptp(reach, axis=0).any():
        light = np.stack([diffusion_blur(mu, each) for each in reach.T], axis=-1)
    else:
        light = np.stack([np.interp(mu, COSINES, _blur(each)) for each in reach[0]], axis=-1)
    return np.asarray(inputs["color"] / np.pi * light)


@lru_cache(maxsize=64)
def _blur(reach: float) -> Array:
    return diffusion_blur(COSINES, reach)


# For each row's name, a function that returns the transmitted share of a uniform environment.
LET_THROUGH: dict[str, Callable[[Array, Inputs], Array]] = {
    row.name: partial(_not_reflected, row.category) for row in TRANSMISSION_NODES
}
# For each node category, the albedo that MaterialX's environment sum finds for two alphas.
SUMS: dict[str, Callable[[Array, Inputs], Array]] = {
    row.category: partial(node_albedo, row.category, summed=True) for row in MICROFACET_NODES
}
# Lobes that scatter light from all directions of the sphere, and whose values include no cosine.
SPREAD_NODE = replace(SUBSURFACE_NODE, inputs=("color", "radius", "anisotropy"), value=_spread)
AROUND = SPREAD_NODE, HAIR_NODE


def _dark(wo: Array, *_: object) -> Array:
    return np.zeros(wo.shape)


_only_passes = partial(replace, value=_dark, albedo=_dark, integral=_dark)
INNER_NODES = (
    *(x if x.fixed["scatter_mode"] == "RT" else _only_passes(x) for x in TRANSMISSION_NODES),
    *AROUND,
)
UNIT = 1e-3  # tolerance for the length of a normal


@dataclass(frozen=True, eq=False)
class ShadingPoints:
    """The points at which a graph is evaluated, and the light at these points."""

    wo: Array  # unit vectors to the viewer, in world space
    wi: Array | None  # unit vectors to a distant light; None in a uniform environment
    strength: float  # irradiance of the light, or radiance of the environment
    normal: Array  # unit normal of the surface, in world space
    tangent: Array  # unit vector orthogonal to the normal, in world space
    texcoord: Array | None = None
    most: float = np.inf  # maximum number of different materials with integrated albedos
    round: bool = False  # whether the points lie on the unit sphere
    behind: bool = False  # whether only transmitted light counts
    opacity: bool = False  # whether lobes in mode T pass the tint times all light
    searched: bool = False  # whether environment sums use both alphas for masking, as in eonlib
    _lobes: Recent[Bsdf] = field(default_factory=lambda: Recent(CACHED), init=False)

    def lobe(
        self, node: PbrNode, inputs: Inputs, layered: bool, normal: Array, tangent: Array
    ) -> Bsdf:
        """A lobe of weight 1 in a frame. The throughput is 0 unless `layered`."""
        plain = np.array_equal(normal, self.normal) and np.array_equal(tangent, self.tangent)
        wo, wi = self.local if plain else self.directions(normal, tangent)

        def scattered() -> Bsdf:
            hides = layered and node.layerable
            left = throughput(self._albedo(node.albedo, node, wo, white(inputs))) if hides else 0.0
            value = self.strength * self.scattered(node, wo, wi, inputs)
            return Bsdf(value, np.broadcast_to(left, wo.shape))

        if not plain:
            return scattered()
        # Cache lobes, because a document has equal lobes with different libraries.
        key = node, layered, *((name, contents(each)) for name, each in inputs.items())
        return self._lobes.value(key, scattered)

    def scattered(self, node: PbrNode, wo: Array, wi: Array | None, inputs: Inputs) -> Array:
        """Light that a lobe sends to the viewer, (N, 3). Directions are in the lobe's frame.

        For a distant light, the result is f |cos(theta_i)|, or 0 if the light is on the dark side.
        For an environment, the result is the directional albedo or the transmitted share.
        """
        if wi is None:
            share = LET_THROUGH.get(node.name) if self.behind else node.integral or node.albedo
            if self.opacity and node.fixed.get("scatter_mode") == "T":
                return np.broadcast_to(inputs.get("tint", np.ones(3)), wo.shape)
            two = node in MICROFACET_NODES and np.ptp(inputs["roughness"], axis=-1).any()
            if two and not self.searched:
                share = SUMS[node.category]
            return self._albedo(share, node, wo, inputs) if share else np.zeros(wo.shape)
        if node in AROUND:
            return np.asarray(node.value(wo, wi, inputs))
        lit = np.flatnonzero((wi[:, 2] < 0.0) if node.transmits else (wi[:, 2] > 0.0))
        value = np.zeros(wo.shape)
        cosine = np.minimum(np.abs(wi[lit, 2:]), 1.0)
        value[lit] = node.value(wo[lit], wi[lit], at(inputs, lit)) * cosine
        return value

    def _albedo(self, albedo: Albedo, node: PbrNode, wo: Array, inputs: Inputs) -> Array:
        """Albedo at each view, integrated or, if a picture has one material, from a series."""
        closed = not node.fitted and node.integral is None
        varied = any(len(value) > 1 for value in inputs.values())
        if varied and not closed and len(wo) > self.most:
            raise ManyMaterialsError
        if closed or varied or not self.round or len(wo) < SEPARATE:
            return albedo_at(albedo, node, wo, inputs)
        roughness = inputs.get("roughness", np.zeros(1))
        turns = roughness.ndim == 1 or bool(np.ptp(roughness[0]) == 0.0)
        low, degrees = float(np.sqrt(wo[:, 2].min())), ISOTROPIC if turns else ANISOTROPIC
        key = albedo, *((name, contents(value)) for name, value in inputs.items())
        series = SERIES.value((low, *key), lambda: _series(albedo, inputs, low, degrees))
        if series is not None:
            return _interpolated(series, wo, low, turns)
        if not turns:
            lobe = "the albedo of such an anisotropic lobe"
            raise NotRun(f"reference: {lobe} takes too long for a picture")
        # Round the cosines, because equal cosines of symmetric points on a sphere differ slightly.
        mu = np.asarray(np.round(np.minimum(wo[:, 2], 1.0), 13), np.float64)
        upright = _directions(mu, np.zeros(len(mu)))
        # Cache the albedos, because all pictures of a document have the same views.
        integrated = partial(albedo_at, albedo, node, upright, inputs)
        return ALBEDOS.value((contents(upright), *key), integrated)

    def geometry(self, name: str) -> Array:
        """Values of a geometric property by its MaterialX name. Raise NotRun for unknown names."""
        known = {"Nworld": self.normal, "Tworld": self.tangent, "UV0": self.texcoord}
        known["Bworld"] = np.cross(self.normal, self.tangent)
        if (value := known.get(name)) is None:
            raise NotRun(f"reference: this surface has no {name}")
        return value

    @cached_property
    def local(self) -> tuple[Array, Array | None]:
        """Directions to viewer and light in the surface's own frame."""
        return self.directions(self.normal, self.tangent)

    def directions(self, normal: Array, tangent: Array) -> tuple[Array, Array | None]:
        """Directions to viewer and light in a frame, whose normal is turned toward the viewer.

        Raise OutsideModel if a normal is not a unit vector.
        """
        length = np.linalg.norm(normal, axis=-1)
        if (wrong := np.ravel(length)[np.ravel(~(np.abs(length - 1.0) <= UNIT))]).size:
            raise OutsideModel(f"reference: normal must have the length 1; got {wrong[0]:g}")
        if np.all(normal == UP) and np.all(tangent == ALONG) and np.all(self.wo[:, 2] >= 0.0):
            return self.wo, self.wi
        z = np.where((self.wo * normal).sum(axis=-1, keepdims=True) < 0.0, -1.0, 1.0) * normal
        x = tangent - (tangent * z).sum(axis=-1, keepdims=True) * z
        axes = np.stack(np.broadcast_arrays(x, np.cross(z, x), z), axis=1)
        with np.errstate(invalid="ignore"):  # NaN if the tangent is along the normal
            axes = np.asarray(axes / np.linalg.norm(axes, axis=2, keepdims=True))
        return _within(axes, self.wo), None if self.wi is None else _within(axes, self.wi)


def at(inputs: Inputs, points: NDArray[np.intp]) -> dict[str, Array]:
    """Inputs at the given points. An input with a single row applies to all points."""
    return {name: each[points] if len(each) > 1 else each for name, each in inputs.items()}


def albedo_at(albedo: Albedo, node: PbrNode, wo: Array, inputs: Inputs) -> Array:
    """An albedo of a lobe at each view. Equal views with equal inputs share one integral."""
    wo = np.minimum(wo, 1.0)  # rounded cosines may exceed 1
    if not node.fitted and node.integral is None:
        return np.asarray(np.broadcast_to(albedo(wo, inputs), wo.shape))
    varied = [np.reshape(each, (len(wo), -1)) for each in inputs.values() if len(each) > 1]
    rows = np.round(np.concatenate([wo, *varied], axis=1), 13)
    _, first, places = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    return np.asarray(albedo(wo[first], at(inputs, first))[places.ravel()])


def _within(axes: Array, directions: Array) -> Array:
    """Unit vectors in frames whose axes are the rows of the matrices `axes`, (N, 3)."""
    local = (axes @ directions[:, :, np.newaxis])[:, :, 0]
    return np.asarray(local / np.linalg.norm(local, axis=1, keepdims=True), np.float64)


DIFFUSE = {False: diffuse_model("qon"), True: replace(diffuse_model("eon"), category=EON)}
MODELS = (*PBR_NODES, *INNER_NODES)
LOBES = {
    category: tuple(row for row in MODELS if row.category == category)
    for category in (*DIFFUSE_NODES, *(row.category for row in MODELS))
}

NOTHING = Bsdf(np.zeros(3), np.ones(3))  # an absent lobe

# For each node that combines lobes, the names of the inputs and a function of the inputs.
COMBINATIONS: dict[str, tuple[tuple[str, ...], Callable[..., Bsdf]]] = {
    "layer": (("top", "base"), layering.layer),
    "mix": (("fg", "bg", "mix"), layering.mix),
    "add": (("in1", "in2"), layering.add),
    "multiply": (("in1", "in2"), layering.multiply),
}


@dataclass(frozen=True, eq=False)
class ShownLobe:
    """A lobe with a nonzero weight."""

    category: str
    inputs: Mapping[str, Array]


def node_lobe(
    node: mx.Node, inputs: Mapping[str, Array], points: ShadingPoints, layered: bool
) -> Bsdf:
    """Lobe of a node. Raise NotRun for input values that the models do not cover."""
    weight = np.reshape(inputs.get("weight", np.ones(1)), (-1, 1))  # hair has no weight
    if (beyond := weight[~((weight >= 0.0) & (weight <= 1.0))]).size:
        raise _outside(node, f"weight must lie in [0, 1]; got {beyond[0]:g}")
    if not weight.any():
        return NOTHING
    row = _row(node, inputs)
    uniform = points.wi is None and row.name in LET_THROUGH
    if row in INNER_NODES and not (points.round or uniform):
        raise NotRun(f"reference: there is no model for this mode of node {node.getCategory()!r}")
    # Every input that the model lacks must have the default value.
    known = {"weight", "normal", "tangent", "curve_direction", FLAG, *FILM, *row.inputs, *row.fixed}
    for port, value in inputs.items():
        default = node.getNodeDef().getActiveInput(port).getValue()
        if port not in known and not np.array_equal(value, np.asarray(plain(default))):
            place = f"input {port!r} of node {node.getCategory()!r}"
            raise NotRun(f"reference: there is no model for {place}")
    film = FILM if np.any(inputs.get(FILM[0], 0.0)) else ()
    arguments = {port: _argument(node, port, inputs[port], weight) for port in (*row.inputs, *film)}
    if row.name == "qon":
        # MaterialX's float32 value of pi / 2 exceeds the largest roughness of the model.
        rounded = np.float32(arguments["roughness"]) == np.float32(np.pi / 2.0)
        arguments["roughness"] = np.where(rounded, np.pi / 2.0, arguments["roughness"])
    tangent = inputs.get("tangent", inputs.get("curve_direction", points.tangent))
    try:
        values = points.lobe(row, arguments, layered, inputs["normal"], tangent)
    except ValueError as error:
        words = str(error).replace("rho must", "color must").replace("sigma must", "roughness must")
        raise _outside(node, words) from None
    return Bsdf(values.value * weight, 1.0 - weight * (1.0 - values.throughput))


def _outside(node: mx.Node, words: str) -> OutsideModel:
    """The error for a value that a node's model does not cover, with the name of the input."""
    document = f"{label(node.getDocument())}: "
    for port in node.getInputs():
        if text := out_of_range(port):
            return OutsideModel(text.removeprefix(document), port.getNamePath())
    return OutsideModel(f"reference: node {node.getNamePath()!r}: {words}")


def _row(node: mx.Node, inputs: Mapping[str, Array]) -> PbrNode:
    category = node.getCategory()
    if category in DIFFUSE_NODES:
        return DIFFUSE[category == EON or bool(np.any(inputs[FLAG]))]
    for row in LOBES[category]:
        if all(value_text(inputs[port]) == value for port, value in row.fixed.items()):
            return row
    raise NotRun(f"reference: there is no model for this mode of node {category!r}")


def _argument(node: mx.Node, port: str, value: Array, weight: Array) -> Array:
    """Value of an input: (1,) or (N,) for a number, and (1, C) or (N, C) for C components.

    Where the lobe's weight is 0, the value may be NaN, so the value at another point replaces NaN.
    """
    kind = node.getNodeDef().getActiveInput(port).getType()
    if kind not in WIDTHS:
        array = np.reshape(np.asarray(value, np.float64), -1)
    else:
        array = np.atleast_2d(np.asarray(value, np.float64))
        if port == "roughness":  # shaders clamp OpenPBR's alphas, which can exceed 1, to 1
            array = np.clip(array, 0.0, 1.0)
        array = np.broadcast_to(array, (len(array), WIDTHS[kind]))
    idle = weight[:, 0] == 0.0
    if len(array) != len(idle) or not idle.any():
        return array
    filled = array.copy()
    filled[idle] = array[int(idle.argmin())]
    return filled


def plain(value: Plain) -> Array | bool | str | None:
    """A MaterialX value as a bool, a string, an array or None. Raise NotRun for a matrix."""
    if value is None or isinstance(value, (bool, str)):
        return value
    if isinstance(value, (mx.Matrix33, mx.Matrix44)):
        raise NotRun("reference: matrix values are not supported")
    return np.asarray(value if isinstance(value, (int, float)) else tuple(value), dtype=np.float64)


# --- nodes that compute numbers -------------------------------------------------------------------

# Value of a node or input: an array, a flag, a string, a lobe, outputs by name, or None.
Value: TypeAlias = Array | bool | str | Bsdf | Mapping[str, Array] | None
# Names of a node's inputs, and a function of the inputs.
Operation: TypeAlias = tuple[tuple[str, ...], Callable[..., Value]]

# Number of components of each type with several components.
WIDTHS = {"vector2": 2, "color3": 3, "vector3": 3, "color4": 4, "vector4": 4}


def fitted(kind: str, value: Value) -> Value:
    """A value converted to a type. A number is repeated for all components.

    Missing components become 0, but a missing alpha becomes 1.
    """
    width = WIDTHS.get(kind, 1)
    if width == 1 or value is None or isinstance(value, str):
        return value
    array = np.atleast_1d(np.asarray(value, np.float64))
    have = array.shape[-1]
    if have == 1:
        return np.repeat(array, width, axis=-1)
    if have < width:
        rest = np.full((*array.shape[:-1], width - have), 1.0 if kind == "color4" else 0.0)
        return np.concatenate([array, rest], axis=-1)
    return array[..., :width]


def same(value: Value) -> Value:
    return value


def _dot(in1: Array, in2: Array) -> Array:
    return np.asarray((in1 * in2).sum(axis=-1, keepdims=True), np.float64)


def _normalize(value: Array) -> Array:
    return value / np.sqrt(_dot(value, value))


def _combine(*values: Array) -> Array:
    parts = np.broadcast_arrays(*(np.atleast_1d(value) for value in values))
    return np.concatenate(parts, axis=-1)


def _rotate3d(value: Array, amount: Array, axis: Array) -> Array:
    """Rodrigues' formula for row vectors and an angle in degrees."""
    angle, axis = np.radians(amount), _normalize(axis)
    along = axis * _dot(axis, value) * (1.0 - np.cos(angle))
    return np.asarray(value * np.cos(angle) + np.cross(value, axis) * np.sin(angle) + along)


def _normalmap(
    value: Array, scale: Array, normal: Array, tangent: Array, bitangent: Array
) -> Array:
    """World-space normal from a color that encodes a vector in the surface's frame."""
    x, y, z = np.moveaxis(2.0 * value - 1.0, -1, 0)[..., np.newaxis]
    scale = np.atleast_1d(scale)
    mapped = tangent * x * scale[..., :1] + bitangent * y * scale[..., -1:] + normal * z
    black = _dot(value, value) == 0.0
    return _normalize(np.where(black, normal, mapped))


def _when(compare: Callable[..., NDArray[np.bool_]]) -> Operation:
    """The operation that returns in1 where `compare(value1, value2)` is true, otherwise in2."""

    def choose(value1: Array, value2: Array, in1: Array, in2: Array) -> Array:
        return np.where(compare(value1, value2), in1, in2)

    return ("value1", "value2", "in1", "in2"), choose


UNARY, BINARY = ("in",), ("in1", "in2")

# For each node that computes numbers, the names of the inputs and a function of the inputs.
OPERATIONS: dict[str, Operation] = {
    "constant": (("value",), same),
    "convert": (UNARY, lambda value: np.asarray(value, np.float64)),
    "dot": (UNARY, same),
    "add": (BINARY, add),
    "subtract": (BINARY, sub),
    "multiply": (BINARY, mul),
    "divide": (BINARY, truediv),
    "power": (BINARY, pow),
    "min": (BINARY, np.minimum),
    "max": (BINARY, np.maximum),
    "clamp": (("in", "low", "high"), lambda x, low, high: np.minimum(np.maximum(x, low), high)),
    "invert": (("amount", "in"), sub),
    "absval": (UNARY, np.abs),
    "sign": (UNARY, np.sign),
    "sqrt": (UNARY, np.sqrt),
    "ln": (UNARY, np.log),
    "normalize": (UNARY, _normalize),
    "rotate3d": (("in", "amount", "axis"), _rotate3d),
    "normalmap": (("in", "scale", "normal", "tangent", "bitangent"), _normalmap),
    "combine2": (BINARY, _combine),
    "combine3": (("in1", "in2", "in3"), _combine),
    "extract": (("in", "index"), lambda x, index: np.take(x, [int(np.ravel(index)[0])], axis=-1)),
    "luminance": (("in", "lumacoeffs"), lambda value, weights: _dot(value[..., :3], weights)),
    "mix": (("fg", "bg", "mix"), lambda fg, bg, mix: fg * mix + bg * (1.0 - mix)),
    "ifgreater": _when(np.greater),
    "ifgreatereq": _when(np.greater_equal),
    "ifequal": _when(np.equal),
}

# --- volumes --------------------------------------------------------------------------------------

# Volume nodes that may be the base of a layer. The value of a volume is a transmittance.
VOLUMES: dict[str, Operation] = {
    "absorption_vdf": (("absorption",), lambda a: transmittance(a, 0.0, METER)),
    "anisotropic_vdf": (("absorption", "scattering"), lambda a, s: transmittance(a, s, METER)),
}
