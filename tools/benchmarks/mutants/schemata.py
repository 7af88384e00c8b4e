# SPDX-License-Identifier: Apache-2.0
"""Compiles many mutants into one program, in which a uniform selects the active mutant.

Each mutated expression equals the original expression unless the uniform `mutant` has the number of
the mutant. For example, ` + ` becomes ` + mutant_sign(mutant == 7) * `. So a node's shader is
compiled once for hundreds of mutants. Mutants of constant expressions and of integers cannot be
selected by a uniform, and so are reported as UNWRITTEN.
"""

import re
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from itertools import islice
from typing import cast

import moderngl
import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.backends import Evaluating
from mxeon.conformance.cache import EVALUATIONS, Recent
from mxeon.conformance.case import Case, make_case
from mxeon.conformance.check import Check
from mxeon.conformance.checks import CHECKS
from mxeon.conformance.samples import Array
from mxeon.conformance.shader_functions import FunctionProbe, exact, row_of
from mxeon.conformance.specs import DIFFUSE, PBRLIB, PLAIN_LOBES
from mxeon.conformance.specs.combinations import CombinedSpec
from mxeon.conformance.specs.microfacets import FILM_SPECS
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.tolerance import Tolerance
from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import gl
from mxeon.shaders import functions
from tools.benchmarks.mutants import operators
from tools.benchmarks.mutants.mutant import ROOT, Mutant
from tools.benchmarks.mutants.trial import SURVIVED

KINDS = ("float", "vec2", "vec3", "vec4")
ONE = "{0} mutant_{1}(bool m, {0} x) {{ return m ? {2} : {3}; }}\n"
TWO = "{0} mutant_{1}(bool m, {0} a, {4} b) {{ return m ? {2}(a, b) : {3}(a, b); }}\n"
CALLS = ("sqrt", "abs", "exp", "log", "sin", "cos", "tan", "acos", "asin", "atan")
HELPERS = "uniform int mutant;\nfloat mutant_sign(bool m) { return m ? -1.0 : 1.0; }\n" + "".join(
    ONE.format(kind, "one", f"{kind}(1.0)", "x")
    + ONE.format(kind, "zero", f"{kind}(0.0)", "x")
    + ONE.format(kind, "over", "1.0 / x", "x")
    + "".join(ONE.format(kind, call, "x", f"{call}(x)") for call in CALLS)
    + "".join(
        TWO.format(kind, *pair, other)
        for pair in (("min", "max", "min"), ("max", "min", "max"))
        for other in dict.fromkeys((kind, "float"))
    )
    for kind in KINDS
)
NUMBER = re.compile(r"\(mutant == (\d+)\)")
CHANNELS = {name: place for names in ("xyzw", "rgba") for place, name in enumerate(names)}
ERROR = re.compile(r"\b\d+:(\d+)\(\d+\): error")


@dataclass(frozen=True)
class Edit:
    """Code to insert around a part of a shader. If `token` is set, `before` replaces the part."""

    start: int
    end: int
    before: str
    after: str = ""
    token: bool = False


