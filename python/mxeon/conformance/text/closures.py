# SPDX-License-Identifier: Apache-2.0
"""Check of the closures that generated OSL and MDL call: their arguments, and their value.

The text is evaluated in float64 for random materials. What a closure does with its arguments is taken
from its documentation: this is read, not run.
"""

import re
from collections.abc import Iterable, Iterator

import numpy as np

from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.conformance.results import Result
from mxeon.conformance.samples.batch import SEED, directions
from mxeon.conformance.text.counts import Claim, judged
from mxeon.conformance.text.interpreter import Array, Closure, Interpreter
from mxeon.conformance.text.renderers import PBRLIB, Renderer
from mxeon.conformance.text.sources import ASSIGNED, FILLED, source, variable
from mxeon.errors import NotRun, ShaderError
from mxeon.models.diffuse import formulas
from mxeon.shaders.library import has_profile
from mxeon.shaders.nodes import FLAG

MATERIALS = 256
ROUNDED = 1e-12  # 4500 roundings of float64: no text has as many
CYCLES = 1e-7  # its profile leaves out the square of an albedo of 1e-4, twice, of numbers up to 3
CLAIM = Claim(
    "closure",
    "The generated source calls the node's closure, with the right arguments and value.",
    "faults",
    "the weight of the lobe is dropped",
)
TINTS = {
    "eon": "that of EON, rho^2 <E> / (1 - rho (1 - <E>))",
    "qon": "black, as without energy_compensation",
}
WHITE_LOBE = "FON + white lobe, as MDL's module pbrlib_1_10 defines this node; read, not run"
FLOAT_FLAG = re.compile(rf'"{FLAG}", *[\d.]*\.')  # OSL looks a keyword up by its type as well

Inputs = dict[str, Array]


def check_closures(subjects: Iterable[DiffuseSubject], library: str) -> tuple[Result, ...]:
    renderers: list[tuple[str, str | None]] = [("osl", None), ("mdl", None)]
    if has_profile(library, "cycles"):
        renderers.append(("osl", "cycles"))
    return tuple(
        _judge(subject, target, profile, library)
        for subject in subjects
        for target, profile in renderers
    )


def _judge(subject: DiffuseSubject, target: str, profile: str | None, library: str) -> Result:
    def faults() -> tuple[list[str], int]:
        text = source(subject, target, library, profile)
        found, control = (
            _faults(subject, Renderer(target, target, profile), each)
            for each in (text, _without_weight(text))
        )
        return found, len(control)

    title = ", ".join(filter(None, (subject.title, target, profile)))
    return judged(CLAIM, title, library, faults)


def _without_weight(text: str) -> str:
    word = re.compile(rf"\b{variable('weight')}\b")
    for pattern in (FILLED, ASSIGNED):
        text = pattern.sub(lambda match: word.sub("1.0", match[0]), text)
    return text


def _faults(subject: DiffuseSubject, renderer: Renderer, text: str) -> list[str]:
    inputs = _materials(subject)
    closures = _closures(renderer, text, inputs)
    faults = [*dict.fromkeys(renderer.faults)]
    if FLOAT_FLAG.search(text):
        faults.append(f"keyword {FLAG} is an int but receives a float")
    single = renderer.profile is None and len(closures) == 1
    if single:
        faults += _argument_faults(subject, renderer, closures[0], inputs)
        if PBRLIB in text and subject.flag:
            return [WHITE_LOBE if "multiscatter_tint" in each else each for each in faults]
    faults += _normal_faults(closures, inputs)
    if not faults:
        faults += _value_faults(subject, renderer, closures, inputs)
    return faults


def _materials(subject: DiffuseSubject) -> Inputs:
    """Random inputs of a node; the first are corners of their ranges."""
    rng = np.random.default_rng(SEED)
    color, roughness = rng.random((MATERIALS, 3)), rng.random((MATERIALS, 1))
    color[:4], roughness[:4, 0] = [[0.0] * 3, [1.0] * 3, [0.0] * 3, [1.0] * 3], [0, 0, 1, 1]
    if subject.model == "qon":
        roughness *= 0.5 * np.pi  # sigma
    normal = rng.standard_normal((MATERIALS, 3))
    return {
        "weight": rng.random((MATERIALS, 1)),
        "color": color,
        "roughness": roughness,
        "normal": normal / np.linalg.norm(normal, axis=1, keepdims=True),
        FLAG: np.full((MATERIALS, 1), float(bool(subject.flag or subject.flag is None))),
    }


