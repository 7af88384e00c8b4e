# SPDX-License-Identifier: Apache-2.0
"""Kinds of probes: what the tolerances of a check go by, and on each host the class of a probe.

A subject has the kind of its probe on a host that evaluates pairs of directions. On a host that shows
less of it, or shows it in another way, its probe has one of the kinds below.
"""

# Rough diffuse nodes, of which every host has a probe; the diffuse lobe of a surface shader.
DIFFUSE, LOBE = "pairs", "lobes"
# Other lobes: in closed form, sheens in closed form, sheens of powers, which shaders fit, microfacets.
CLOSED, SHEEN, FITTED, MICROFACET, SCHLICK = BSDFS = (
    "closed pairs",
    "sheen pairs",
    "fitted pairs",
    "microfacet pairs",
    "Schlick pairs",
)
MICROFACETS = (MICROFACET, SCHLICK)
HAIR, SUBSURFACE = "hair pairs", "subsurface pairs"
FILM = "film pairs"  # microfacets under a thin film
COMBINED, NESTED = "combined pairs", "nested pairs"  # nodes that combine lobes, or a sum of them
TRANSMISSION, SCHLICK_TRANSMISSION = TRANSMISSIONS = (
    "transmission pairs",
    "Schlick transmission pairs",
)
SURFACE_SHADER = "surface pairs"  # a surface shader with every lobe
# What scatters nothing: emissions by the function that limits them, media, outputs.
EMISSION, POWER_EMISSION, CONE_EMISSION = EMISSIONS = (
    "emission views",
    "power views",
    "cone views",
)
EMITTING_SURFACE = "emitting surfaces"
MEDIUM = "media"
UTILITY = "utility values"
ABSENT = "absent nodes"  # a node that no target of the standard library has

# On hosts that show pictures, and on renderers by their own nodes.
PICTURE, BSDF_PICTURE, EMISSION_PICTURE = "pictures", "bsdf pictures", "emission pictures"
UTILITY_OSL = "utility values in OSL"
EXACT, FACET, COARSE_FACET, FACET_PAIR = "exact", "facets", "coarse facets", "facet pairs"

# Kinds of what a closure tells. It has its arguments to the last bit, and no fit of a shader's.
TOLD = (DIFFUSE, *BSDFS, HAIR, SUBSURFACE, COMBINED, NESTED, FILM, *TRANSMISSIONS, SURFACE_SHADER)
# Kinds of which a renderer evaluates the closures.
RENDERED = (DIFFUSE, *BSDFS, SUBSURFACE, COMBINED, NESTED, LOBE)
TRACED = "traced"  # in place of "rendered": pairs that a path tracer shows
TRACED_CLOSURES = (
    *BSDFS,
    COMBINED,
    NESTED,
)  # those it is asked for; pictures show the diffuse ones


def closure_kind(kind: str) -> str:
    """Kind of a node's probe on a host that tells closures, by its kind on one that evaluates."""
    return f"{kind} of closures" if kind in TOLD else kind


def rendered_kind(kind: str, word: str = "rendered") -> str:
    """Kind of a node's probe on a host that evaluates the closures of a renderer, likewise."""
    return f"{word} {kind}" if kind in RENDERED else kind


def drawn_kind(precision: str, kind: str) -> str:
    """Kind of a node's probe on a host that draws a frame with a precision, likewise."""
    return f"{precision} {kind}"