def edits(number: int, mutant: Mutant, code: str) -> list[Edit]:
    """Edits that add a mutant to a shader, or no edits if a uniform cannot select the mutant."""
    operator, (start, end), on = mutant.operator, mutant.place, f"(mutant == {number})"
    found, put = code[start:end], operators.changed(mutant.operator, code[start:end])

    def wrapped(start: int, end: int, name: str) -> Edit:
        return Edit(start, end, f"mutant_{name}({on}, ", ")")

    if operator in ("constant", "unit"):
        return [Edit(start, end, f"({on} ? {float(put)!r} : ", ")")]
    if operator == "sign" and "=" in found:
        return [Edit(end, code.index(";", end), f"mutant_sign({on}) * (", ")")]
    if operator == "sign":
        return [Edit(end, end, f"mutant_sign({on}) * ")]
    if operator == "negative" and code[:start].rstrip()[-1:] != "/":
        return [Edit(start, end, f"mutant_sign(!{on}) * ", token=True)]
    if operator == "product" and (last := _operand(code, end)):
        return [wrapped(end, last, "over")]
    if operator == "comparison":
        # A selected mutant inverts the result of the comparison.
        return [Edit(start, _end(code, end), "", f" != {on}")]
    if operator == "channel":
        old, new = (CHANNELS[each[1]] for each in (found, put))
        return [Edit(start, end, f"[{on} ? {new} : {old}]", token=True)]
    if operator == "bound":
        return [Edit(start, end, f"mutant_{found}{on}, ", token=True)]
    if found in CALLS:
        return [Edit(start, end + 1, f"mutant_{found}({on}, ", token=True)]
    if found == "!":
        return [Edit(start, end, f"{on} == ", token=True)]
    if operator == "factor":
        last = found.startswith((" * ", " / "))
        return [wrapped(start + 3, end, "one") if last else wrapped(start, end - 3, "one")]
    if operator == "term" and found.startswith((" + ", " - ")):
        return [wrapped(start + 3, end, "zero")]
    if operator == "term":
        sign = [Edit(end, end, f"mutant_sign({on}) * ")] if found.endswith(" - ") else []
        return [wrapped(start, end - 3, "zero"), *sign]
    if operator in ("yes", "no"):
        return [Edit(start, end, f"({on} || " if operator == "yes" else f"(!{on} && ", ")")]
    if operator == "statement":
        first = start + len(found) - len(found.lstrip())
        return [Edit(first, first, f"if (!{on}) ")]
    return []


def _operand(code: str, place: int) -> int:
    """End of the operand that starts at `place`, or 0 if no operand starts there."""
    start, depth = place, 0
    for each in re.compile(r"-?[\w.]+|[(\[]|[)\]]|[^\w.()\[\]]+").finditer(code, place):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(each[0], 0)
        if depth < 0 or (not depth and not re.fullmatch(r"-?[\w.]+|[)\]]", each[0])):
            break
        place = each.end()
    return place if place > start else 0


def _end(code: str, place: int) -> int:
    """End of the comparison whose right side starts at `place`."""
    depth = 0
    for each in re.compile(r"[()\[\]]|[;,?:]|&&|\|\|").finditer(code, place):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(each[0], 0)
        if depth < 0 or (not depth and each[0] not in "()[]"):
            return len(code[: each.start()].rstrip())
    return place


def instrumented(text: str, mutants: Mapping[int, Mutant]) -> str:
    code = operators.code_of(text)
    made = [each for number, mutant in mutants.items() for each in edits(number, mutant, code)]
    opens: dict[int, list[str]] = {}
    closes: dict[int, list[str]] = {}
    tokens: dict[int, Edit] = {}
    for each in sorted(made, key=lambda each: (each.start, -each.end)):  # outer edits first
        if each.token:
            tokens.setdefault(each.start, each)
        else:
            opens.setdefault(each.start, []).append(each.before)
            closes.setdefault(each.end, []).insert(0, each.after)
    parts, place = [], 0
    for at in sorted({*opens, *closes, *tokens, len(text)}):
        if at >= place:  # no edits inside a replaced token
            parts += [text[place:at], *closes.get(at, ()), *opens.get(at, ())]
            place = at
        if at in tokens:
            parts.append(tokens[at].before)
            place = tokens[at].end
    return "".join(parts)


