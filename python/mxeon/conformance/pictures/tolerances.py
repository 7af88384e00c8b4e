# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the pictures of materials: of the lobes that they have, and of what else may add to them."""

from collections.abc import Callable, Iterable, Iterator

import MaterialX as mx
import numpy as np

from mxeon.conformance.accuracy import surface_shaders as surfaces
from mxeon.conformance.accuracy.bsdf import MICROFACET_MEAN, RINGS, UNFITTED, sum_of
from mxeon.conformance.accuracy.hair import error_of
from mxeon.conformance.accuracy.thin_films import FILM_ALBEDO, FILM_TRAPPED
from mxeon.conformance.accuracy.utilities import BLACKBODY
from mxeon.conformance.probes.thin_films import LEAST_FILM
from mxeon.conformance.reference.nodes import ShownLobe
from mxeon.conformance.samples.measurement import absolute
from mxeon.conformance.samples.tolerance import ROUNDING, Tolerance
from mxeon.hosts import host_row
from mxeon.hosts.base import Host
from mxeon.io.srgb import SLOPE
from mxeon.models.hair import ROUGHNESSES
from mxeon.models.nodes import NODES
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.shaders.generation import Shader
from mxeon.shaders.inner_lobes import SUBSURFACE, inner_lobes

# Nodes whose shaders take an albedo from a fit.
FITTED_NODES = {row.category for row in NODES if row.fitted or row.mirror}
HAIR = "chiang_hair_bsdf"
COSINES = 256  # of views, among which a sheen's albedo is largest

# Errors are taken times cos(theta_o): the normal changes by its inverse from pixel to pixel.
UNIT = "pi f cos, times cos(theta_o)"
RELATIVE = "pi f cos, relative above 1, times cos(theta_o)"
PLAIN = Tolerance(
    48 * ROUNDING,
    UNIT,
    absolute,
    "16 roundings of float32, 2^-24 each, in the position of a pixel's point, and 32 in the value",
)
TEXTURED = Tolerance(
    2.0**-8,
    UNIT,
    absolute,
    "a filter's weights have 8 bits after the point, the least OpenGL asks for, and texels differ "
    "by 1 at most",
)
ENCODED = Tolerance(
    SLOPE * TEXTURED.value,
    UNIT,
    absolute,
    f"{TEXTURED.derivation}; they are codes of sRGB, whose decoding has the slope {SLOPE:.3g} at most",
)

FITTED = Tolerance(
    MICROFACET_MEAN.value + sum_of(256),
    RELATIVE,
    absolute,
    "the error of microfacets by the fit of their albedo, and that of a sum over 256 directions of an "
    "environment",
)

SHADED = Tolerance(
    surfaces.ALBEDO.value + sum_of(256),
    RELATIVE,
    absolute,
    f"the errors of all lobes of a surface shader, {surfaces.ALBEDO.value:g}, and that of a sum over 256 directions of an "
    "environment",
)


def tolerance_of(shader: Shader, lobes: Iterable[ShownLobe]) -> Tolerance:
    """Tolerance of a material's pictures: that of its lobes, with what else may add to it."""
    tolerance = _lobes_tolerance(shader)
    others = [RINGS] * (SUBSURFACE in inner_lobes(shader))
    others += [BLACKBODY] * ("blackbody" in categories(inner_nodes(shader)))
    others += _others(tuple(lobes))
    for other in others:
        words = f"{tolerance.derivation}; and {other.derivation}"
        tolerance = Tolerance(tolerance.value + other.value, RELATIVE, absolute, words)
    return tolerance


def rounded_by(host: Host, tolerance: Tolerance) -> Tolerance:
    rounding = host_row(host.name).rounding
    if not rounding:
        return tolerance
    words = f"{tolerance.derivation}; and the pixels' own rounding, {rounding:.1e}"
    return Tolerance(tolerance.value + rounding, RELATIVE, absolute, words)


def categories(elements: Iterable[mx.Element]) -> set[str]:
    return {each.getCategory() for each in elements}


def inner_nodes(shader: Shader) -> Iterator[mx.Element]:
    """Nodes of a shader's document, and those of the graphs that define them."""
    waiting, seen = [shader.document], set()
    while waiting:
        for each in waiting.pop().traverseTree():
            yield each
            graph = each.getImplementation() if each.isA(mx.Node) else None
            if graph and graph.isA(mx.NodeGraph) and graph.getNamePath() not in seen:
                seen.add(graph.getNamePath())
                waiting.append(graph)


def _others(lobes: tuple[ShownLobe, ...]) -> list[Tolerance]:
    """What inputs of lobes add: a film, an index without a fit, and narrow lobes of hair and sheen."""
    # A film, and an index below 1.
    others = [FILM_ALBEDO] * _any(lobes, "thinfilm_thickness", lambda value: value > 0.0)
    others += [FILM_TRAPPED] * _any(lobes, "thinfilm_ior", lambda value: value < LEAST_FILM)
    others += [UNFITTED] * _any(lobes, "ior", lambda value: value < 1.0, "dielectric_bsdf")
    # Narrow hair.
    hairs = [
        np.reshape(lobe.inputs[name], (-1, 2)).min(axis=0)
        for lobe in lobes
        for name in ROUGHNESSES
        if lobe.category == HAIR
    ]
    if hairs:
        words = "the roundings of hair's lobes, by the slope of their logarithms"
        others.append(Tolerance(error_of(*np.min(hairs, axis=0)), RELATIVE, absolute, words))
    # A narrow sheen.
    narrow = [
        np.ravel(lobe.inputs["roughness"]).min()
        for lobe in lobes
        if lobe.inputs.get("mode") == "conty_kulla"
    ]
    if narrow and (excess := _excess(min(narrow))):
        words = (
            "what a narrow sheen returns beyond all light, of which fits of its albedo have none"
        )
        others.append(Tolerance(excess, RELATIVE, absolute, words))
    return others


def _excess(roughness: float) -> float:
    """Light beyond all that the Conty-Kulla sheen returns, times cos(theta_o), at most."""
    mu = np.linspace(1e-3, 1.0, COSINES)
    return float((mu * (conty_kulla_albedo_dir(mu, roughness) - 1.0)).max().clip(0.0))


def _any(
    lobes: tuple[ShownLobe, ...],
    name: str,
    condition: Callable[[np.ndarray], np.ndarray],
    category: str = "",
) -> bool:
    """Whether an input fulfills a condition anywhere, in lobes of a category or in all."""
    return any(
        bool(np.any(condition(lobe.inputs[name])))
        for lobe in lobes
        if name in lobe.inputs and category in ("", lobe.category)
    )


def _lobes_tolerance(shader: Shader) -> Tolerance:
    """Tolerance of lobes without light below the surface."""
    if categories(shader.document.traverseTree()) & FITTED_NODES:
        return FITTED
    if categories(inner_nodes(shader)) & FITTED_NODES:
        return SHADED
    return _images_tolerance(shader)


def _images_tolerance(shader: Shader) -> Tolerance:
    """Tolerance of what a shader reads from images, whose filter works on codes before a decoding."""
    if not any(port.type == "filename" and port.value for port in shader.inputs):
        return PLAIN
    inputs = (each for each in inner_nodes(shader) if each.isA(mx.Input))
    encoded = any(
        each.getType() == "filename" and each.getActiveColorSpace() == "srgb_texture"
        for each in inputs
    )
    return ENCODED if encoded else TEXTURED
