# SPDX-License-Identifier: Apache-2.0
"""The results of a conformance run as plain data: checks, pictures, and the overall verdict.

`mxeon.conformance.words` turns results into sentences, which no code parses.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Iterator
from dataclasses import KW_ONLY, Field, dataclass, field, fields
from enum import Enum
from functools import cached_property
from pathlib import Path
from types import ModuleType
from typing import Any, ClassVar, Final, Literal, TypeAlias, TypeVar, get_args

import numpy as np
from numpy.typing import NDArray

from mxeon import errors
from mxeon.conformance.results.quantities import Quantity as Quantity
from mxeon.errors import CheckError, InputError
from mxeon.hosts.base import Identity
from mxeon.io.files import AnyPath
from mxeon.io.images import difference
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.scene import sphere

Verdict: TypeAlias = Literal["passed", "differs", "failed", "not run"]
PASSED: Final = "passed"
DIFFERS: Final = "differs"
FAILED: Final = "failed"
NOT_RUN: Final = "not run"
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
# Exit status of a run for each verdict.
STATUSES = {PASSED: errors.PASSED, FAILED: errors.FAILED, NOT_RUN: errors.NOT_RUN}
# Replaces a document's name in pictures of nodes, which belong to no document.
PORTRAIT = "portrait"
SOURCE = "source"  # replaces the host in checks of source code, which need no host
SHADER_FUNCTIONS = "shader twins"  # subject of the checks of a library's functions
RESULTS, JUNIT, PAGE = "results.json", "junit.xml", "report.html"
REPORT = (RESULTS, JUNIT, PAGE, "pictures/*", "upstream/*")  # file patterns of a report
DIRECT = ("value", "lobe")  # checks in direct light, one of which applies to every node
VISIBLE = 0.01  # smallest visible contrast, as a fraction of white or of a highlight

Item = TypeVar("Item")
Key = TypeVar("Key", bound=Hashable)


def grouped(items: Iterable[Item], key: Callable[[Item], Key]) -> dict[Key, list[Item]]:
    """Items grouped by a key. The order of keys and items is kept.

    >>> grouped(["eon", "gl", "osl"], len)
    {3: ['eon', 'osl'], 2: ['gl']}
    """
    groups: dict[Key, list[Item]] = {}
    for item in items:
        groups.setdefault(key(item), []).append(item)
    return groups


def node_of(subject: str) -> str:
    """The node of a result's subject, which names the node's mode after a comma."""
    return subject.partition(",")[0]


@dataclass(frozen=True)
class Control:
    """A deliberately wrong variant of a check, run on the check's host, which must fail.

    - `variant`: The deliberate mistake, in words.
    - `error`: The error that the check measures for the variant.
    - `caught`: Whether the check failed on the variant, which is required.
    """

    variant: str
    error: float
    caught: bool


class Kind(Enum):
    NONE = ""
    MODEL = "model"  # the known model or defect nearest to the values
    FAULT = "fault"  # a wrong use of the correct model, with which the values agree
    ACCURACY = "accuracy"  # insufficient accuracy of the correct model
    REGION = "region"  # values are wrong in the cause's region
    NOT_FINITE = "not finite"  # values are NaN or infinite in the cause's region
    CURE = "cure"  # input values that make the worst samples correct
    DEFECT = "defect"  # another known defect
    UNKNOWN = "unknown"
    TEXT = "text"  # the message of a compiler, a renderer or a document
    FOLLOWS = "follows"  # a consequence of another failure with its own result
    INPUT = "input"  # an input value that the model does not cover
    CONTROL = "control"  # the negative control passed


@dataclass(frozen=True)
class Region:
    """A set of direction pairs and inputs.

    - `name`: Name of an input, or of a row of `mxeon.conformance.words.REGIONS`.
    - `part`: Part of the input to which the range applies, a row of `words.PARTS`; "" for rows of
      REGIONS.
    - `low`, `high`: Ends of the range; None for an open end.
    - `channels`: Wrong channels of a color; () for all channels.
    """

    name: str
    part: str = ""
    low: float | None = None
    high: float | None = None
    channels: tuple[str, ...] = ()


class BriefRepr:
    """A dataclass whose representation omits fields with default values."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]

    def __repr__(self) -> str:
        set_fields = (
            f"{each.name}={value!r}"
            for each in fields(self)
            if each.repr and (value := getattr(self, each.name)) not in (each.default, {})
        )
        return f"{type(self).__name__}({', '.join(set_fields)})"


