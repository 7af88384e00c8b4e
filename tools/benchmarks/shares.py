# SPDX-License-Identifier: Apache-2.0
"""What each part of eonlib's microfacets costs: the shader with one part taken out, relative to stock's."""

import tempfile
from pathlib import Path

from tools.benchmarks.instructions import compiled, sources
from tools.benchmarks.registers import driver, statistics
from tools.benchmarks.rounds import Group, ratio

NODES = ("dielectric_bsdf", "conductor_bsdf", "generalized_schlick_bsdf")

# Parts by name: text of a shader, and what stands there without the part. A shader without the text has
# no such part.
PARTS = {
    "nothing": (("", ""),),
    "the film": (("if (fd.airy)\n    {\n        // Look up", "if (false)\n    {\n        // Look up"),),
    "orders of the film from the second": (("} while (order2 > limit);", "} while (false);"),),
    "width of the film's cosines": (
        ("- 0.25 * spread2 * spread2", ""),
    ),
    "facets that see the film": (
        ("microfacet_facets(lobe.mu_o, lobe.alpha)", "vec3(lobe.mu_o, 0.0, 0.0)"),
    ),
    "the film's averages for later lights": (
        ("bool is_known = is_last || dot(abs(key - microfacet_key2), vec4(1.0)) == 0.0;", "bool is_known = false;"),
        ("microfacet_key1 = key;", ""),
    ),
    "E_ss within 5e-4": (("= ggx_albedo_dir(lobe.mu_o, lobe.alpha);", "= 1.0 - 0.5 * lobe.alpha;"),),
    "F_ss": (
        ("F.average = vec3(fresnel_dielectric_avg(ior));", "F.average = F.value;"),
        ("F.average = fresnel_conductor_avg(ior, extinction);", "F.average = F.value;"),
        ("F.average = fresnel_schlick_avg(fd.F0, fd.F90, exponent, dip);", "F.average = F.value;"),
    ),
    "F of visible facets": (
        ("vec3(fresnel_dielectric(mu_visible, ior))", "F.value"),
        ("F.visible = generalized_schlick_visible(lobe, fd, dip);", "F.visible = F.value;"),
    ),
    "color82 in the averages": (
        ("vec3 dip = fresnel_schlick_dip(fd.F0, fd.F82, fd.F90, exponent);", "vec3 dip = vec3(0.0);"),
    ),
    "anisotropic masking": (
        ("return radiance * (drawn / (lobe.mu_o + sqrt(alpha2 + (1.0 - alpha2) * mu2)));", "return radiance;"),
    ),
    "the second look-up": (("i < 2 && !(dot(light", "i < 1 && !(dot(light"),),
}  # fmt: skip


def without(text, part):
    """A shader's text without a part, or None if it has no such part."""
    found = [(there, other) for there, other in PARTS[part] if there in text]
    for there, other in found:
        text = text.replace(there, other) if there else text
    return text if found else None


def measure(nodes=NODES, parts=tuple(PARTS)):
    """The `Group` of nodes and parts."""
    driver()
    figures = []
    for node in nodes:
        own, stock = sources(node).values()
        counts = _counts(stock, stock["pixel"])
        for part in parts:
            if text := without(own["pixel"], part):
                figures += [
                    ratio(f"{node} without {part}, {name}", [number], [counts[name]])
                    for name, number in _counts(own, text).items()
                ]
    title = "Parts of microfacets taken out, one at a time, relative to MaterialX's shader"
    return Group("shares", title, tuple(figures))


def _counts(stages, text):
    """What a fragment shader costs, by name."""
    with tempfile.TemporaryDirectory() as folder:
        found = statistics({**stages, "pixel": text}, Path(folder))
    return {
        "SPIR-V instructions": compiled(text, optimize=True),
        "cycles": found["Inverse Throughput"],
        "registers": found["VGPRs"],
    }
