# SPDX-License-Identifier: Apache-2.0
"""The results of a conformance run as plain data: checks, pictures, albedos, and the verdict on all."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import KW_ONLY, dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Final, Literal, TypeAlias, TypedDict, get_args

import numpy as np
from numpy.typing import NDArray

from mxeon import errors
from mxeon.errors import CheckError, InputError
from mxeon.hosts.base import Identity
from mxeon.io.files import AnyPath
from mxeon.io.images import difference

Verdict: TypeAlias = Literal["passed", "differs", "failed", "not run"]
PASSED: Final = "passed"
DIFFERS: Final = "differs"
FAILED: Final = "failed"
NOT_RUN: Final = "not run"
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
STATUSES = {PASSED: errors.PASSED, FAILED: errors.FAILED, NOT_RUN: errors.NOT_RUN}  # of a run
# In the place of a document: one material of each node, as every host shows it.
PORTRAIT = "portrait"
UNJUDGED = "nodes without a model"  # beside the files of a library
SOURCE = "source"  # in the place of a host, for what none has to run
SHADER_FUNCTIONS = "shader twins"  # in the place of a node, for the functions of a library
COUNTS = ("inputs", "values", "faults", "differences", "nodes")  # units of checks that count
WRONG_INSIDE = (
    "already fails inside its inputs' usual ranges"  # a reason that follows from a failure
)
NAMED = 3  # names in a list, before the number of the others
LIGHTS = {
    "side": "light from the side",
    "front": "light from the front",
    "back": "light from behind",
    "furnace": "a white environment",
}
RESULTS, JUNIT, PAGE = "results.json", "junit.xml", "report.html"
REPORT = (RESULTS, JUNIT, PAGE, "pictures/*", "upstream/*")  # patterns of the files of a report
DIRECT = ("value", "lobe")  # the checks of a node in direct light, of which it has one


@dataclass(frozen=True)
class Control:
    """The deliberately wrong variant of a check, run on the same host; it has to fail.

    - `variant`: The change that makes it wrong.
    - `error`: Measured by the check on it.
    - `caught`: Whether the check failed on it, as it must.
    """

    variant: str
    error: float
    caught: bool


class Claims(TypedDict, total=False):
    """What a result says of a renderer's own node beside its verdict; see Result."""

    claimed: str
    model: str


@dataclass(frozen=True)
class Result:
    """The outcome of one check of one subject on one host.

    - `check`, `claim`: Key of the check and the sentence that it tests.
    - `subject`: A node and its flag, or a document and its element.
    - `verdict`: PASSED, FAILED or NOT_RUN; DIFFERS where the specification leaves the error open.
    - `error`, `tolerance`, `unit`: Measured and allowed; a check passes at error <= tolerance.
    - `derivation`: That of the tolerance.
    - `worst`: The inputs and values at the worst point, by name.
    - `diagnosis`: The best-matching model with its distance, or another cause of a failure.
    - `distances`: Root-mean-square distance to each known model and defect, where diagnosed.
    - `control`: None only where the check did not run.
    - `reason`: Why it did not run.
    - `claimed`, `model`: Titles of the model that a renderer's own node claims, and of its published
      form that was judged.
    - `measured`: Inputs of a document's nodes whose values come from the host itself, since nodes of
      patterns have no model; see `mxeon.conformance.reference.HostValues`.
    - `pages`: Names of the pages of `docs/upstream/` on the defects that it shows.
    - `seconds`: Time of its task, shared equally among the task's results.

    Raises ValueError if the verdict is unknown, or an error is negative or has no tolerance.
    """

    check: str
    claim: str = field(repr=False)
    subject: str
    host: str
    library: str
    verdict: Verdict
    error: float | None = None
    unit: str = ""
    tolerance: float | None = None
    derivation: str = field(default="", repr=False)
    worst: dict[str, list[float]] = field(default_factory=dict, repr=False)
    diagnosis: str = ""
    distances: dict[str, float] = field(default_factory=dict, repr=False)
    control: Control | None = field(default=None, repr=False)
    reason: str = ""
    claimed: str = field(default="", repr=False)
    model: str = field(default="", repr=False)
    measured: tuple[str, ...] = field(default=(), repr=False)
    pages: tuple[str, ...] = ()
    seconds: float | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        assert_verdict(self.verdict)
        if self.error is None:
            return
        if self.tolerance is None:
            raise InputError(f"an error must have a tolerance; got {self.error} and none")
        if min(self.error, self.tolerance) < 0:
            raise InputError(
                f"error and tolerance must be at least 0; got {self.error} and {self.tolerance}"
            )

    @property
    def location(self) -> str:
        """Host and library, in words."""
        return f"{self.host} with {self.library}"

    @property
    def excess(self) -> str:
        """The error that is too large, or the control that passed; "" for neither."""
        control = self.control
        if self.error is not None and not self.error <= (self.tolerance or 0.0):
            if self.unit in COUNTS and math.isfinite(self.error):
                return counted(int(self.error), self.unit.removesuffix("s"))
            if self.unit.startswith("times "):
                return f"the error is {in_words(self.error)} {self.unit}"
            return f"{self.error:.3g} > {self.tolerance:.3g} {self.unit}".rstrip()
        if control and not control.caught:
            return f"the negative control is not caught: {control.variant}, {control.error:.3g}"
        return ""

    @property
    def explanation(self) -> str:
        """The reason for a failure: the excess, the diagnosis, and where the defect is described."""
        return "; ".join(filter(None, (self.excess, self.diagnosis, self.references)))

    @property
    def references(self) -> str:
        """Where the defects that it shows are described, in words; "" for none."""
        return "; ".join(f"see docs/upstream/{page}.md" for page in self.pages)