@dataclass(frozen=True, repr=False)
class Cause(BriefRepr):
    """One fact about wrong values.

    - `key`: Title of a model, or key of a row of the tables in `mxeon.conformance.words`.
    - `names`, `values`: Inputs, functions or files that the fact concerns, and numbers that the
      fact states.
    - `branch`: Kind of light, if only one kind is wrong.
    - `region`: Region in which the fact holds; None if the fact holds everywhere.
    - `wrong`, `of`: Number of wrong pairs, and number of all pairs.
    - `rms`: Root-mean-square distance between measured values and values that the cause predicts.
    - `point`: Directions and inputs at the worst point, by name.
    - `text`: Message of another program.
    """

    kind: Kind
    key: str = ""
    names: tuple[str, ...] = ()
    values: tuple[float, ...] = ()
    branch: str = ""
    region: Region | None = None
    wrong: int | None = None
    of: int | None = None
    rms: float | None = None
    point: dict[str, list[float]] = field(default_factory=dict, hash=False)
    text: str = ""

    @property
    def identity(self) -> tuple[object, ...]:
        """A key that is equal for causes that only differ in numbers."""
        region = self.region and (self.region.name, self.region.part, self.region.channels)
        return self.kind, self.key, self.names, self.branch, region


NO_CAUSE = Cause(Kind.NONE)


@dataclass(frozen=True, repr=False)
class Diagnosis(BriefRepr):
    """The explanation of a failure.

    - `causes`: The known causes. The first cause explains the most.
    - `distances`: Root-mean-square distances of values to all known models and defects, by title.
    - `permitted`: Whether a function that the specification permits reproduces all values.
    """

    causes: tuple[Cause, ...] = ()
    distances: dict[str, float] = field(default_factory=dict, repr=False)
    permitted: bool = False

    @property
    def first(self) -> Cause:
        return self.causes[0] if self.causes else NO_CAUSE

    @property
    def kind(self) -> Kind:
        return self.first.kind

    @property
    def region(self) -> Region | None:
        """The region of the first cause."""
        return self.first.region

    @property
    def distance(self) -> float:
        """Root-mean-square distance to the best match, or infinity if there is no match."""
        return min(self.distances.values(), default=np.inf)


NO_DIAGNOSIS = Diagnosis()


@dataclass(frozen=True)
class Errors:
    """Errors of all samples of a check, or of the samples in a region.

    - `of`, `wrong`, `not_finite`: Number of samples, number of samples whose error exceeds the
      tolerance, and number of samples without a finite error.
    - `largest`, `rms`: Largest finite error, and root mean square of the finite errors.
    - `region`: Region that contains the samples; None for all samples.
    """

    of: int
    wrong: int
    not_finite: int
    largest: float
    rms: float
    region: Region | None = None


@dataclass(frozen=True)
class Difference:
    """The difference between a picture and the reference picture.

    Differences are relative to white, or to reference pixels that are brighter than white.

    - `scene`: Name of the scene, which determines the light.
    - `largest`: Difference at the worst pixel, positive if the picture is too bright; infinite for
      NaN.
    - `highlight`: Whether the reference is brighter than white at the worst pixel.
    - `visible`: Fraction of the object's pixels whose difference exceeds VISIBLE.
    """

    scene: str
    largest: float
    highlight: bool
    visible: float

    @property
    def is_visible(self) -> bool:
        return abs(self.largest) > VISIBLE


