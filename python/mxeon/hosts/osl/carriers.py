# SPDX-License-Identifier: Apache-2.0
"""OSL text before a generated shader that turns its closures into printable labels.

OSL prints closures with six digits, and only closures that the renderer supports. Here every closure of MaterialX, and
every operation on closures, is a function that returns a holdout, labeled with its text. Nine digits
restore a float32 exactly. The shader itself is unchanged.

    layer<mul<0.5|sheen_bsdf<0 0 1|1 1 1|0.300000012>>|burley_diffuse_bsdf<0 0 1|1 1 1|0>>
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product

MULTIPLE, SUM, MIX, LAYER = OPERATIONS = ("mul", "add", "mix", "layer")
PAIRS = 2  # maximum number of keywords in a call of a closure


@dataclass(frozen=True)
class Signature:
    """Arguments of a closure, as OSL's stdosl.h documents them."""

    arguments: Mapping[str, str]  # OSL types by name, in order
    keywords: tuple[str, ...] = ()  # `label` has no effect and is not included
    kind: str = "float"  # type of the keywords' values; OSL drops a keyword with another type


FRAME_TYPES = {"normal": "normal", "tangent": "vector"}
TINTS = {"reflection_tint": "color", "transmission_tint": "color"}
ALPHAS = {"roughness_x": "float", "roughness_y": "float"}
ROUGH = {"normal": "normal", "color": "color", "roughness": "float"}
DISTRIBUTION = {"distribution": "string"}
FILM = ("thinfilm_thickness", "thinfilm_ior")
# `energy_compensation` came with OSL 1.14.1, `mode` with OSL 1.13; stdosl.h names neither.
CLOSURES = {
    "oren_nayar_diffuse_bsdf": Signature(ROUGH, ("energy_compensation",), "int"),
    "burley_diffuse_bsdf": Signature(ROUGH),
    "sheen_bsdf": Signature(ROUGH, ("mode",), "int"),
    "translucent_bsdf": Signature({"normal": "normal", "color": "color"}),
    "subsurface_bssrdf": Signature(
        {"normal": "normal", "color": "color", "radius": "color", "anisotropy": "float"}
    ),
    "dielectric_bsdf": Signature(
        FRAME_TYPES | TINTS | ALPHAS | {"ior": "float"} | DISTRIBUTION, FILM
    ),
    "conductor_bsdf": Signature(
        FRAME_TYPES | ALPHAS | {"ior": "color", "extinction": "color"} | DISTRIBUTION, FILM
    ),
    "generalized_schlick_bsdf": Signature(
        FRAME_TYPES
        | TINTS
        | ALPHAS
        | {"color0": "color", "color90": "color", "exponent": "float"}
        | DISTRIBUTION,
        FILM,
    ),
    "chiang_hair_bsdf": Signature(
        {"normal": "normal", "curve_direction": "vector"}
        | {f"tint_{lobe}": "color" for lobe in ("R", "TT", "TRT")}
        | {"ior": "float"}
        | {f"variance_{lobe}": "float" for lobe in ("R", "TT", "TRT")}
        | {f"scale_{lobe}": "float" for lobe in ("R", "TT", "TRT")}
        | {"cuticle_angle": "float", "absorption_coefficient": "color"}
    ),
    "uniform_edf": Signature({"color": "color"}),
    "anisotropic_vdf": Signature({"albedo": "color", "extinction": "color", "anisotropy": "float"}),
    "transparent": Signature({}),
}


# Text that Blender's OSL prints before and after the label of a closure.
BEFORE, AFTER = '(1, 1, 1) * holdout ("label", "', '")'
# OSL truncates formatted closures after 1024 characters, and Blender truncates lines. So each closure is printed where
# it is made, and its label is the hash of its text.
LABELS = """\
closure color mxeon_label(string text)
{{
    string label = format("@%d", hash(text));
    printf("mxeon %d %s %s\\n", MXEON_ROW, label, text);
    return holdout("label", label);
}}
string mxeon_text(int x) {{ return format("%d", x); }}
string mxeon_text(float x) {{ return format("%.9g", x); }}
string mxeon_text(color x) {{ return format("%.9g %.9g %.9g", x[0], x[1], x[2]); }}
string mxeon_text(vector x) {{ return mxeon_text((color) x); }}
string mxeon_text(normal x) {{ return mxeon_text((color) x); }}
string mxeon_text(string x) {{ return format("'%s'", x); }}
string mxeon_text(closure color x)
{{
    string label = format("%s", x);
    return startswith(label, "{before}")
        ? substr(label, {start}, strlen(label) - {rest}) : label;
}}
"""


def prelude(text: str) -> str:
    """OSL that turns a text's CLOSURES, and OPERATIONS on them, into labels."""
    start = len(BEFORE)
    labels = LABELS.format(before=BEFORE.replace('"', '\\"'), start=start, rest=start + len(AFTER))
    names = [name for name in CLOSURES if name in text]  # unused ones would cost compile time
    closure = "closure color"
    lines = [
        labels,
        _function("mxeon_layer", LAYER, closure, closure),
        _function("__operator__add__", SUM, closure, closure),
    ]
    # Operations on weights and shares; this `mix` hides stdosl.h's.
    for kind in ("float", "color"):
        lines += [
            "#pragma osl nowarn",
            _function("mix", MIX, closure, closure, kind),
            _function("__operator__mul__", MULTIPLE, closure, kind),
            _function("__operator__mul__", MULTIPLE, kind, closure),
        ]
    # Closures with any keywords, so that unknown ones are reported.
    for name in names:
        arguments = (*CLOSURES[name].arguments.values(),)
        for count in range(PAIRS + 1 if arguments else 1):
            for kinds in product((CLOSURES[name].kind, "string"), repeat=count):
                pairs = (each for kind in kinds for each in ("string", kind))
                lines.append(_function(f"mxeon_{name}", name, *arguments, *pairs))
    # Built-in functions cannot be hidden, only renamed.
    lines += [f"#define {name} mxeon_{name}" for name in (*names, "layer")]
    return "\n".join([*lines, ""])


def _function(name: str, label: str, *kinds: str) -> str:
    """OSL function that returns a label with the texts of its arguments."""
    declared = ", ".join(f"{kind} a{n}" for n, kind in enumerate(kinds))
    texts = "".join(f", mxeon_text(a{n})" for n in range(len(kinds)))
    pattern = f'"{label}<{"|".join(["%s"] * len(kinds))}>"'
    return f"closure color {name}({declared}) {{ return mxeon_label(format({pattern}{texts})); }}"
