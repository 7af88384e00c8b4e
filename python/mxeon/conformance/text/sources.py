# SPDX-License-Identifier: Apache-2.0
"""Checks of generated source, for every target, also those that nothing here can run."""

import re
import warnings
from collections.abc import Callable, Iterable
from functools import lru_cache

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.conformance.results import Result
from mxeon.conformance.text.counts import Claim, counted
from mxeon.hosts import HOSTS
from mxeon.shaders.generation import TARGETS, ApproximationWarning, generate

# Targets whose text holds the BSDF itself; the others call a closure of their renderer.
WITH_BSDF = tuple(target for target in TARGETS if target not in ("osl", "mdl"))
TEXT_ONLY = tuple(row.target for row in HOSTS if not row.module)  # targets that no host runs
STOCK_LINE = "    float LdotV = clamp(dot(L, V), M_FLOAT_EPS, 1.0);\n"
CLAMP = re.compile(r"\bclamp\(dot\(L, V\)")
FUNCTION = {"eon": "eon_brdf_mu", "qon": "qon_brdf_mu"}

USES = Claim(
    "source",
    "Every input of the node is used by the generated source.",
    "inputs",
    "the uses of each input in turn are taken out",
)
SIGNED = Claim(
    "clamp",
    "The cosine between the two directions is not clamped in the generated source.",
    "clamps",
    "the stock node's line is put into the text",
)
OURS = Claim(
    "ours",
    "The generated source holds the library's own function.",
    "missing functions",
    "the function is defined by another name",
)


def check_sources(subjects: Iterable[DiffuseSubject], library: str) -> tuple[Result, ...]:
    """Results of the checks of the generated source of every subject for every target."""
    subjects = list(subjects)
    uses = [_uses_inputs(subject, target, library) for subject in subjects for target in TARGETS]
    texts = [
        check(subject, target, library)
        for subject in subjects
        for target in WITH_BSDF
        for check in _checks_of_text(subject, library)
    ]
    return tuple(uses + texts)


def check_calls(subjects: Iterable[BsdfSubject], library: str) -> tuple[Result, ...]:
    """Results of the check that every input reaches the call, for the targets that no host runs."""
    return tuple(
        _uses_inputs(subject, target, library)
        for subject in subjects
        for target in TARGETS
        if target in TEXT_ONLY
    )


@lru_cache(maxsize=64)
def source(
    subject: DiffuseSubject | BsdfSubject, target: str, library: str, profile: str | None = None
) -> str:
    """Pixel stage of a subject; the variable of an input is `variable` of its name."""
    frame = {"normal": (0.0, 0.6, 0.8), "tangent": (1.0, 0.0, 0.0)}
    document = subject.document({name: frame[name] for name in frame if name in subject.inputs})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ApproximationWarning)
        shader = generate(document, target, library=library, profile=profile)[0]
    return shader.stages["pixel"]


def variable(name: str) -> str:
    """Variable of the generated source that carries an input of the node."""
    return f"lobe_{name}"


def _checks_of_text(
    subject: DiffuseSubject, library: str
) -> list[Callable[[DiffuseSubject, str, str], Result]]:
    """The checks that apply: QON's text may hold the other model's, which the flag leaves out."""
    applies = {_does_not_clamp: subject.model == "eon", _is_ours: library == "eonlib"}
    return [check for check, does in applies.items() if does]


def _uses_inputs(subject: DiffuseSubject | BsdfSubject, target: str, library: str) -> Result:
    """Check that every input of the node occurs in the source beyond its declaration."""
    text = source(subject, target, library)
    names = tuple(subject.types) if isinstance(subject, BsdfSubject) else subject.inputs
    unused = _unused(text, names)
    noticed = [name for name in names if name in _unused(_without_use(text, name), names)]
    control = len(noticed) if len(noticed) == len(names) else 0
    meaning = f"never used: {', '.join(unused)}"
    return counted(USES, f"{subject.title}, {target}", library, len(unused), control, meaning)


def _does_not_clamp(subject: DiffuseSubject, target: str, library: str) -> Result:
    """Check that the cosine between the directions keeps its sign: back-lit pairs need it."""
    text = source(subject, target, library)
    count, control = (len(CLAMP.findall(each)) for each in (text, text + STOCK_LINE))
    meaning = "s is wrong for back-lit pairs"
    return counted(SIGNED, f"{subject.title}, {target}", library, count, control, meaning)


def _is_ours(subject: DiffuseSubject, target: str, library: str) -> Result:
    """Check that the text defines the model's function, and not another implementation."""
    text = source(subject, target, library)
    definition = re.compile(rf"\b(?:vec3|float3) {FUNCTION[subject.model]}\(")
    count, control = (
        int(not definition.search(each)) for each in (text, definition.sub("vec3 another(", text))
    )
    meaning = f"{FUNCTION[subject.model]} is not defined"
    return counted(OURS, f"{subject.title}, {target}", library, count, control, meaning)


def _uses(name: str) -> re.Pattern[str]:
    """The variable of an input as a whole word; begins with its letters, for which `re` is fast."""
    word = variable(name)
    return re.compile(rf"{word}(?<!\w{word})(?!\w)")


def _without_use(text: str, name: str) -> str:
    """The text with the declaration of an input, and without its uses."""
    word = variable(name)
    head, declaration, rest = text.partition(word)
    return head + declaration + _uses(name).sub("x", rest)


def _unused(text: str, names: Iterable[str]) -> list[str]:
    """Inputs whose variable does not occur twice: in its declaration and in a use."""
    return [name for name in names if len(_uses(name).findall(text)) < 2]