def quoted(text: str) -> Diagnosis:
    """A diagnosis that quotes the message of another program."""
    return Diagnosis((Cause(Kind.TEXT, text=text),))


@dataclass(frozen=True, repr=False)
class Result(BriefRepr):
    """The outcome of one check of one subject on one host.

    - `check`, `claim`: Key of the check, and the sentence that the check tests.
    - `subject`: A node and its flag, or a document and its element.
    - `document`, `element`: Path of the judged document, and name path of the judged material; ""
      for other checks, and for a result that concerns no single material.
    - `verdict`: PASSED, FAILED or NOT_RUN; DIFFERS if the specification permits the error.
    - `error`, `tolerance`: Measured error and largest accepted error. A check passes if error <=
      tolerance.
    - `quantity`: The measured quantity with its unit; None if nothing was measured.
    - `derivation`: Derivation of the tolerance from its terms.
    - `worst`: The inputs and values at the worst point, by name.
    - `errors`: Errors of all samples, then of each region; () if the check passed or has no
      samples.
    - `samples`: Checksum of the samples; "" if `errors` is empty.
    - `diagnosis`: The explanation of a failure.
    - `difference`: Unweighted difference of a material's worst picture; None for other checks.
    - `control`: The negative control; None only if the check did not run.
    - `reason`: Reason that the check did not run.
    - `claimed`: Title of the model that a renderer's own node claims to have.
    - `model`: Title of the published form of the claimed model, which was judged.
    - `measured`: Inputs of a document's nodes whose values come from the host, because patterns
      have no model; see `mxeon.conformance.reference.HostValues`.
    - `pages`: Names of pages in `docs/upstream/` on the defects that the result shows.
    - `seconds`: Duration of the task that has the result, divided by the task's number of results.

    Raises ValueError if the verdict is unknown, if the error is negative, or if an error has no
    tolerance.
    """

    check: str
    claim: str = field(repr=False)
    subject: str
    host: str
    library: str
    verdict: Verdict
    error: float | None = None
    quantity: Quantity | None = None
    tolerance: float | None = None
    derivation: str = field(default="", repr=False)
    worst: dict[str, list[float]] = field(default_factory=dict, repr=False)
    errors: tuple[Errors, ...] = field(default=(), repr=False)
    samples: str = field(default="", repr=False)
    diagnosis: Diagnosis = NO_DIAGNOSIS
    difference: Difference | None = field(default=None, repr=False)
    control: Control | None = field(default=None, repr=False)
    reason: str = ""
    document: str = field(default="", repr=False)
    element: str = field(default="", repr=False)
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
            pair = f"{self.error} and {self.tolerance}"
            raise InputError(f"error and tolerance must be at least 0; got {pair}")

    @property
    def unit(self) -> str:
        """The unit of the error."""
        return self.quantity.unit if self.quantity else ""

    @property
    def location(self) -> str:
        """The host and the library, in words."""
        return f"{self.host} with {self.library}"

    @property
    def explanation(self) -> str:
        """The reason for a failure: the size of the error, the diagnosis, and pages on defects."""
        return str(_words().explanation(self))

    @property
    def follows(self) -> bool:
        """Whether another failure, which has its own result, prevented the check."""
        return self.diagnosis.kind is Kind.FOLLOWS

    @property
    def within(self) -> bool:
        """Whether an error was measured and is at most the tolerance."""
        return self.error is not None and self.error <= (self.tolerance or 0.0)


def assert_verdict(word: object) -> Verdict:
    """Return a verdict. Raise InputError for a word that is no verdict."""
    if word not in VERDICTS:
        raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {word!r}")
    return word


