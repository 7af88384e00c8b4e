# SPDX-License-Identifier: Apache-2.0
"""Checks of generated text, for every target, also those that nothing here can run."""

import re

from mxeon.generation import TARGETS, generate
from mxeon.results import FAILED, PASSED, Control, Result

COUNT = "a count"

# Targets whose text holds the BSDF itself; the others call a closure of their renderer.
WITH_BSDF = tuple(target for target in TARGETS if target not in ("osl", "mdl"))
CLAMP = re.compile(r"\bclamp\(dot\(L, V\)")
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
    dropped = {name: text.replace(variables[name], "x") for name in variables}
    blind = [name for name in variables if not _unused(dropped[name], variables)]
    return Result(
        check="source",
        claim="Every input of the node is used by the generated source.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=FAILED if unused or blind else PASSED,
        figure=len(unused),
        unit="inputs",
        tolerance=0,
        derivation=COUNT,
        diagnosis=f"never used: {', '.join(unused)}" if unused else "",
        control=Control("each input in turn is taken out of the text", 1.0, not blind),
    )


def _does_not_clamp(subject, target, library):
    """The cosine between the directions has to keep its sign: back-lit pairs need it."""
    text, _ = _source(subject, target, library)
    clamps = len(CLAMP.findall(text))
    return Result(
        check="clamp",
        claim="The cosine between the two directions is not clamped in the generated source.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=FAILED if clamps else PASSED,
        figure=clamps,
        unit="clamps",
        tolerance=0,
        derivation=COUNT,
        diagnosis="s is wrong for back-lit pairs" if clamps else "",
        control=_clamped(text, clamps),
    )


def _clamped(text, clamps):
    found = len(CLAMP.findall(text.replace("dot(", "clamp(dot(L, V), 0.0, 1.0) + dot(", 1)))
    return Control("a clamp is put into the text", found, found > clamps)


def _is_ours(subject, target, library):
    """The model's function has to be defined in the text, or another implementation was found."""
    text, _ = _source(subject, target, library)
    definition = re.compile(rf"\b(?:vec3|float3) {FUNCTION[subject.model]}\(")
    ours = bool(definition.search(text))
    blind = bool(definition.search(text.replace(FUNCTION[subject.model], "f")))
    return Result(
        check="ours",
        claim="The generated source holds the library's own function.",
        subject=f"{subject.title}, {target}",
        host="source",
        library=library,
        verdict=PASSED if ours and not blind else FAILED,
        figure=float(not ours),
        unit="missing functions",
        tolerance=0,
        derivation=COUNT,
        diagnosis="" if ours else f"{FUNCTION[subject.model]} is not defined",
        control=Control("the function has another name", 1.0, not blind),
    )


def _tints(subject, library):
    """MDL's multiple-scattering lobe has to carry the colour: white light leaves black surfaces."""
    text, variables = _source(subject, "mdl", library)
    tinted = _tinted(text, variables)
    return Result(
        check="tint",
        claim="The multiple-scattering lobe is tinted by the colour, so black stays black.",
        subject=f"{subject.title}, mdl",
        host="source",
        library=library,
        verdict=PASSED if tinted else FAILED,
        figure=float(not tinted),
        unit="untinted lobes",
        tolerance=0,
        derivation=COUNT,
        diagnosis=""
        if tinted
        else "FON + white lobe, as MDL's module pbrlib_1_10 defines this node; read, not run",
        control=Control(
            "the tint is white", 1.0, not _tinted(re.sub(TINT, "color(1.0)", text), variables)
        ),
    )


TINT = re.compile(r"(?<=multiscatter_tint: ).*(?=\)\)\))")


def _tinted(text, variables):
    found = TINT.search(text)
    return bool(found) and variables["color"] in found[0]


def _source(subject, target, library):
    """Text of the pixel stage, and the variable that carries each input of the node."""
    shader = generate(subject.document({"normal": (0.0, 0.6, 0.8)}), target, library=library)[0]
    return shader.stages["pixel"], {name: f"lobe_{name}" for name in subject.inputs}


def _unused(text, variables):
    """Inputs whose variable does not occur twice: once declared, once used."""
    return [
        name for name, word in variables.items() if len(re.findall(rf"\b{word}\b", text)) < 2
    ]