class SchemataHost(gl.GlHost):
    """The gl host with all undetected mutants in shaders. `mutant` is the active mutant, or 0."""

    def __init__(self) -> None:
        super().__init__()
        self.alive: dict[int, Mutant] = {}
        self.mutant = 0
        self.unwritten: set[int] = set()  # mutants that cannot be compiled
        self._made = lru_cache(maxsize=gl.PROGRAMS)(self._schema)
        self._program = self._chosen  # type: ignore[assignment]

    def take(self, mutants: dict[int, Mutant]) -> None:
        """Insert `mutants` into all shaders that are compiled from now on."""
        self.alive = mutants
        self._made.cache_clear()

    def close(self) -> None:
        self._program = self._made
        super().close()

    def _chosen(self, vertex: str, pixel: str) -> moderngl.Program:
        program = self._made(vertex, pixel)
        gl._set(program, {"mutant": self.mutant})
        return program

    def _schema(self, vertex: str, pixel: str) -> moderngl.Program:
        while True:
            text = self._written(pixel)
            try:
                return gl._program(self._context, vertex, text)
            except ShaderError as error:
                if not (wrong := _numbers_at(text, str(error))):
                    raise
                self.unwritten |= wrong

    def _written(self, pixel: str) -> str:
        files: dict[str, dict[int, Mutant]] = {}
        for number, mutant in self.alive.items():
            if number not in self.unwritten:
                files.setdefault(mutant.file, {})[number] = mutant
        for file, mutants in files.items():
            if (chunk := chunk_of(file)) in pixel:
                start = (ROOT / file).read_text(encoding="utf-8").index(chunk)
                moved = {
                    number: replace(each, place=(each.place[0] - start, each.place[1] - start))
                    for number, each in mutants.items()
                    if each.place[0] >= start
                }
                made = instrumented(chunk, moved)
                self.unwritten |= mutants.keys() - set(map(int, NUMBER.findall(made)))
                pixel = pixel.replace(chunk, f"/*mutants*/{made}")
        return pixel.replace("/*mutants*/", HELPERS, 1)

    def numbers_in(self, pixel: str) -> list[int]:
        """Numbers of the undetected mutants that are in a shader."""
        files = {each.file for each in self.alive.values()}
        known = {file for file in files if chunk_of(file) in pixel}
        return [number for number, each in self.alive.items() if each.file in known]


def _numbers_at(text: str, error: str) -> set[int]:
    """Numbers of mutants on the line of a compiler error, or on the nearest line above."""
    lines, found = text.splitlines(), set[int]()
    for place in map(int, ERROR.findall(error)):
        numbers = (NUMBER.findall(line) for line in reversed(lines[max(0, place - 12) : place]))
        found.update(map(int, next(filter(None, numbers), ())))
    return found


@cache
def chunk_of(file: str) -> str:
    """The code of a file after the last #include. Generated shaders contain this code unchanged."""
    text = (ROOT / file).read_text(encoding="utf-8")
    return re.split(r"^#include .*\n", text, flags=re.M)[-1].strip()


# Checks in FIRST detect most mutants. Checks in LAST take longest.
FIRST = (
    *("value", "environment", "layering", "denser", "output", "radiance", "sphere_mean"),
    *("film_visible", "combination", "combined_throughput"),
)
LAST = (
    *("frame", "finite", "layer", "integral", "energy", "states", "lossless", "domain", "sky"),
    *("narrow_lobes", "tilted_lobes", "wide_lobes", "straight_views", "low_index", "each_lobe"),
)
COMPOSED = (CombinedSpec, SurfaceShaderSpec)  # specs whose lobes are also checked separately
UNWRITTEN = "unwritten"
OSL_TWINS = {
    functions.source_file("osl", stem).relative_to(ROOT).as_posix()
    for stem in (*functions.STEMS, "ggx_albedo", "conty_kulla_albedo")
}
# No check of a node runs code for path tracers, or functions that only OSL calls.
NOT_CHECKED = ("genglsl/path/", "genglsl/lib/hair_parameters.glsl")
STRIDE = 8
GROUP = 1024  # mutants per program; larger programs slow the driver down
Checks = Callable[[], Iterator[tuple[str, bool]]]  # yields checks and whether each check failed
Subject = tuple[str, bool, str, Checks]


def trials(mutants: Sequence[Mutant]) -> dict[str, str]:
    """Results by mutant: SURVIVED, UNWRITTEN, or the check and subject that detect the mutant."""
    twins = [each for each in mutants if each.file in OSL_TWINS]
    glsl = [each for each in mutants if each.file.startswith("genglsl/")]
    numbered = dict(enumerate((m for m in glsl if not m.file.startswith(NOT_CHECKED)), 1))
    found = {each.name: SURVIVED for each in numbered.values()}
    with closing(SchemataHost()) as host, np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        checked = list(subjects(host))
        for start in range(0, len(numbered), GROUP):
            host.take(dict(islice(numbered.items(), start, start + GROUP)))
            for number, words in detections(host, checked):
                found[numbered[number].name] = words
        found |= {numbered[number].name: UNWRITTEN for number in host.unwritten}
    return found | {
        each.name: "languages" if differs_from_glsl(each) else SURVIVED for each in twins
    }