@dataclass(frozen=True)
class Picture:
    """A host's picture of one element, and the reference picture if the models can compute one.

    - `image`: Linear radiance, (size, size, 3), float32. `mxeon.shaders.scene` defines the scale.
    - `reference`: The NumPy models' picture; None if the material has unsupported lobes.
    - `metadata`: Origin of the picture: version, host, device, library, document, element, scene.
    - `judged`: 1 for compared pixels, 0 for other pixels, (size, size, 1); None if all pixels were
      compared.
    """

    document: str
    element: str
    host: str
    library: str
    scene: str  # name of the scene, which determines the light
    image: NDArray[np.floating] = field(repr=False)
    reference: NDArray[np.floating] | None = field(repr=False)
    metadata: dict[str, str] = field(repr=False)
    judged: NDArray[np.floating] | None = field(default=None, repr=False)

    @property
    def shown(self) -> tuple[str, str]:
        """The path and the element of the document. Several documents may have one name."""
        return self.metadata.get("document", self.document), self.element

    @cached_property
    def difference(self) -> Difference | None:
        """The difference between the picture and the reference, or None without a reference."""
        if self.reference is None:
            return None
        image, reference = np.asarray(self.image), np.asarray(self.reference)
        mask = sphere(len(image)).mask
        if self.judged is not None:
            mask = np.asarray(self.judged)[..., 0] > 0.0
        image, reference = image[mask], reference[mask]
        differences = difference(image, reference)
        worst = int(np.abs(differences).argmax())
        highlight = bool(np.abs(reference[worst]).max() > 1.0)
        visible = float(np.mean(np.abs(differences) > VISIBLE))
        return Difference(self.scene, float(differences[worst]), highlight, visible)

    def difference_map(self) -> NDArray[np.float64]:
        """Absolute `mxeon.io.images.difference` of each pixel, (size, size).

        If only a lattice of pixels was judged, pixels between lattice pixels have the difference of
        the nearest lattice pixel. Other pixels that were not judged are NaN.
        """
        if self.reference is None:
            raise ValueError(f"{self.element}: a difference needs a reference; there is none")
        differences = np.abs(difference(self.image, self.reference))
        if self.judged is None:
            return differences
        judged = np.asarray(self.judged)[..., 0] > 0.0
        nearest = []
        for axis in (1, 0):
            lines = np.flatnonzero(judged.any(axis))
            gaps = np.abs(np.subtract.outer(np.arange(len(judged)), lines))
            nearest.append(lines[gaps.argmin(axis=1)])
        return np.where(judged, differences, np.nan)[np.ix_(*nearest)]


def report_files(folder: AnyPath) -> Iterator[Path]:
    """The files of a report and of a journal in a folder."""
    for pattern in (*REPORT, "journal/*"):
        yield from Path(folder).glob(pattern)


@dataclass(frozen=True)
class Refused:
    """The faults of a document that `library` cannot read. The name "" means all libraries."""

    document: str
    faults: tuple[str, ...]
    library: str = ""

    def __str__(self) -> str:
        return f"{self.document} with {self.library}" if self.library else self.document

    def concerns(self, document: str, library: str) -> bool:
        """Whether `library` cannot read `document`, or no library can if `library` is ""."""
        return self.document == document and self.library in ("", library)


@dataclass(frozen=True)
class Scope:
    """The subjects of a run, and the software versions.

    - `version`, `software`: Version of mxeon, and versions of other software such as Python and
      MaterialX.
    - `contents`: Titles of the nodes in each document that the user named, by the document's path.
    - `unreached`: Regions that a node's inputs never reach, by document and by the node's title.
    - `refused`: The documents that could not be judged with some or with all libraries.
    - `libraries`: Files of each folder that was judged as a library. The key "folder" has the
      folder's own files. The key "MaterialX" has the files that complete the folder, unless the
      folder is loaded before MaterialX.
    - `compared`: Libraries judged for comparison; the verdict ignores failures of these libraries.
    - `unjudged`: Subjects that no check judges, with reasons.
    """

    version: str
    software: dict[str, str]
    _: KW_ONLY
    documents: tuple[Path, ...] = ()
    contents: dict[str, tuple[str, ...]] = field(default_factory=dict)
    unreached: dict[str, dict[str, tuple[Region, ...]]] = field(default_factory=dict)
    refused: tuple[Refused, ...] = ()
    libraries: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    compared: tuple[str, ...] = ()
    unjudged: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True)
