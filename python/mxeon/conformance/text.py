# SPDX-License-Identifier: Apache-2.0
"""Check code that no host runs: shader functions, sources of nodes, and generated shaders.

Each check counts faults, and no fault is allowed. The negative control of a check is code with an
additional fault. The documentation of renderers defines the meaning of closure arguments.
"""

import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from itertools import product
from typing import TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike

from mxeon import errors, hosts
from mxeon.conformance.check import judge, not_measured
from mxeon.conformance.release import released
from mxeon.conformance.results import NOT_RUN, SOURCE, Cause, Diagnosis, Kind, Quantity, Result
from mxeon.conformance.samples import generator
from mxeon.conformance.specs import PLAIN_LOBES, diffuse, lobes
from mxeon.conformance.tolerance import Measurement, count_of
from mxeon.models import diffuse as formulas
from mxeon.shaders import expressions, generation, library_tree, nodes, texts
from mxeon.shaders.closure_calls import COMMENT
from mxeon.shaders.functions import LANGUAGES, has_functions, parts, twins
from mxeon.shaders.library import load_library

# --- checks --------------------------------------------------------------------------------------

Faults: TypeAlias = tuple[list[Cause], int]  # faults, and number of faults in the negative control
Inputs = Mapping[str, expressions.Array]
# Each row has the claim of a check, the counted quantity, and the mistake in the negative control.
# fmt: off
CLAIMS = {
    "languages": ("The shader functions are identical in OSL and GLSL, apart from type names.",
                  Quantity.FUNCTIONS, "the first number of the OSL source is different"),
    "source": ("The generated source passes every input of the node to the function it calls.",
               Quantity.INPUTS, "each input in turn is 0"),
    "clash": ("No two nodes define the same name, so a shader can use both.",
              Quantity.FUNCTIONS, "the source of one node is included by another"),
    "arguments": ("Generated MDL passes every input to the same argument as MaterialX's release.",
                  Quantity.INPUTS, "two arguments are exchanged"),
    "closure": ("The generated source calls the node's closure, with the right arguments and value.",
                Quantity.FAULTS, "the weight of the lobe is dropped"),
}
# fmt: on


def check_texts(subjects: Iterable[diffuse.DiffuseSpec], library: str) -> tuple[Result, ...]:
    """Check the source code of a library, and the MDL code of the nodes `subjects`."""
    subjects = tuple(subjects)
    results = [
        _judged("closure", each.title, "mdl", library, partial(_closure_faults, each, library))
        for each in subjects
    ]
    if all(has_functions(library, language) for language in LANGUAGES):
        results.append(
            _judged("languages", "shader twins", "osl", library, partial(_twins, library))
        )
    if library != "stock":
        results.append(_judged("clash", "every two nodes", "", library, partial(_clashes, library)))
        if release := released(library):
            faults = partial(_arguments, library, release)
            results.append(_judged("arguments", "every node", "mdl", library, faults))
    for each, target in product((*subjects, *PLAIN_LOBES), generation.TARGETS):
        # The check "closure" already compares all arguments of MDL's rough diffuse nodes.
        if target in TEXT_ONLY and (target != "mdl" or isinstance(each, lobes.PbrSpec)):
            faults = partial(_dropped_inputs, each, target, library)
            results.append(_judged("source", each.title, target, library, faults))
    return tuple(results)


def _judged(
    check: str, subject: str, target: str, library: str, faults: Callable[[], Faults]
) -> Result:
    """The result of checking the source code of one or several targets."""
    claim, quantity, variant = CLAIMS[check]
    named = f"{subject}, {target}" if target else subject
    place = Result(check, claim, named, SOURCE, library, NOT_RUN)
    try:
        causes, control = faults()
    except errors.NotRun as error:
        return not_measured(place, error)
    except errors.ShaderError as error:
        return not_measured(place, errors.ShaderError(f"{target or subject}: {error}"))

    def measure(wrong: bool) -> Measurement:
        return Measurement(control if wrong else len(causes), {})

    return judge(place, count_of(quantity), measure, variant, lambda: Diagnosis(tuple(causes)))


# --- sources of all nodes -------------------------------------------------------------------------


def _twins(library: str) -> Faults:
    """Functions whose code differs between GLSL and OSL. The negative control changes a number."""
    glsl, osl = (COMMENT.sub(" ", twins(language, library)) for language in LANGUAGES)
    expected, *others = map(parts, (glsl, osl, re.sub(r"\b\d+\.\d+\b", "777.0", osl, count=1)))
    differing, control = (
        [name for name in expected | other if expected.get(name) != other.get(name)]
        for other in others
    )
    return [Cause(Kind.DEFECT, "different_in_osl", (name,)) for name in differing], len(control)


