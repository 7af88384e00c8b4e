# SPDX-License-Identifier: Apache-2.0
"""Evaluates trees of OSL closures with the NumPy models."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.reference.nodes import DIFFUSE, NOTHING, ShadingPoints, albedo_at
from mxeon.conformance.samples import Array
from mxeon.errors import OutsideModel, ShaderError
from mxeon.hosts.base import Query
from mxeon.hosts.osl.carriers import LAYER, MIX, OPERATIONS, SUM
from mxeon.hosts.osl.trees import ClosureTree, TreeRows
from mxeon.models import hair, table
from mxeon.models.core import layering
from mxeon.models.core.layering import Bsdf
from mxeon.models.media import transmittance
from mxeon.models.nodes import media, microfacets, node
from mxeon.models.nodes.lobes import HAIR_NODE, SUBSURFACE_NODE
from mxeon.models.nodes.node import PbrNode, white
from mxeon.models.shading_model import ALONG, UP
from mxeon.shaders.nodes import FLAG, OREN_NAYAR

Arguments: TypeAlias = Mapping[str, Array]
THROUGH, GRAPH = "transmission", "graph"  # branches of `mxeon.hosts.base.Host.evaluate`
ONE = np.ones((1, 1))
ROUNDED = 1e-4  # largest difference of unit vectors that may be due to rounding
LEAST_HAIR = 1e-12  # smallest hair roughness; a roughness of 0 means a delta function
GGX = "ggx"  # the only supported microfacet distribution
EMISSION, MEDIUM, HAIR = "uniform_edf", "anisotropic_vdf", HAIR_NODE.category
LIGHTLESS = (EMISSION, MEDIUM, "transparent")  # closures that scatter no light at the surface
SCHLICK = node("schlick")
MICROFACETS = {row.category: row for row in (node("dielectric"), node("conductor"), SCHLICK)}
OTHERS = (node("burley"), node("translucent"), HAIR_NODE)
# Models by closure. Except for subsurface scattering, a closure has the name of a MaterialX node.
BY_CLOSURE = (
    MICROFACETS | {row.category: row for row in OTHERS} | {"subsurface_bssrdf": SUBSURFACE_NODE}
)
# Closures with two models. A keyword argument, by default 0, selects the model.
FLAGGED = {
    OREN_NAYAR: (FLAG, (DIFFUSE[False], DIFFUSE[True])),
    "sheen_bsdf": ("mode", (node("conty_kulla"), node("zeltner"))),
}


@dataclass(frozen=True)
class Views:
    """Points to shade, and the occlusion and the kind of light at these points."""

    points: ShadingPoints
    occlusion: Array  # fraction of the light from above that reaches the surface
    branch: str  # "direct", "environment" or "transmission", as in `mxeon.hosts.base.Host.evaluate`

    def bsdf(self, tree: ClosureTree | None, layered: bool) -> Bsdf:
        """Value of a closure tree, and the throughput of the tree if `layered`."""
        if tree is None or tree.name in LIGHTLESS:
            return NOTHING
        if tree.name in FLAGGED:
            keyword, models = FLAGGED[tree.name]
            flag = np.asarray(tree.arguments.get(keyword, 0.0), np.float64)
            unset, enabled = (partial(self._lobe, tree, each, layered) for each in models)
            return _mixed(unset, enabled, column(np.where(flag == 0.0, 0.0, 1.0)))
        if tree.name not in OPERATIONS:
            return self._lobe(tree, BY_CLOSURE[tree.name], layered)
        first, second = (*tree.parts, None)[:2]
        factor = column(tree.arguments["factor"]) if "factor" in tree.arguments else ONE
        if tree.name == LAYER:
            medium = _coefficient(second, "extinction", MEDIUM)
            if medium is None or not _only_medium(second):
                return layering.layer(self.bsdf(first, True), self.bsdf(second, layered))
            # A medium below a surface attenuates the light that passes through the surface.
            passed, surface = transmittance(medium, 0.0, media.METER), self.bsdf(first, layered)
            value = surface.value * (passed if self.branch == THROUGH else 1.0)
            return Bsdf(value, surface.throughput * passed)
        if tree.name == MIX:
            left, right = (partial(self.bsdf, each, layered) for each in (first, second))
            return _mixed(left, right, factor)
        if tree.name == SUM:
            return layering.add(self.bsdf(first, layered), self.bsdf(second, layered))
        if not np.any(factor):
            return NOTHING
        scaled = self.bsdf(first, layered)
        return Bsdf(factor * scaled.value, 1.0 - factor * (1.0 - scaled.throughput))

    def _lobe(self, closure: ClosureTree, row: PbrNode, layered: bool) -> Bsdf:
        """A single lobe. The throughput is 1 minus the untinted albedo, as MaterialX specifies."""
        if (facets := closure.arguments.get("distribution", GGX)) != GGX:
            rule = f"must be {GGX}, as in the node; got {facets}"
            raise ShaderError(f"osl: distribution of {closure.name} {rule}")
        names = ("normal", "curve_direction" if closure.name == HAIR else "tangent")
        normal, tangent = (
            np.broadcast_to(closure.arguments.get(name, axis), self.points.wo.shape)
            for name, axis in zip(names, (UP, ALONG), strict=True)
        )
        opposite = np.abs(normal + self.points.normal).max(axis=1) < ROUNDED
        if np.any(opposite & ((self.points.wo * self.points.normal).sum(axis=1) > ROUNDED)):
            rule = "must be the node's or face the viewer; got the opposite direction"
            raise ShaderError(f"osl: normal of {closure.name} {rule}")
        if names[1] not in closure.arguments:  # use a vector that is not parallel to the normal
            tangent = np.where(np.abs(normal[:, :1]) > 0.9, UP, ALONG)
        wo, wi = self.points.directions(normal, tangent)
        inputs = _inputs(closure, row)
        # The closure of Schlick's curve has a reflection tint, which the node's model lacks.
        tinted = row is SCHLICK
        tint = np.asarray(closure.arguments["reflection_tint"], np.float64) if tinted else ONE
        try:
            if self.branch != THROUGH:
                shade = ONE if wi is None or row.transmits else self.occlusion
                value = tint * shade * self.points.scattered(row, wo, wi, inputs)
            elif closure.name in microfacets.TRANSMISSIONS:
                passed = microfacets.TRANSMISSIONS[closure.name].passed(wo, white(inputs), True)
                value = np.asarray(closure.arguments["transmission_tint"] * passed)
            else:
                value = np.zeros(wo.shape)
            throughput = NOTHING.throughput
            if layered:
                albedo = albedo_at(row.albedo, row, wo, white(inputs))
                if closure.name in microfacets.TRANSMISSIONS:
                    reflects, passes = (
                        np.any(closure.arguments[f"{each}_tint"], axis=-1, keepdims=True)
                        for each in ("reflection", "transmission")
                    )
                    # In mode T, the reflection tint is black, but the transmission tint is not.
                    albedo = np.where(reflects | ~passes, albedo, 0.0)
                throughput = 1.0 - albedo
        except ValueError as error:
            raise OutsideModel(f"osl: {closure.name}: {error}") from None
        return Bsdf(value, throughput)


def _coefficient(tree: ClosureTree | None, argument: str, name: str) -> Array | None:
    """Weighted sum of an argument over the closures called `name`, or None without closures."""
    if tree is None:
        return None
    if tree.name == name:
        return np.asarray(tree.arguments[argument], np.float64)
    parts = [_coefficient(part, argument, name) for part in tree.parts]
    if all(part is None for part in parts):
        return None
    known = [np.zeros((1, 3)) if part is None else part for part in parts]
    factor = column(tree.arguments["factor"]) if "factor" in tree.arguments else ONE
    if tree.name == MIX:
        return np.asarray((1.0 - factor) * known[0] + factor * known[1])
    return np.asarray(factor * sum(known))


def _only_medium(tree: ClosureTree | None) -> bool:
    if tree is None or tree.name not in OPERATIONS:
        return tree is None or tree.name == MEDIUM
    return all(map(_only_medium, tree.parts))


def _mixed(first: Callable[[], Bsdf], second: Callable[[], Bsdf], share: Array) -> Bsdf:
    """A mix of two lobes with `share` of the second lobe. Lobes with share 0 are not evaluated."""
    if not np.any(share):
        return first()
    return second() if np.all(share == 1.0) else layering.mix(second(), first(), share)


def _inputs(closure: ClosureTree, row: PbrNode) -> Arguments:
    inputs = {key: value for key, value in closure.arguments.items() if not isinstance(value, str)}
    if closure.name == OREN_NAYAR:
        inputs["roughness"] = np.minimum(inputs["roughness"], table.diffuse_model(row.name).largest)
    if closure.name == HAIR:
        for name in hair.ROUGHNESSES:
            lobe = name.removeprefix("roughness_")
            rough = np.stack([inputs[f"variance_{lobe}"], inputs[f"scale_{lobe}"]], axis=-1)
            inputs[name] = np.clip(rough, LEAST_HAIR, None)
    if closure.name in MICROFACETS:
        # OpenPBR computes alphas above 1 for anisotropic lobes. Shaders clamp such alphas to 1.
        alphas = np.stack([inputs["roughness_x"], inputs["roughness_y"]], axis=-1)
        inputs["roughness"] = np.clip(alphas, 0.0, 1.0)
        inputs["tint"] = inputs.get("reflection_tint", np.ones((1, 3)))
        inputs.setdefault("color82", np.ones((1, 3)))
        inputs.setdefault("thinfilm_ior", np.full(1, 1.5))
        if not np.any(inputs.get("thinfilm_thickness", 0.0)):
            inputs.pop("thinfilm_thickness", None)
    return inputs


def column(values: ArrayLike) -> Array:
    """Numbers become a column, (N, 1). Colors, (N, 3), stay unchanged."""
    array = np.asarray(values, np.float64)
    return array if array.ndim == 2 else array.reshape(-1, 1)


def evaluate(trees: Iterable[TreeRows], query: Query) -> Array:
    """Values of a shader's closures, defined like results of `mxeon.hosts.base.Host.evaluate`."""
    _, wo, wi, inputs, branch, output, *_ = query
    values = np.zeros((len(wo), 3))
    normal = np.broadcast_to(np.asarray(inputs.get("normal", UP), np.float64), wo.shape)
    occlusion = np.broadcast_to(column(inputs.get("occlusion", 1.0)), (len(wo), 1))
    for points in trees:
        rows = points.rows
        if output == "radiance" or branch == GRAPH:
            emitted = _coefficient(points.tree, "color", EMISSION)
            values[rows] = 0.0 if emitted is None else emitted
            continue
        light = wi[rows] if branch == "direct" else None
        shaded = ShadingPoints(wo[rows], light, 1.0, normal[rows], np.array(ALONG))
        views = Views(shaded, occlusion[rows], branch)
        bsdf = views.bsdf(points.tree, output == "throughput")
        values[rows] = bsdf.throughput if output == "throughput" else bsdf.value
    return values