class Run(Scope):
    """All measurements of one `mxeon check`, and whether the run passed.

    Use `passed` for the overall result, because `results` alone lack refused documents and include
    failures of libraries that are judged for comparison.

    - `notes`: Warnings for readers, e.g. about features that a host cannot render.
    - `missing`: Unfinished tasks of an interrupted run.
    - `seconds`: Time from the first document to the last result; None for a run read from disk.
    - `policy`: Policy for the documents, if studio pictures of the documents are still missing.
    """

    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[Picture, ...] = ()
    notes: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    seconds: float | None = field(default=None, compare=False)
    policy: Policy | None = field(default=None, compare=False)

    def __repr__(self) -> str:
        return f"<Run: {self.summary}>"

    @property
    def passed(self) -> bool:
        """Whether every requested check ran, no check failed, and no document was refused."""
        return self.exit_status == errors.PASSED

    @property
    def exit_status(self) -> int:
        """Exit status of `mxeon check`: 0 passed, 1 failed, 2 a document was refused, 3 not run."""
        return errors.MISUSE if self.refused else STATUSES[self.verdict]

    def raise_for_failure(self) -> None:
        """Raise `mxeon.errors.CheckError` with the verdict and causes, unless the run passed."""
        if self.passed:
            return
        causes = [
            f"{each.verdict}: {each.location}, {each.check}, {each.subject}: "
            + (each.reason or each.explanation)
            for verdict in (FAILED, NOT_RUN)
            for each in self.judged
            if each.verdict == verdict
        ]
        raise CheckError(self.sentence, *self.errors, *causes, status=self.exit_status)

    @property
    def verdict(self) -> Verdict:
        """The overall verdict, which ignores libraries that are judged for comparison.

        The verdict is FAILED if a check failed, NOT_RUN if a check did not run or a document was
        refused, and otherwise PASSED.
        """
        if self.counts[FAILED]:
            return FAILED
        # A run has not passed if a check, a task or a document is missing.
        missing = self.counts[NOT_RUN] or not self.judged or self.missing or self.refused
        return NOT_RUN if missing else PASSED

    @cached_property
    def counts(self) -> dict[Verdict, int]:
        """The number of checks by verdict, ignoring libraries that are judged for comparison."""
        tally = Counter(each.verdict for each in self.judged)
        return {verdict: tally[verdict] for verdict in VERDICTS}

    @property
    def sentence(self) -> str:
        """The verdict in words."""
        return str(_words().sentence(self))

    @property
    def judged(self) -> tuple[Result, ...]:
        """The results, except results of libraries that are judged for comparison."""
        return tuple(each for each in self.results if each.library not in self.compared)

    @property
    def errors(self) -> tuple[str, ...]:
        """The faults of all documents that were refused."""
        return tuple(line for each in self.refused for line in each.faults)

    def is_elsewhere(self, result: Result, *documents: str) -> bool:
        """Whether a check fails only for inputs or lobes that the user's documents never use."""
        from mxeon.conformance.results.known_issues import blamed

        region, groups = result.diagnosis.region, blamed(result)
        given = documents or self.contents
        shown = [each for each in given if result.subject in self.contents[each]]
        return (result.verdict == FAILED and bool(shown)) and all(
            region in self.unreached.get(each, {}).get(result.subject, ())
            or (groups and all(g and g.isdisjoint(self.contents[each]) for g in groups))
            for each in shown
        )

    @property
    def summary(self) -> str:
        """The verdict, the version and folder of the judged MaterialX, and the time, in words."""
        return str(_words().summary(self))


def _words() -> ModuleType:
    """The module `words`, imported late because `words` imports this module."""
    from mxeon.conformance import words

    return words