def differs_from_glsl(mutant: Mutant) -> bool:
    """Whether a mutated OSL function or constant differs from GLSL."""
    texts = (ROOT / mutant.file.replace("osl", "glsl")).read_text(), mutant.texts()[mutant.file]
    glsl, osl = (functions.parts(operators.COMMENT.sub(" ", each)) for each in texts)
    return glsl != osl


def detections(host: SchemataHost, checked: Sequence[Subject]) -> Iterator[tuple[int, str]]:
    """Yield the number of each detected mutant, and the check that detects the mutant.

    Detected mutants are removed from the host. Subjects with composed lobes are checked only with
    mutants that no other subject contains.
    """
    seen: set[int] = set()
    for title, composed, text, checks in checked:
        numbers = [each for each in host.numbers_in(text) if not composed or each not in seen]
        for number in numbers:
            host.mutant = number
            for check, failed in checks() if number not in host.unwritten else ():
                if failed and number not in host.unwritten:
                    del host.alive[number]
                    yield number, f"{check}, {title}"
                    break
        if not composed:
            seen.update(numbers)
        host.mutant = 0


def subjects(host: SchemataHost) -> Iterator[Subject]:
    """Yield each subject's title, whether the spec is in COMPOSED, the shader, and the checks."""
    every = Functions(host)
    yield "functions", False, every.text, every
    specs = dict.fromkeys((*DIFFUSE, *PLAIN_LOBES, *FILM_SPECS, *PBRLIB))
    made = [make_case(Evaluating, host, s, "eonlib") for s in specs if s.title != "measured_edf"]
    cases = [replace(case, control=True) for case in made]  # controls use a subset of the samples
    for turn in range(3):
        for case in cases:
            composed, text = isinstance(case.spec, COMPOSED), case.evaluating.shader.stages["pixel"]
            yield case.spec.title, composed, text, node_checks(case, turn)


def node_checks(case: Case, turn: int) -> Checks:
    """A function that runs one of three groups of a node's checks. `turn` selects the group."""

    @cache
    def rows() -> list[tuple[Check, Tolerance]]:
        chosen = [each for each in CHECKS if not each.profile]
        chosen = [each for each in chosen if (each.key not in FIRST) + (each.key in LAST) == turn]
        chosen = [each for each in chosen if each.applies_to(case.spec, Evaluating, "gl")]
        return [(each, each.allowed(case)) for each in chosen]

    def run() -> Iterator[tuple[str, bool]]:
        case.backend._evaluations = Recent(EVALUATIONS)
        for check, tolerance in rows():
            try:
                yield check.key, not check.measured(case, tolerance).error <= tolerance.value
            except (NotRun, ShaderError):
                yield check.key, True

    return run


class Functions:
    """Checks of all shader functions. One call evaluates all functions at every STRIDE-th point."""

    def __init__(self, host: SchemataHost) -> None:
        self._host, self.language = host, host.language
        probe = FunctionProbe(cast(gl.GlHost, self), "eonlib")
        self.text, self._rows = probe.text, []
        for name in probe._values(1.0):
            row, (values, factor) = row_of(name), exact(name)
            scale = np.broadcast_to(factor, values.shape)[::STRIDE]
            self._rows.append((row.key, probe.tolerance(row), scale, scale * values[::STRIDE]))

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Execute a call. A call of all functions is also stored, with every STRIDE-th point."""
        if function == functions.EACH:
            self._call = source, function, *(np.asarray(each)[::STRIDE] for each in arguments)
        return self._host.execute(source, function, *arguments)

    def __call__(self) -> Iterator[tuple[str, bool]]:
        values = self._host.execute(*self._call).astype(np.float64)
        parts = np.split(values, len(self._rows))
        for part, (key, tolerance, scale, reference) in zip(parts, self._rows, strict=True):
            error = tolerance.metric(scale * part[:, : scale.shape[1]], reference).max()
            yield key, not error <= tolerance.value
