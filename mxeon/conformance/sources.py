# SPDX-License-Identifier: Apache-2.0
"""Checks of generated text, for every target, also those that nothing here can run."""

import re

from mxeon.generation import TARGETS, generate
from mxeon.results import FAILED, PASSED, Control, Result

COUNT = "a count"

# Targets whose text holds the BSDF itself; the others call a closure of their renderer.
WITH_BSDF = tuple(target for target in TARGETS if target not in ("osl", "mdl"))
STOCK_LINE = "    float LdotV = clamp(dot(L, V), M_FLOAT_EPS, 1.0);\n"
CLAMP = re.compile(r"\bclamp\(dot\(L, V\)")
TINT = re.compile(r"(?<=multiscatter_tint: ).*(?=\)\)\))")
WHITE_LOBE = "FON + white lobe, as MDL's module pbrlib_1_10 defines this node; read, not run"
FUNCTION = {"eon": "eon_brdf_mu", "qon": "qon_brdf_mu"}


def check_sources(subjects, library):
    """Results of the text checks for every subject and target.

    Returns
    -------
    tuple of Result
    """
    used = [_uses_inputs(each, target, library) for each in subjects for target in TARGETS]
    tinted = [_tints(each, library) for each in subjects if each.model == "eon"]
    inside = [
        check(each, target, library)
        for each in subjects
        for target in WITH_BSDF
        for check in ((_does_not_clamp, _is_ours) if library != "stock" else (_does_not_clamp,))
    ]
    return tuple(used + tinted + inside)


def _uses_inputs(subject, target, library):
    """Every input of the node has to occur in the source beyond its declaration."""
    text, variables = _source(subject, target, library)
    unused = _unused(text, variables)
    noticed = [name for name in variables if name in _unused(_without_use(text, variables[name]), variables)]
    caught = len(noticed) == len(variables)
    return Result(
        check="source",
        claim="Every input of the node is used by the generated source.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=PASSED if caught and not unused else FAILED,
        figure=len(unused),
        unit="inputs",
        tolerance=0,
        derivation=COUNT,
        diagnosis=f"never used: {', '.join(unused)}" if unused else "",
        control=Control("the uses of each input in turn are taken out", len(noticed), caught),
    )


def _does_not_clamp(subject, target, library):
    """The cosine between the directions has to keep its sign: back-lit pairs need it."""
    text, _ = _source(subject, target, library)
    clamps, planted = (len(CLAMP.findall(each)) for each in (text, text + STOCK_LINE))
    return Result(
        check="clamp",
        claim="The cosine between the two directions is not clamped in the generated source.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=PASSED if clamps == 0 < planted else FAILED,
        figure=clamps,
        unit="clamps",
        tolerance=0,
        derivation=COUNT,
        diagnosis="s is wrong for back-lit pairs" if clamps else "",
        control=Control("the stock node's line is put into the text", planted, planted > clamps),
    )


def _is_ours(subject, target, library):
    """The model's function has to be defined in the text, or another implementation was found."""
    text, _ = _source(subject, target, library)
    definition = re.compile(rf"\b(?:vec3|float3) {FUNCTION[subject.model]}\(")
    missing, renamed = (
        float(not definition.search(each)) for each in (text, definition.sub("vec3 another(", text))
    )
    return Result(
        check="ours",
        claim="The generated source holds the library's own function.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=PASSED if missing < renamed else FAILED,
        figure=missing,
        unit="missing functions",
        tolerance=0,
        derivation=COUNT,
        diagnosis=f"{FUNCTION[subject.model]} is not defined" if missing else "",
        control=Control("the function is defined by another name", renamed, renamed > 0.0),
    )


def _tints(subject, library):
    """MDL's multiple-scattering lobe has to carry the colour: white light leaves black surfaces."""
    text, variables = _source(subject, "mdl", library)
    white, planted = (
        float(not _tinted(each, variables)) for each in (text, re.sub(TINT, "color(1.0)", text))
    )
    return Result(
        check="tint",
        claim="The multiple-scattering lobe is tinted by the colour, so black stays black.",
        subject=f"{subject.title}, mdl",
        host="source",
        library=library,
        verdict=PASSED if white < planted else FAILED,
        figure=white,
        unit="untinted lobes",
        tolerance=0,
        derivation=COUNT,
        diagnosis=WHITE_LOBE if white else "",
        control=Control("the tint is white", planted, planted > 0.0),
    )


def _tinted(text, variables):
    found = TINT.search(text)
    return bool(found) and variables["color"] in found[0]


def _source(subject, target, library):
    """Text of the pixel stage, and the variable that carries each input of the node."""
    shader = generate(subject.document({"normal": (0.0, 0.6, 0.8)}), target, library=library)[0]
    return shader.stages["pixel"], {name: f"lobe_{name}" for name in subject.inputs}


def _without_use(text, word):
    """The text with a variable declared, and not used."""
    declared, name, rest = text.partition(word)
    return declared + name + re.sub(rf"\b{word}\b", "x", rest)


def _unused(text, variables):
    """Inputs whose variable does not occur twice: once declared, once used."""
    return [
        name for name, word in variables.items() if len(re.findall(rf"\b{word}\b", text)) < 2
    ]
