# SPDX-License-Identifier: Apache-2.0
"""OSL text that precedes a generated shader and turns closures into printable labels.

OSL prints closures with six digits, and only closures that the renderer supports. Therefore, every
closure of MaterialX and every operation on closures becomes a function that returns a holdout. The
label of the holdout stands for text in JSON, in which numbers have nine digits and are therefore
exact in float32. The shader itself is unchanged. An example of such text, shortened:

    ["layer",["mul",0.5,["sheen_bsdf",[0,0,1],[1,1,1],0.300000012]],["burley_diffuse_bsdf",...]]
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

MULTIPLE, SUM, MIX, LAYER = OPERATIONS = ("mul", "add", "mix", "layer")
PAIRS = 2  # maximum number of keywords in a call of a closure


@dataclass(frozen=True)
class Signature:
    """Arguments of a closure according to OSL's stdosl.h."""

    arguments: Mapping[str, str]  # OSL types by name, in order
    keywords: tuple[str, ...]  # all keywords except `label`, which has no effect
    kind: str  # type of the keywords' values; OSL drops a keyword with another type


# In a signature, keywords follow the semicolon. `energy_compensation` (since OSL 1.14.1) and `mode`
# (since OSL 1.13) are missing from stdosl.h.
SIGNATURES = """
oren_nayar_diffuse_bsdf(normal normal, color color, float roughness; int energy_compensation)
burley_diffuse_bsdf(normal normal, color color, float roughness)
sheen_bsdf(normal normal, color color, float roughness; int mode)
translucent_bsdf(normal normal, color color)
subsurface_bssrdf(normal normal, color color, color radius, float anisotropy)
dielectric_bsdf(normal normal, vector tangent, color reflection_tint, color transmission_tint,
    float roughness_x, float roughness_y, float ior, string distribution;
    float thinfilm_thickness, float thinfilm_ior)
conductor_bsdf(normal normal, vector tangent, float roughness_x, float roughness_y,
    color ior, color extinction, string distribution; float thinfilm_thickness, float thinfilm_ior)
generalized_schlick_bsdf(normal normal, vector tangent, color reflection_tint,
    color transmission_tint, float roughness_x, float roughness_y, color color0, color color90,
    float exponent, string distribution; float thinfilm_thickness, float thinfilm_ior)
chiang_hair_bsdf(normal normal, vector curve_direction, color tint_R, color tint_TT, color tint_TRT,
    float ior, float variance_R, float variance_TT, float variance_TRT, float scale_R,
    float scale_TT, float scale_TRT, float cuticle_angle, color absorption_coefficient)
uniform_edf(color color)
anisotropic_vdf(color albedo, color extinction, float anisotropy)
transparent()
"""


def _signature(text: str) -> Signature:
    arguments, keywords = (
        {name: kind for kind, name in re.findall(r"(\w+) (\w+)", part)}
        for part in (text + ";").split(";")[:2]
    )
    return Signature(arguments, tuple(keywords), next(iter(keywords.values()), "float"))


CLOSURES = {name: _signature(text) for name, text in re.findall(r"(\w+)\(([^)]*)\)", SIGNATURES)}

# Text that Blender's OSL prints before and after the label of a closure.
BEFORE, AFTER = '(1, 1, 1) * holdout ("label", "', '")'
# OSL truncates formatted closures after 1024 characters, and Blender truncates lines. Each closure
# is therefore printed when it is created, and the label is a hash of the closure's text.
LABELS = """\
closure color mxeon_label(string text)
{{
    string label = format("@%d", hash(text));
    printf("mxeon %d %s %s\\n", MXEON_ROW, label, text);
    return holdout("label", label);
}}
string mxeon_text(int x) {{ return format("%d", x); }}
string mxeon_text(float x) {{ return format("%.9g", x); }}
string mxeon_text(color x) {{ return format("[%.9g,%.9g,%.9g]", x[0], x[1], x[2]); }}
string mxeon_text(vector x) {{ return mxeon_text((color) x); }}
string mxeon_text(normal x) {{ return mxeon_text((color) x); }}
string mxeon_text(string x) {{ return format("\\"%s\\"", x); }}
string mxeon_text(closure color x)
{{
    string label = format("%s", x);
    return startswith(label, "{before}")
        ? substr(label, {start}, strlen(label) - {rest}) : label == "" ? "null" : label;
}}
"""


def prelude(text: str) -> str:
    """OSL that turns the CLOSURES in a text, and OPERATIONS on closures, into labels."""
    start = len(BEFORE)
    labels = LABELS.format(before=BEFORE.replace('"', '\\"'), start=start, rest=start + len(AFTER))
    names = [name for name in CLOSURES if name in text]  # each closure takes time to compile
    closure = "closure color"
    lines = [
        labels,
        _function("mxeon_layer", LAYER, closure, closure),
        _function("__operator__add__", SUM, closure, closure),
    ]
    # A factor is a float or a color. This function `mix` hides the function `mix` of stdosl.h.
    for kind in ("float", "color"):
        lines += [
            "#pragma osl nowarn",
            _function("mix", MIX, closure, closure, kind),
            _function("__operator__mul__", MULTIPLE, closure, kind),
            _function("__operator__mul__", MULTIPLE, kind, closure),
        ]
    # Closures accept any keywords. The module `trees` reports unknown keywords.
    for name in names:
        arguments = (*CLOSURES[name].arguments.values(),)
        for count in range(PAIRS + 1 if arguments else 1):
            for kinds in product((CLOSURES[name].kind, "string"), repeat=count):
                pairs = (each for kind in kinds for each in ("string", kind))
                lines.append(_function(f"mxeon_{name}", name, *arguments, *pairs))
    # Built-in functions cannot be hidden, so macros rename the functions in calls.
    lines += [f"#define {name} mxeon_{name}" for name in (*names, "layer")]
    return "\n".join([*lines, ""])


def _function(name: str, label: str, *kinds: str) -> str:
    """OSL function that returns a label with the texts of its arguments."""
    declared = ", ".join(f"{kind} a{n}" for n, kind in enumerate(kinds))
    texts = "".join(f", mxeon_text(a{n})" for n in range(len(kinds)))
    pattern = f'"[\\"{label}\\"{",%s" * len(kinds)}]"'
    return f"closure color {name}({declared}) {{ return mxeon_label(format({pattern}{texts})); }}"
