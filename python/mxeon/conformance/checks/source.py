# SPDX-License-Identifier: Apache-2.0
"""Checks of generated text, for every target, also those that nothing here can run."""

import re
from collections.abc import Callable, Iterable

from mxeon.conformance.checks.nodes import Subject
from mxeon.conformance.results import FAILED, PASSED, Control, Result
from mxeon.shaders.generation import TARGETS, generate

# Targets whose text holds the BSDF itself; the others call a closure of their renderer.
WITH_BSDF = tuple(target for target in TARGETS if target not in ("osl", "mdl"))
STOCK_LINE = "    float LdotV = clamp(dot(L, V), M_FLOAT_EPS, 1.0);\n"
CLAMP = re.compile(r"\bclamp\(dot\(L, V\)")
TINT = re.compile(r"(?<=multiscatter_tint: ).*(?=\)\)\))")
WHITE_LOBE = "FON + white lobe, as MDL's module pbrlib_1_10 defines this node; read, not run"
FUNCTION = {"eon": "eon_brdf_mu", "qon": "qon_brdf_mu"}


def check_sources(subjects: Iterable[Subject], library: str) -> tuple[Result, ...]:
    """Results of the text checks for every subject and target.

    Returns
    -------
    tuple of Result
    """
    subjects = list(subjects)
    used = [_uses_inputs(each, target, library) for each in subjects for target in TARGETS]
    tinted = [_tints(each, library) for each in subjects if each.model == "eon"]
    inside = [
        check(each, target, library)
        for each in subjects
        for target in WITH_BSDF
        for check in _checks_of_text(each, library)
    ]
    return tuple(used + tinted + inside)


def _checks_of_text(subject: Subject, library: str) -> list[Callable[[Subject, str, str], Result]]:
    """Those that apply: QON's text may hold the other model's, which the flag leaves out."""
    applies = {_does_not_clamp: subject.model == "eon", _is_ours: library == "eonlib"}
    return [check for check, does in applies.items() if does]


def _uses_inputs(subject: Subject, target: str, library: str) -> Result:
    """Every input of the node has to occur in the source beyond its declaration."""
    text, variables = _source(subject, target, library)
    unused = _unused(text, variables)
    noticed = [
        name
        for name, word in variables.items()
        if name in _unused(_without_use(text, word), variables)
    ]
    caught = len(noticed) == len(variables)
    return _result(
        "source",
        "Every input of the node is used by the generated source.",
        (f"{subject.title}, {target}", library),
        (len(unused), "inputs"),
        f"never used: {', '.join(unused)}",
        Control("the uses of each input in turn are taken out", len(noticed), caught),
    )


def _does_not_clamp(subject: Subject, target: str, library: str) -> Result:
    """The cosine between the directions has to keep its sign: back-lit pairs need it."""
    text, _ = _source(subject, target, library)
    clamps, planted = (len(CLAMP.findall(each)) for each in (text, text + STOCK_LINE))
    return _result(
        "clamp",
        "The cosine between the two directions is not clamped in the generated source.",
        (f"{subject.title}, {target}", library),
        (clamps, "clamps"),
        "s is wrong for back-lit pairs",
        Control("the stock node's line is put into the text", planted, planted > clamps),
    )


def _is_ours(subject: Subject, target: str, library: str) -> Result:
    """The model's function has to be defined in the text, or another implementation was found."""
    text, _ = _source(subject, target, library)
    definition = re.compile(rf"\b(?:vec3|float3) {FUNCTION[subject.model]}\(")
    missing, renamed = (
        float(not definition.search(each)) for each in (text, definition.sub("vec3 another(", text))
    )
    return _result(
        "ours",
        "The generated source holds the library's own function.",
        (f"{subject.title}, {target}", library),
        (missing, "missing functions"),
        f"{FUNCTION[subject.model]} is not defined",
        Control("the function is defined by another name", renamed, renamed > 0.0),
    )


def _tints(subject: Subject, library: str) -> Result:
    """MDL's multiple-scattering lobe has to carry the color: white light leaves black surfaces."""
    text, variables = _source(subject, "mdl", library)
    white, planted = (
        float(not _tinted(each, variables)) for each in (text, re.sub(TINT, "color(1.0)", text))
    )
    return _result(
        "tint",
        "The multiple-scattering lobe is tinted by the color, so black stays black.",
        (f"{subject.title}, mdl", library),
        (white, "untinted lobes"),
        WHITE_LOBE,
        Control("the tint is white", planted, planted > 0.0),
    )


def _result(key, claim, place, found, unless, control):
    """Result of counting what must not be there; `unless` says what it means if it is."""
    (subject, library), (error, unit) = place, found
    return Result(
        check=key,
        claim=claim,
        subject=subject,
        host="source",
        library=library,
        verdict=PASSED if error == 0 and control.caught else FAILED,
        error=error,
        unit=unit,
        tolerance=0,
        derivation="a count",
        diagnosis=unless if error else "",
        control=control,
    )


def _tinted(text: str, variables: dict[str, str]) -> bool:
    found = TINT.search(text)
    return bool(found) and variables["color"] in found[0]


def _source(subject: Subject, target: str, library: str) -> tuple[str, dict[str, str]]:
    """Text of the pixel stage, and the variable that carries each input of the node."""
    shader = generate(subject.document({"normal": (0.0, 0.6, 0.8)}), target, library=library)[0]
    return shader.stages["pixel"], {name: f"lobe_{name}" for name in subject.inputs}


def _without_use(text: str, word: str) -> str:
    """The text with a variable declared, and not used."""
    declared, name, rest = text.partition(word)
    return declared + name + re.sub(rf"\b{word}\b", "x", rest)


def _unused(text: str, variables: dict[str, str]) -> list[str]:
    """Inputs whose variable does not occur twice: once declared, once used."""
    return [name for name, word in variables.items() if len(re.findall(rf"\b{word}\b", text)) < 2]