def _clashes(library: str) -> Faults:
    """Names that two nodes of a library define, except names that clash in MaterialX itself."""

    def clashes(name: str, target: str, twice: bool = False) -> dict[texts.Clash, str]:
        search = library_tree.search_path(name)
        return dict.fromkeys(texts.clashes(load_library(name), target, search, twice), target)

    targets: dict[texts.Clash, str] = {}  # first target with each clash of names
    for target in SOURCES:
        known = clashes("stock", target)
        new = {each: target for each in clashes(library, target) if each not in known}
        targets = new | targets
    rows = ((*each.nodes, each.name, target) for each, target in targets.items())
    causes = [Cause(Kind.DEFECT, "clash", row) for row in rows]
    return causes, len(clashes(library, SOURCES[0], twice=True))


def _arguments(library: str, release: mx.Document) -> Faults:
    """MDL arguments that differ from the release. The negative control exchanges two arguments."""

    def faults(exchange: bool) -> Iterator[Cause]:
        for definition in release.getNodeDefs():
            definitions = load_library(library).getNodeDef(definition.getName()), definition
            codes = (each.getImplementation("genmdl") for each in definitions)
            calls = (each.getAttribute("sourcecode") if each else "" for each in codes)
            (callee, arguments), (expected_callee, expected) = map(texts.arguments, calls)
            if callee != expected_callee or len(expected) < 2:
                continue
            if exchange:
                first, second, *_ = arguments
                arguments[first], arguments[second] = arguments[second], arguments[first]
                exchange = False
            for name, value in expected.items():
                if arguments.get(name) != value:
                    row = definition.getNodeString(), name, arguments.get(name, "missing"), value
                    yield Cause(Kind.DEFECT, "other_argument", row)

    return list(faults(False)), len(list(faults(True)))


# --- generated sources ----------------------------------------------------------------------------

SOURCES = ("genglsl", "genslang", "genmsl", "genosl")  # targets with source files
TEXT_ONLY = tuple(row.target for row in hosts.HOSTS if row.needs)  # targets without a host
# The variable `lobe_out` is either filled by a call or set to an expression.
FILLED = re.compile(r"\b(\w+\([^;]*), lobe_out\);")
ASSIGNED = re.compile(r"\b(?:BSDF|material) lobe_out = ([^;]*);")
CALLEE = re.compile(r"(?:\w+::)*\w+(?=\()")


def _lobe_expression(subject: lobes.ScatteringSpec, target: str, library: str) -> str:
    """The expression of a node in a generated shader. Input variables begin with `lobe_`."""
    frame = {"normal": (0.0, 0.6, 0.8), "tangent": (1.0, 0.0, 0.0)}
    document = subject.document({name: frame[name] for name in frame if name in subject.names})
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", generation.ApproximationWarning)
        text = generation.generate(document, target, library=library)[0].stages["pixel"]
    if filled := FILLED.search(text):  # `lobe_out` is first declared as an empty lobe
        return f"{filled[1]})"
    if assigned := ASSIGNED.search(text):
        return assigned[1]
    raise errors.NotRun("the expression of the lobe is not supported")


def _evaluated(expression: str, inputs: Inputs, functions: Mapping[str, object]) -> object:
    variables = {f"lobe_{name}": value for name, value in inputs.items()}
    return expressions.evaluate(expression, {"closureData": (), **variables, **functions})


def _dropped_inputs(subject: lobes.ScatteringSpec, target: str, library: str) -> Faults:
    """Inputs that a call ignores: no argument equals the unique value of the input."""
    expression = _lobe_expression(subject, target, library)
    names = tuple(subject.types) if isinstance(subject, lobes.PbrSpec) else subject.names
    inputs = {name: np.array([[0.371 + index]]) for index, name in enumerate(names)}

    def missing(variables: Inputs) -> list[str]:
        passed: list[float] = []

        def record(*values: ArrayLike, **named: ArrayLike) -> tuple[()]:
            for each in (*values, *named.values()):
                passed.extend(np.ravel(each))
            return ()

        _evaluated(expression, variables, dict.fromkeys(CALLEE.findall(expression), record))
        return [name for name, value in inputs.items() if value.item() not in passed]

    causes = [Cause(Kind.DEFECT, "never_passed", (name,)) for name in missing(inputs)]
    caught = all(name in missing({**inputs, name: np.zeros((1, 1))}) for name in names)
    return causes, len(names) if caught else 0


