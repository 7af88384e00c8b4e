# SPDX-License-Identifier: Apache-2.0
"""Check of entry points in OSL beside the rough diffuse ones, by the closures that they give.

Their text is evaluated in float64 for random inputs, since no host here runs OSL for emission, and
none compares subsurface scattering in Cycles with a model. It is read, not run.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import MaterialX as mx
import numpy as np

from mxeon.conformance.results import Result
from mxeon.conformance.samples.batch import SEED
from mxeon.conformance.text.closures import ROUNDED
from mxeon.conformance.text.counts import Claim, counted
from mxeon.conformance.text.interpreter import Array, Closure, Interpreter
from mxeon.errors import NotRun, ShaderError
from mxeon.models.media.emission import conical_edf
from mxeon.shaders.functions import expanded
from mxeon.shaders.library import has_profile, kind_of, load_library, source_folder

COUNT = 256  # of random inputs
CLAIM = Claim(
    "entry",
    "The OSL entry point returns the node's closure, with its weight and arguments.",
    "faults",
    "the first color is halved",
)
Inputs = Mapping[str, Array]


@dataclass(frozen=True)
class EntryPoint:
    """An entry point, and the closure that it has to give."""

    node: str  # category of the node, name of the file beside a library, and words on the inputs
    file: str
    case: str
    profile: str | None
    closure: str  # name of the renderer's function
    # Random inputs in the order of the parameters, and globals of OSL.
    inputs: Callable[[np.random.Generator], dict[str, Array]]
    weight: Callable[[Inputs], Array]  # weight of the closure, with what it takes for its color
    arguments: tuple[str, ...] = ()  # inputs that the closure takes as they are


def _directions(rng: np.random.Generator) -> Array:
    w = rng.standard_normal((COUNT, 3))
    return np.asarray(w / np.linalg.norm(w, axis=1, keepdims=True))


def _cone(soft: bool, cycles: bool) -> Callable[[np.random.Generator], dict[str, Array]]:
    """Inputs of a cone about z. In Cycles I points to the viewer, to whom the normal is turned."""

    def inputs(rng: np.random.Generator) -> dict[str, Array]:
        inner, share = 180.0 * rng.random((COUNT, 1)), rng.random((COUNT, 1))
        wo = _directions(rng)
        side = np.where(wo[:, 2:] < 0.0, -1.0, 1.0) if cycles else np.ones((COUNT, 1))
        return {
            "color": rng.random((COUNT, 3)),
            "axis": side * np.array([0.0, 0.0, 1.0]),
            "inner_angle": inner,
            "outer_angle": inner + 60.0 * share + 1.0 if soft else inner * share,
            "I": wo if cycles else -wo,
            "wo": wo,
        }

    return inputs


def _radiance(inputs: Inputs) -> Array:
    angles = (inputs[f"{end}_angle"][:, 0] for end in ("inner", "outer"))
    return conical_edf(inputs["wo"], inputs["color"], *angles)


def _subsurface(rng: np.random.Generator) -> dict[str, Array]:
    return {
        "weight": rng.random((COUNT, 1)),
        "color": rng.random((COUNT, 3)),
        "radius": rng.random((COUNT, 3)),
        "anisotropy": 2.0 * rng.random((COUNT, 1)) - 1.0,
        "normal": _directions(rng),
    }


ENTRIES = tuple(
    EntryPoint(
        "conical_edf",
        file,
        case,
        profile,
        "uniform_edf",
        _cone(soft, profile == "cycles"),
        _radiance,
    )
    for file, profile in (("conical_edf", None), ("conical_edf_cycles", "cycles"))
    for soft, case in ((True, "soft"), (False, "hard"))
) + (
    EntryPoint(
        "subsurface_bsdf",
        "subsurface_bsdf_cycles",
        "",
        "cycles",
        "subsurface_bssrdf",
        _subsurface,
        lambda inputs: np.asarray(inputs["weight"] * inputs["color"]),
        ("normal", "color", "radius", "anisotropy"),
    ),
)


def check_entries(library: str) -> tuple[Result, ...]:
    folder = source_folder(library) / "genosl"
    return tuple(
        _judge(entry, library)
        for entry in ENTRIES
        if kind_of(library) not in ("stock", "diffuse")
        and any(folder.rglob(f"{entry.file}.osl"))
        and (entry.profile is None or has_profile(library, entry.profile))
    )


def _judge(entry: EntryPoint, library: str) -> Result:
    inputs = entry.inputs(np.random.default_rng(SEED))
    wrong = {**inputs, "color": 0.5 * inputs["color"]}
    faults, control = (
        _faults(entry, library, inputs, inputs),
        _faults(entry, library, inputs, wrong),
    )
    title = ", ".join(filter(None, (entry.node, entry.case, "osl", entry.profile)))
    return counted(CLAIM, title, library, len(faults), len(control), "; ".join(faults))


def _faults(entry: EntryPoint, library: str, inputs: Inputs, expected: Inputs) -> list[str]:
    try:
        closures = _closures(entry, _element(entry, library), inputs)
    except (NotRun, ShaderError) as error:
        return [str(error)]
    if [each.name for each in closures] != [entry.closure]:
        return [f"the closure is not {entry.closure}"]
    wanted = {"weight": entry.weight(expected)}
    wanted |= {str(place): expected[name] for place, name in enumerate(entry.arguments)}
    measured = {**closures[0].arguments, "weight": closures[0].weight}
    names = {str(place): name for place, name in enumerate(entry.arguments)}
    return [
        f"{names.get(name, name)} is off"
        for name, value in wanted.items()
        if not np.abs(measured.get(name, np.inf) - value).max() <= ROUNDED
    ]


def _element(entry: EntryPoint, library: str) -> mx.Implementation:
    """The implementation that MaterialX chooses in OSL."""
    data = load_library(library, entry.profile)
    element = data.getNodeDef(f"ND_{entry.node}").getImplementation("genosl")
    if not element or not element.getAttribute("file"):
        raise ShaderError(f"no source implements {entry.node}")
    return element


def _closures(entry: EntryPoint, element: mx.Implementation, inputs: Inputs) -> tuple[Closure, ...]:
    path = Path(element.getActiveSourceUri()).parent / element.getAttribute("file")
    view = inputs.get("wo", np.ones((1, 3)))
    interpreter = Interpreter(
        expanded(path),
        {
            "uniform_edf": lambda given: (Closure("uniform_edf", given["0"], {}),),
            "subsurface_bssrdf": lambda given: (
                Closure("subsurface_bssrdf", np.ones((1, 1)), given),
            ),
        },
        {"I": inputs.get("I", view), "backfacing": (view[:, 2:] < 0.0).astype(float)},
    )
    arguments = [value for name, value in inputs.items() if name not in ("I", "wo")]
    closures: tuple[Closure, ...] = interpreter.call(element.getAttribute("function"), arguments)
    return closures