def assert_verdict(word: object) -> Verdict:
    """Return a verdict; raise InputError for any other word."""
    for verdict in VERDICTS:
        if word == verdict:
            return verdict
    raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {word!r}")


def of_white(radiance: float) -> str:
    """A difference as a share of the radiance of a white, matte surface that faces the light.

    >>> of_white(0.2035), of_white(1e-7)
    ('up to 20 % of white', 'less than 0.1 % of white')
    """
    share = 100.0 * radiance
    return f"up to {in_words(share)} % of white" if share >= 0.1 else "less than 0.1 % of white"


def in_words(number: float) -> str:
    """A number of two digits, without a power of ten.

    >>> in_words(1.234), in_words(1234.5)
    ('1.2', '1,200')
    """
    return f"{float(f'{number:.2g}'):,.10g}"


@dataclass(frozen=True)
class Picture:
    """One host's picture of one element, and the reference's where the models can express it.

    - `image`: Linear radiance, (size, size, 3), float32; see `mxeon.shaders.scene` for its scale.
    - `reference`: The same from the NumPy models; None where the material has other lobes.
    - `metadata`: Its origin: version, host, device, library, document, element, scene.
    - `judged`: 1 in the pixels that were compared, else 0, (size, size, 1); None where all were.
    """

    document: str
    element: str
    host: str
    library: str
    scene: str  # the light
    image: NDArray[np.floating] = field(repr=False)
    reference: NDArray[np.floating] | None = field(repr=False)
    metadata: dict[str, str] = field(repr=False)
    judged: NDArray[np.floating] | None = field(default=None, repr=False)

    def difference(self) -> NDArray[np.float64]:
        """Difference from the reference, (size, size): infinite where a value is not finite.

        Pixels between those of a judged lattice take the difference of the nearest one; other
        pixels that were not judged are NaN.
        """
        if self.reference is None:
            raise ValueError(f"{self.element}: a difference needs a reference; there is none")
        apart = difference(self.image, self.reference)
        apart = np.where(np.isfinite(apart), apart, np.inf)
        if self.judged is None:
            return apart
        judged = np.asarray(self.judged)[..., 0] > 0.0
        nearest = []
        for axis in (1, 0):
            lines = np.flatnonzero(judged.any(axis))
            gaps = np.abs(np.subtract.outer(np.arange(len(judged)), lines))
            nearest.append(lines[gaps.argmin(axis=1)])
        return np.where(judged, apart, np.nan)[np.ix_(*nearest)]


@dataclass(frozen=True)
class AlbedoCurve:
    """Directional albedo over the cosine `mu`, (N, 3), measured on a host beside its closed form."""

    subject: str
    host: str
    library: str
    rho: tuple[float, float, float]
    roughness: float
    mu: NDArray[np.float64] = field(repr=False)
    measured: NDArray[np.float64] = field(repr=False)
    expected: NDArray[np.float64] = field(repr=False)


