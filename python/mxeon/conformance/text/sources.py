# SPDX-License-Identifier: Apache-2.0
"""Generated sources, and a check of the call of a node in those that nothing here can run.

The arguments of the call are evaluated. Hosts measure the sources of other targets.
"""

import re
import warnings
from collections.abc import Iterable, Mapping
from functools import lru_cache

import numpy as np

from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.conformance.results import Result
from mxeon.conformance.text.counts import Claim, counted, judged
from mxeon.conformance.text.interpreter import Array, Closure, Interpreter
from mxeon.conformance.text.syntax import macros, without_comments
from mxeon.errors import NotRun
from mxeon.hosts import HOSTS
from mxeon.shaders.functions import LANGUAGES, SIGNATURE, has_functions, twins
from mxeon.shaders.generation import TARGETS, ApproximationWarning, generate

TEXT_ONLY = tuple(row.target for row in HOSTS if not row.module)  # targets that no host runs
# The call of a node that fills its lobe, or the expression that its lobe is.
FILLED = re.compile(r"\b(\w+)\(([^;]*), lobe_out\);")
ASSIGNED = re.compile(r"\b(?:BSDF|material) lobe_out = ([^;]*);")
CALLEE = re.compile(r"(?:\w+::)*\w+(?=\()")
PASSED_ON = Claim(
    "source",
    "The generated source passes every input of the node to the function it calls.",
    "inputs",
    "each input in turn is 0",
)


def check_calls(
    subjects: Iterable[DiffuseSubject | BsdfSubject], library: str
) -> tuple[Result, ...]:
    """Results for every subject and target that no host runs."""
    return tuple(
        _passes_inputs(subject, target, library)
        for subject in subjects
        for target in TARGETS
        # The closures of MDL's rough diffuse nodes are compared by their values.
        if target in TEXT_ONLY and (target != "mdl" or isinstance(subject, BsdfSubject))
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


def _passes_inputs(subject: DiffuseSubject | BsdfSubject, target: str, library: str) -> Result:
    """Check that every input of the node is an argument of its call."""
    names = tuple(subject.types) if isinstance(subject, BsdfSubject) else subject.inputs
    # Numbers that no text holds by itself.
    inputs = {name: np.array([[0.371 + index]]) for index, name in enumerate(names)}

    def faults() -> tuple[list[str], int]:
        text = source(subject, target, library)
        without = [_dropped(text, inputs, {**inputs, name: np.zeros((1, 1))}) for name in names]
        noticed = sum(name in each for name, each in zip(names, without, strict=True))
        dropped = [f"{name} is never passed" for name in _dropped(text, inputs, inputs)]
        return dropped, noticed if noticed == len(names) else 0

    return judged(PASSED_ON, f"{subject.title}, {target}", library, faults)


def _dropped(text: str, inputs: Mapping[str, Array], given: Mapping[str, Array]) -> list[str]:
    """Inputs whose value is no argument of the call for the values given."""
    if call := FILLED.search(text):
        expression = f"{call[1]}({call[2]})"
    elif assigned := ASSIGNED.search(text):
        expression = assigned[1]
    else:
        raise NotRun("the expression of the lobe is not supported")
    seen: list[float] = []

    def called(arguments: Mapping[str, object]) -> tuple[Closure, ...]:
        seen.extend(
            float(each.flat[0]) for each in arguments.values() if isinstance(each, np.ndarray)
        )
        return ()

    variables = {variable(name): value for name, value in given.items()}
    interpreter = Interpreter("", dict.fromkeys(CALLEE.findall(expression), called))
    interpreter.value(expression, {"closureData": (), **variables})
    return [name for name, value in inputs.items() if float(value[0, 0]) not in seen]


WORDS = {"color": "vec3", "vector": "vec3", "output": "out", "atan2": "atan"}  # OSL, GLSL
NUMBER = re.compile(r"\b\d+\.\d+\b")
CLAIM = Claim(
    "languages",
    "The shader functions are identical in OSL and GLSL, apart from type names.",
    "functions",
    "the first number of the OSL text is different",
)


def check_languages(library: str) -> tuple[Result, ...]:
    """The result for a library that brings shader functions in both languages."""
    if not all(has_functions(library, language) for language in LANGUAGES):
        return ()
    glsl, osl = (twins(language, library) for language in LANGUAGES)
    different = differences(glsl, osl)
    control = differences(glsl, NUMBER.sub("777.0", without_comments(osl), count=1))
    meaning = f"different in OSL: {', '.join(different)}"
    return (counted(CLAIM, "shader twins, osl", library, len(different), len(control), meaning),)


def differences(glsl: str, osl: str) -> list[str]:
    """Names of the functions and constants whose text differs."""
    ours, theirs = _parts(glsl), _parts(osl)
    return [name for name in {**ours, **theirs} if ours.get(name) != theirs.get(name)]


def _parts(text: str) -> dict[str, list[str]]:
    """Tokens of each function and constant of a text, in GLSL's words."""
    text = without_comments(text)
    constants = {name: _tokens(value) for name, value in macros(text).items()}
    matches = list(SIGNATURE.finditer(text))
    ends = [match.start() for match in matches[1:]] + [len(text)]
    functions = {
        match[1]: _tokens(text[match.start() : end])
        for match, end in zip(matches, ends, strict=True)
    }
    return constants | functions


def _tokens(text: str) -> list[str]:
    text = "".join(line for line in text.splitlines(keepends=True) if line[:1] != "#")
    return [WORDS.get(word, word) for word in re.findall(r"[\w.]+|\S", text)]
