# SPDX-License-Identifier: Apache-2.0
"""Checks of generated text, for every target, also those that nothing here can run."""

import re

from mxeon.generation import TARGETS, generate
from mxeon.results import FAILED, PASSED, Control, Result

COUNT = "a count"


def check_sources(subjects, library):
    """Results of the text checks for every subject and target.

    Returns
    -------
    tuple of Result
    """
    used = [_uses_inputs(each, target, library) for each in subjects for target in TARGETS]
    tinted = [_tints(each, library) for each in subjects if each.model == "eon"]
    return tuple(used + tinted)


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