def listed(names: Sequence[str]) -> str:
    """The first names of a list, and the number of the others.

    >>> listed(["a", "b", "c", "d"])
    'a, b, c and 1 more'
    """
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def report_files(folder: AnyPath) -> Iterator[Path]:
    """The files of the report in a folder, and of its journal."""
    for pattern in (*REPORT, "journal/*"):
        yield from Path(folder).glob(pattern)


def counted(count: int, noun: str) -> str:
    """A number of things.

    >>> counted(1, "check"), counted(2, "check")
    ('1 check', '2 checks')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


@dataclass(frozen=True)
class Scope:
    """What a run judges, and with what software.

    - `version`, `software`: That of mxeon, and those of what takes part: Python, NumPy, MaterialX, ...
    - `contents`: Titles of the nodes of each document that the user gave, by its path.
    - `unreached`: For each of these, by title of a node, the regions that its inputs are not in, as
      diagnoses name them.
    - `refused`: The faults of each document that could not be judged, by its path; if other libraries
      can read it, the key names the library behind it: "clay.mtlx with stock".
    - `libraries`: By folder that was judged as a library: its files, under "folder", and those of
      MaterialX that complete it, under "MaterialX", unless it is loaded before all of them.
    - `compared`: Libraries judged for comparison; the verdict ignores their failures.
    - `seconds`: Time from the first document to the last result; None for a run that is read.
    """

    version: str
    software: dict[str, str]
    _: KW_ONLY
    documents: tuple[Path, ...] = ()
    contents: dict[str, tuple[str, ...]] = field(default_factory=dict)
    unreached: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    refused: dict[str, tuple[str, ...]] = field(default_factory=dict)
    libraries: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    compared: tuple[str, ...] = ()


@dataclass(frozen=True)
class Run(Scope):
    """Everything that one `mxeon check` measured, and whether it passed.

    `passed` is the answer. Do not compute it from `results`: they lack documents that were refused, and
    hold the failures of libraries that are judged for comparison.

    - `notes`: Warnings that a reader has to see, e.g. what a host cannot express.
    - `missing`: Tasks that are not done yet, where the run was interrupted.
    """

    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[Picture, ...] = ()
    curves: tuple[AlbedoCurve, ...] = ()
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    seconds: float | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        return f"<Run: {self.summary}>"

    @property
    def passed(self) -> bool:
        """Whether everything that was requested ran and nothing failed or was refused."""
        return self.exit_status == errors.PASSED

    @property
    def exit_status(self) -> int:
        """The exit status of `mxeon check`: 0 passed, 1 failed, 2 a document was refused, 3 not run."""
        return errors.MISUSE if self.refused else STATUSES[self.verdict]

    def raise_for_failure(self) -> None:
        """Raise `mxeon.errors.CheckError` unless the run passed, with the verdict and its causes."""
        if self.passed:
            return
        judged = [each for each in self.results if each.library not in self.compared]
        causes = [
            f"{each.verdict}: {each.location}, {each.check}, {each.subject}: "
            + (each.reason or each.explanation)
            for verdict in (FAILED, NOT_RUN)
            for each in judged
            if each.verdict == verdict
        ]
        raise CheckError(self.sentence, *self.errors, *causes, status=self.exit_status)

    @property
    def verdict(self) -> Verdict:
        """FAILED if a check failed, else NOT_RUN if one is missing or anything was refused, else PASSED.

        Libraries that are judged for comparison do not count.
        """
        return self._outcome[0]

    @property
    def counts(self) -> dict[Verdict, int]:
        """The number of checks with each verdict, without libraries judged for comparison."""
        return self._outcome[1]

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return self._outcome[2]

    @cached_property
    def _outcome(self) -> tuple[Verdict, dict[Verdict, int], str]:
        results = [each for each in self.results if each.library not in self.compared]
        tally = Counter(result.verdict for result in results)
        counts = {verdict: tally[verdict] for verdict in VERDICTS}
        total = counted(len(results), "check")
        hosts = " and ".join(dict.fromkeys(result.location for result in results))
        differ = ""
        if counts[DIFFERS]:
            verb = "differs" if counts[DIFFERS] == 1 else "differ"
            differ = f"; {counts[DIFFERS]} {verb} where the specification leaves it open"
        verdict: Verdict = PASSED
        # Those that a failure keeps from running are part of it.
        idle = sum(
            each.verdict == NOT_RUN and not each.reason.endswith(WRONG_INSIDE) for each in results
        )
        missed = f"; {idle} did not run" if idle else ""
        if counts[FAILED]:
            failed = Counter(result.location for result in results if result.verdict == FAILED)
            places = [f"{count} on {location}" for location, count in failed.items()]
            where = f": {', '.join(places)}" if len(failed) > 1 else f" on {next(iter(failed))}"
            verdict = FAILED
            sentence = f"{counts[FAILED]} of {total} failed{where}{missed}{differ}."
        elif not counts[PASSED] + counts[DIFFERS]:
            verdict, sentence = NOT_RUN, "No check ran."
        elif counts[NOT_RUN]:
            verdict = NOT_RUN
            sentence = f"Nothing failed, but {counts[NOT_RUN]} of {total} did not run{differ}."
        elif differ:
            sentence = f"{counts[PASSED]} of {total} passed on {hosts}{differ}."
        else:
            passed = "The check" if len(results) == 1 else f"All {len(results)} checks"
            sentence = f"{passed} passed on {hosts}."
        if elsewhere := sum(map(self.is_elsewhere, results)):
            sentence += f" {elsewhere} of them for inputs that no document uses."
        if self.missing:
            verb = "is" if len(self.missing) == 1 else "are"
            items = counted(len(self.missing), "item")
            sentence += f" The run is not finished: {items} {verb} missing."
        if self.refused:
            sentence = f"Refused and not judged: {listed(tuple(self.refused))}. {sentence}"
        if (self.missing or self.refused) and verdict != FAILED:
            verdict = NOT_RUN  # without what is not there nothing has passed
        for library in self.compared:
            other = [each.verdict for each in self.results if each.library == library]
            ran = len(other) - other.count(NOT_RUN)
            words = f" For comparison, {other.count(FAILED)} of {ran} failed with {library}."
            sentence += words * bool(ran)
        return verdict, counts, sentence

    @cached_property
    def differences(self) -> dict[tuple[str, str, str], float]:
        """Largest difference of pictures, relative where the reference exceeds 1, by subject, host and library."""
        found: dict[tuple[str, str, str], float] = {}
        for each in self.pictures:
            if each.reference is not None:
                scale = np.maximum(1.0, np.abs(each.reference).max(axis=-1))
                place = f"{each.document}: {each.element}", each.host, each.library
                largest = float(np.nanmax(each.difference() / scale))
                found[place] = max(found.get(place, 0.0), largest)
        return found

    @property
    def errors(self) -> tuple[str, ...]:
        """The faults of all documents that were refused."""
        return tuple(line for lines in self.refused.values() for line in lines)

    def is_elsewhere(self, result: Result, *documents: str) -> bool:
        """Whether a check fails for inputs alone that no document has that shows its node."""
        region = result.diagnosis.split(";")[0]
        shown = [
            self.unreached.get(each, {}).get(result.subject, ())
            for each in documents or self.contents
            if result.subject in self.contents[each]
        ]
        return (
            result.verdict == FAILED
            and bool(shown)
            and all(any(region.endswith(name) for name in names) for names in shown)
        )

    @property
    def summary(self) -> str:
        """The verdict in words, the MaterialX that was judged, with its folder unless it is installed, and the time."""
        version, folder = (self.software.get(name) for name in ("MaterialX", "MaterialX folder"))
        judged = f" MaterialX {version}{f', from {folder}' if folder else ''}." if version else ""
        time = "" if self.seconds is None else f" Finished in {self.seconds:.1f} s."
        return self.sentence + judged + time

    @property
    def origins(self) -> tuple[str, ...]:
        """For each folder judged as a library: its files, MaterialX's, and the lobes that have no model."""
        return tuple(
            f"library {folder}: {counted(len(files['folder']), 'file')} from the folder, "
            + (
                f"{len(files['MaterialX']) or 'none'} from"
                if "MaterialX" in files
                else "loaded before"
            )
            + f" MaterialX {self.software['MaterialX']}"
            + (f"; no model judges its {listed(files[UNJUDGED])}" if UNJUDGED in files else "")
            for folder, files in self.libraries.items()
        )
