# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the pictures of materials: of the lobes that they have, and of what else may add to them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace

import MaterialX as mx
import numpy as np

from mxeon.conformance.reference.nodes import ShownLobe
from mxeon.conformance.specs import surface_shaders as surfaces
from mxeon.conformance.specs.hair import lobe_terms
from mxeon.conformance.specs.microfacets import ERRORS as FACET_ERRORS
from mxeon.conformance.specs.microfacets import MEAN, sum_over
from mxeon.conformance.specs.subsurface import RINGS
from mxeon.conformance.specs.thin_films import FILM_ALBEDO, FILM_TRAPPED, LEAST_FILM
from mxeon.conformance.specs.utilities import BLACKBODY
from mxeon.conformance.tolerance import Term, Tolerance, absolute, given, roundings
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
    (roundings(16, "of a pixel's point"), roundings(32, "in the value")), UNIT, absolute, exact=True
)
# The least OpenGL asks for; texels differ by 1 at most.
TEXTURED = given(2.0**-8, UNIT, "a filter's weights of 8 bits")
ENCODED = given(
    SLOPE * TEXTURED.value, UNIT, f"filtered codes of sRGB, times its slope {SLOPE:.3g}"
)
FITTED, SHADED = (
    Tolerance((each, sum_over(256)), RELATIVE, absolute, exact=True)
    for each in (
        MEAN.term("the fits of microfacets"),
        surfaces.ALBEDO.term("all lobes of a surface shader"),
    )
)


def tolerance_of(shader: Shader, lobes: Iterable[ShownLobe]) -> Tolerance:
    """Tolerance of a material's pictures: that of its lobes, with what else may add to it."""
    rings = RINGS.term("subsurface scattering in six circles")
    others = [rings] * (SUBSURFACE in inner_lobes(shader))
    others += BLACKBODY.terms * ("blackbody" in categories(inner_nodes(shader)))
    others += _others(tuple(lobes))
    tolerance = _lobes_tolerance(shader)
    return replace(tolerance.plus(*others), unit=RELATIVE) if others else tolerance


def rounded_by(host: Host, tolerance: Tolerance) -> Tolerance:
    rounding = host_row(host.name).rounding
    if not rounding:
        return tolerance
    return replace(tolerance.plus(Term(rounding, "the pixels' own rounding")), unit=RELATIVE)


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


def _others(lobes: tuple[ShownLobe, ...]) -> list[Term]:
    """What inputs of lobes add: a film, an index below 1, and narrow lobes of hair and sheen."""
    film, trapped = FILM_ALBEDO.term("a film"), FILM_TRAPPED.term("a film of an index below 1.25")
    inside = FACET_ERRORS["denser"].term("the throughput of an index below 1")
    others = [film] * _any(lobes, "thinfilm_thickness", lambda value: value > 0.0)
    others += [trapped] * _any(lobes, "thinfilm_ior", lambda value: value < LEAST_FILM)
    others += [inside] * _any(lobes, "ior", lambda value: value < 1.0, "dielectric_bsdf")
    hairs = [
        np.reshape(lobe.inputs[name], (-1, 2)).min(axis=0)
        for lobe in lobes
        for name in ROUGHNESSES
        if lobe.category == HAIR
    ]
    if hairs:
        others += lobe_terms(*np.min(hairs, axis=0))
    sheens = (lobe for lobe in lobes if lobe.inputs.get("mode") == "conty_kulla")
    narrow = [np.ravel(lobe.inputs["roughness"]).min() for lobe in sheens]
    if narrow:
        mu = np.linspace(1e-3, 1.0, COSINES)
        excess = float((mu * (conty_kulla_albedo_dir(mu, min(narrow)) - 1.0)).max())
        if excess > 0.0:
            others.append(Term(excess, "what a narrow sheen returns beyond all light"))
    return others


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
    """Tolerance of lobes without light below the surface: of their fits, or of images.

    An image's filter works on codes, before a decoding.
    """
    if categories(shader.document.traverseTree()) & FITTED_NODES:
        return FITTED
    if categories(inner_nodes(shader)) & FITTED_NODES:
        return SHADED
    if not any(port.type == "filename" and port.value for port in shader.inputs):
        return PLAIN
    inputs = (each for each in inner_nodes(shader) if each.isA(mx.Input))
    encoded = any(
        each.getType() == "filename" and each.getActiveColorSpace() == "srgb_texture"
        for each in inputs
    )
    return ENCODED if encoded else TEXTURED