def _closures(renderer: Renderer, text: str, inputs: Inputs) -> tuple[Closure, ...]:
    variables = {variable(name): value for name, value in inputs.items()}
    variables["N"] = np.array([[0.0, 0.0, 1.0]])  # a global of OSL, the normal of the surface
    interpreter = Interpreter(text, renderer.closures())
    if call := FILLED.search(text):
        closures = interpreter.value(f"{call[1]}({call[2]})", variables)
    elif definition := ASSIGNED.search(text):
        closures = interpreter.value(definition[1], variables)
    else:
        raise NotRun("the expression of the lobe is not supported")
    if not isinstance(closures, tuple):
        raise ShaderError("the lobe is no closure")
    return closures


def _argument_faults(
    subject: DiffuseSubject, renderer: Renderer, closure: Closure, inputs: Inputs
) -> Iterator[str]:
    """Arguments of the one closure that are not the node's inputs."""
    expected = {name: inputs[name] for name in ("color", "roughness")}
    if renderer.target == "mdl":
        expected["multiscatter_tint"] = _tint(subject, inputs)
    else:
        expected[FLAG] = inputs[FLAG]
    expected["weight"] = inputs["weight"]
    arguments = {**closure.arguments, "weight": closure.weight}
    for name, value in expected.items():
        wanted = TINTS[subject.model] if name == "multiscatter_tint" else f"the node's {name}"
        error = float(np.abs(arguments[name] - value).max())
        if not error <= ROUNDED:
            instead = _instead(name, arguments[name], value, inputs)
            yield f"{name} is not {wanted}{instead}: off by up to {error:.2g}"


def _instead(name: str, measured: Array, expected: Array, inputs: Inputs) -> str:
    """The value that an argument has instead of the one that it has to have, where it is known."""
    if np.ptp(measured, axis=0).max() <= ROUNDED:
        return f", but {float(measured.flat[0]):.3g}"
    for other, value in inputs.items():
        if other != name and _equal(measured, value):
            return f", but {other}"
    for words, factor in (("missing", measured * inputs["color"]), ("too many", measured)):
        right = expected if words == "missing" else expected * inputs["color"]
        if _equal(factor, right):
            return f": one factor of the color is {words}"
    return ""


def _tint(subject: DiffuseSubject, inputs: Inputs) -> Array:
    """rho^2 <E> / (1 - rho (1 - <E>)): [Portsmouth2025], Eq. (19); MDL without the flag is FON."""
    if subject.model != "eon":
        return np.zeros((MATERIALS, 3))
    rho, r = inputs["color"], inputs["roughness"]
    average = (1.0 + formulas.C2 * r) / (1.0 + formulas.C1 * r)
    return rho**2 * average / (1.0 - rho * (1.0 - average))


def _equal(left: Array, right: Array) -> bool:
    return left.shape == right.shape and bool(np.abs(left - right).max() <= ROUNDED)


def _normal_faults(closures: tuple[Closure, ...], inputs: Inputs) -> Iterator[str]:
    normals = [closure.arguments.get("normal") for closure in closures]
    if any(normal is None for normal in normals):
        yield "the normal is not passed"
    elif any(not _equal(np.asarray(normal), inputs["normal"]) for normal in normals):
        yield "the normal is not the node's"


def _value_faults(
    subject: DiffuseSubject, renderer: Renderer, closures: tuple[Closure, ...], inputs: Inputs
) -> Iterator[str]:
    """A value that is not the model's: Cycles has QON for s >= 0 alone, and MDL has FON for it."""
    rng = np.random.default_rng(SEED)
    wo, wi = directions(rng, MATERIALS), directions(rng, MATERIALS)
    if renderer.profile == "cycles" and subject.model == "qon":
        wi = wi * np.where((wo[:, :2] * wi[:, :2]).sum(axis=1, keepdims=True) < 0.0, [-1, -1, 1], 1)
    model = "fon" if renderer.target == "mdl" and subject.model == "qon" else subject.model
    brdf = getattr(formulas, f"{model}_brdf")
    expected = brdf(wo, wi, inputs["color"].T, inputs["roughness"][:, 0]).T * inputs["weight"]
    measured = sum((renderer.value(each, wo, wi) for each in closures), np.zeros((MATERIALS, 3)))
    error = float(np.pi * np.abs((measured - expected) * wi[:, 2:]).max())
    if not error <= (CYCLES if renderer.profile == "cycles" else ROUNDED):
        yield f"the sum of closures is not {model.upper()}: off by up to {error:.2g} of pi f cos"