# --- closures: arguments of MDL's closures for random materials -----------------------------------

DRAWS = 256  # number of random materials
ROUNDED = 1e-12  # 4500 float64 roundings, which is more than any shader performs
TINT = "multiscatter_tint"
PBRLIB = "materialx::pbrlib_1_10::mx_oren_nayar_diffuse_bsdf"
UP = np.array([[0.0, 0.0, 1.0]])  # normal of the surface, which differs from the node's normal
# Weight and arguments of a closure. Keys are the names of the node's inputs.
Closure: TypeAlias = dict[str, ArrayLike]


# Functions of MDL, with the parameters that MDL's documentation states.
def diffuse_reflection_bsdf(
    tint: ArrayLike = 1.0, roughness: ArrayLike = 0.0, multiscatter_tint: ArrayLike = 0.0
) -> Closure:
    return {"weight": 1.0, "color": tint, "roughness": roughness, TINT: multiscatter_tint}


def weighted_layer(
    weight: ArrayLike, layer: Closure, base: Closure | tuple[()] = (), normal: ArrayLike = ()
) -> Closure:
    if base:
        raise errors.NotRun("a base below the layer is not supported")
    return {**layer, "normal": normal, "weight": np.multiply(layer["weight"], weight)}


# fmt: off
FUNCTIONS: Mapping[str, object] = {
    "state::normal": lambda: UP,
    "material": lambda *, surface: surface,
    "material_surface": lambda *, scattering: scattering,
    "df::weighted_layer": weighted_layer,
    "df::diffuse_reflection_bsdf": diffuse_reflection_bsdf,
    # MDL's closure evaluates FON. If the flag `energy_compensation` is set, a white lobe is added.
    PBRLIB: lambda mxp_weight, mxp_color, mxp_roughness, mxp_normal, mxp_energy_compensation: weighted_layer(
        mxp_weight, diffuse_reflection_bsdf(mxp_color, mxp_roughness, mxp_energy_compensation), (), mxp_normal),
}
# fmt: on


def _closure_faults(subject: diffuse.DiffuseSpec, library: str) -> Faults:
    """MDL closure arguments that differ from the inputs. The negative control drops the weight."""
    expression = _lobe_expression(subject, "mdl", library)
    rng = generator()
    drawn = subject.random_inputs(rng, DRAWS)
    rows = {name: each.reshape(DRAWS, -1) for name, each in drawn.items()}
    rows["weight"], normal = rng.random((DRAWS, 1)), rng.standard_normal((DRAWS, 3))
    rows["normal"] = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    # [Portsmouth2025], Eq. (19), is the tint that turns MDL's closure from FON into EON.
    rho, r = rows["color"], rows["roughness"]
    average = (1.0 + formulas.C2 * r) / (1.0 + formulas.C1 * r)
    tint = rho**2 * average / (1.0 - rho * (1.0 - average))
    expected = {**rows, TINT: tint if subject.model == "eon" else np.zeros((DRAWS, 3))}
    flag = {nodes.FLAG: np.array([[int(subject.flag is not False)]])}

    def faults(inputs: Inputs) -> Iterator[Cause]:
        closure = _evaluated(expression, {**inputs, **flag}, FUNCTIONS)
        if not isinstance(closure, dict):
            raise errors.ShaderError("the lobe is not a closure")
        for name, value in expected.items():
            if not np.size(closure.get(name, ())):
                yield Cause(Kind.DEFECT, "not_passed", (name,))
                continue
            measured = np.array(closure[name], np.float64, ndmin=2)
            if measured.shape[1] > value.shape[1]:
                yield Cause(Kind.DEFECT, "float_for_vector", (name,))
            elif not (error := float(np.abs(measured - value).max())) <= ROUNDED:
                key = f"tint_is_not_{subject.model}" if name == TINT else "is_not_the_node_s"
                values = [error]
                if np.ptp(measured, axis=0).max() <= ROUNDED:
                    values.append(float(measured.flat[0]))  # a constant replaces the input
                yield Cause(Kind.DEFECT, key, (name,), tuple(values))

    causes = list(faults(rows))
    if PBRLIB in expression and subject.flag:
        white = Cause(Kind.DEFECT, "white_lobe")
        causes = [white if TINT in each.names else each for each in causes]
    return causes, len(list(faults({**rows, "weight": np.ones((1, 1))})))
