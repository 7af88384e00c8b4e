# SPDX-License-Identifier: Apache-2.0
"""The results of a conformance run as plain data, and the verdict on them."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from mxeon.errors import InputError
from mxeon.hosts.base import Identity

PASSED, DIFFERS, FAILED, NOT_RUN = "passed", "differs", "failed", "not run"
VERDICTS = (PASSED, DIFFERS, FAILED, NOT_RUN)
# In the place of a document: one material of each node, as every host shows it.
PORTRAIT = "portrait"
SOURCE = "source"  # in the place of a host, for what none has to run
SHADER_FUNCTIONS = "shader twins"  # in the place of a node, for the functions of a library
DIRECT = ("value", "lobe")  # the checks of a node in direct light, of which it has one
NOT_PLAIN = re.compile("[^A-Za-z0-9]+")


@dataclass(frozen=True)
class Control:
    """The deliberately wrong variant of a check, run on the same host; it has to fail.

    Attributes
    ----------
    variant : str
        The change that makes it wrong.
    error : float
        Measured by the check on it.
    caught : bool
        Whether the check failed on it, as it must.
    """

    variant: str
    error: float
    caught: bool


class Claims(TypedDict, total=False):
    """What a result says of a renderer's own node beside its verdict; see Result."""

    claimed: str
    model: str


class Place(Claims):
    """What a result is of; see Result."""

    check: str
    claim: str
    subject: str
    host: str
    library: str


@dataclass(frozen=True)
class Result:
    """The outcome of one check of one subject on one host.

    Attributes
    ----------
    check, claim : str
        Key of the check's row and the sentence it tests.
    subject : str
        A node and its flag, or a document and its element.
    host, library : str
        The host it ran on, and the data library it used.
    verdict : str
        PASSED, FAILED or NOT_RUN; DIFFERS where the error is what the specification leaves open.
    error, tolerance : float or None
        Measured and allowed, in `unit`; a check passes at error <= tolerance.
    unit, derivation : str
        Unit of both, and the derivation of the tolerance.
    worst : dict of str to list of float
        The inputs and values at the worst point, by name.
    diagnosis : str
        The nearest known model with its distance, or another explanation of a failure.
    distances : dict of str to float
        Root-mean-square distance to each known model and defect, by title, where diagnosed.
    control : Control or None
        None only where the check did not run.
    reason : str
        Why it did not run.
    claimed, model : str
        Titles of the model that a renderer's own node claims, and of the form of it that was judged,
        which is the one that it has where the check passes; "" for other subjects.
    measured : tuple of str
        Inputs of a document's nodes whose values the expected picture has from the host itself,
        since nodes of patterns have no model; see `mxeon.conformance.reference.measured`.

    Raises
    ------
    ValueError
        If the verdict is unknown, or an error is negative or has no tolerance.
    """

    check: str
    claim: str
    subject: str
    host: str
    library: str
    verdict: str
    error: float | None = None
    unit: str = ""
    tolerance: float | None = None
    derivation: str = ""
    worst: dict[str, list[float]] = field(default_factory=dict)
    diagnosis: str = ""
    distances: dict[str, float] = field(default_factory=dict)
    control: Control | None = None
    reason: str = ""
    claimed: str = ""
    model: str = ""
    measured: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        if self.verdict not in VERDICTS:
            raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {self.verdict!r}")
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
            if self.unit.startswith("times "):
                return f"the error is {in_words(self.error)} {self.unit}"
            return f"{self.error:.3g} > {self.tolerance:.3g} {self.unit}".rstrip()
        if control and not control.caught:
            return f"the negative control is not caught: {control.variant}, {control.error:.3g}"
        return ""

    @property
    def explanation(self) -> str:
        """The reason for a failure: the excess and the diagnosis."""
        return "; ".join(filter(None, (self.excess, self.diagnosis)))


@dataclass(frozen=True)
class Summary:
    """The verdict on a whole run.

    Attributes
    ----------
    verdict : str
        FAILED if any check failed, else NOT_RUN if any or all did not run or the run is not
        finished, else PASSED.
    counts : dict of str to int
        Number of checks that ended with each of VERDICTS.
    sentence : str
        The same for a reader.
    """

    verdict: str
    counts: dict[str, int]
    sentence: str


def counted(count: int, noun: str) -> str:
    """A number of things.

    Examples
    --------
    >>> counted(1, "check"), counted(2, "check")
    ('1 check', '2 checks')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


def in_words(number: float) -> str:
    """A number of two digits, without a power of ten.

    Examples
    --------
    >>> in_words(1.234), in_words(1234.5)
    ('1.2', '1,200')
    """
    return f"{float(f'{number:.2g}'):,.10g}"


def summarize(
    results: Sequence[Result], missing: Sequence[str] = (), errors: Sequence[str] = ()
) -> Summary:
    """Verdict on `results`.

    Parameters
    ----------
    results : sequence of Result
    missing : sequence of str
        Tasks of an interrupted run that are not done yet.
    errors : sequence of str
        One line for each document that was refused.

    Examples
    --------
    >>> summarize(()).sentence
    'No check ran.'
    """
    # Judge what there is.
    summary = _summarize_results(results)
    if not missing and not errors:
        return summary
    # Say what is not there: without it nothing has passed.
    verdict = FAILED if summary.verdict == FAILED else NOT_RUN
    sentence = summary.sentence
    if missing:
        verb = "is" if len(missing) == 1 else "are"
        sentence += f" The run is not finished: {counted(len(missing), 'item')} {verb} missing."
    if errors:
        sentence += f" Refused: {counted(len(errors), 'document')}."
    return replace(summary, verdict=verdict, sentence=sentence)


def _summarize_results(results: Sequence[Result]) -> Summary:
    tally = Counter(result.verdict for result in results)
    counts = {verdict: tally[verdict] for verdict in VERDICTS}
    total = len(results)
    # A failure decides.
    if counts[FAILED]:
        failed = Counter(result.location for result in results if result.verdict == FAILED)
        listed = "; ".join(f"{count} on {location}" for location, count in failed.items())
        return Summary(
            FAILED, counts, f"{counts[FAILED]} of {counted(total, 'check')} failed: {listed}."
        )
    # Then what did not run.
    if not counts[PASSED] + counts[DIFFERS]:
        return Summary(NOT_RUN, counts, "No check ran.")
    if counts[NOT_RUN]:
        sentence = (
            f"Nothing failed, but {counts[NOT_RUN]} of {counted(total, 'check')} did not run."
        )
        return Summary(NOT_RUN, counts, sentence)
    # All ran: they passed, or differ where they may.
    hosts = " and ".join(dict.fromkeys(result.location for result in results))
    if counts[DIFFERS]:
        sentence = (
            f"{counts[PASSED]} of {counted(total, 'check')} passed on {hosts}; {counts[DIFFERS]} "
            f"{'differs' if counts[DIFFERS] == 1 else 'differ'} where the specification leaves it open."
        )
        return Summary(PASSED, counts, sentence)
    passed = "The check" if total == 1 else f"All {total} checks"
    return Summary(PASSED, counts, f"{passed} passed on {hosts}.")


@dataclass(frozen=True)
class Picture:
    """One host's picture of one element, and the reference's where the models can express it.

    Attributes
    ----------
    document, element, host, library, scene : str
        The material, the host that rendered it, and the light.
    image : ndarray, shape (size, size, 3), float32
        Linear radiance; see `mxeon.shaders.scene` for its scale.
    reference : ndarray or None
        The same from the NumPy models, or None where the material has other lobes.
    metadata : dict of str to str
        Its origin: version, host, device, library, document, element, scene.
    """

    document: str
    element: str
    host: str
    library: str
    scene: str
    image: NDArray[np.floating]
    reference: NDArray[np.floating] | None
    metadata: dict[str, str]


def image_names(pictures: Sequence[Picture]) -> tuple[str, ...]:
    """File names for pictures, without suffix: ASCII, and different whatever the case."""
    names, uses = [], Counter[str]()
    for picture in pictures:
        document = Path(picture.document).stem
        words = (document, picture.element, picture.host, picture.library, picture.scene)
        name = "-".join(NOT_PLAIN.sub("_", word)[:40] for word in words)
        uses[name.lower()] += 1
        # A counter is a sixth word, which no other name has.
        names.append(name if uses[name.lower()] == 1 else f"{name}-{uses[name.lower()]}")
    return tuple(names)


@dataclass(frozen=True)
class AlbedoCurve:
    """Directional albedo over the cosine, measured on a host beside its closed form.

    Attributes
    ----------
    subject, host, library : str
    rho : tuple of 3 floats
    roughness : float
    mu : ndarray, shape (N,)
    measured, expected : ndarray, shape (N, 3)
    """

    subject: str
    host: str
    library: str
    rho: tuple[float, float, float]
    roughness: float
    mu: NDArray[np.float64]
    measured: NDArray[np.float64]
    expected: NDArray[np.float64]


@dataclass(frozen=True)
class Run:
    """Everything that one `mxeon check` measured.

    Attributes
    ----------
    version : str
        Of mxeon.
    software : dict of str to str
        Versions of what took part (Python, NumPy, MaterialX, ...).
    hosts : tuple of Identity
    results : tuple of Result
    pictures : tuple of Picture
    curves : tuple of Curve
    notes : tuple of str
        Warnings a reader has to see, e.g. what a host cannot express.
    errors : tuple of str
        One line for each document that could not be judged.
    documents : tuple of Path
    contents : dict of str to tuple of str
        Titles of the nodes of each document that the user gave, by its path.
    missing : tuple of str
        Tasks that are not done yet, where the run was interrupted.
    """

    version: str
    software: dict[str, str]
    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[Picture, ...] = ()
    curves: tuple[AlbedoCurve, ...] = ()
    notes: tuple[str, ...] = ()
    errors: tuple[str, ...] = ()
    documents: tuple[Path, ...] = ()
    contents: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: tuple[str, ...] = ()

    @cached_property
    def summary(self) -> Summary:
        """The verdict on this run."""
        return summarize(self.results, self.missing, self.errors)

    @cached_property
    def image_names(self) -> tuple[str, ...]:
        """File names for the pictures, without suffix: ASCII, and different whatever the case."""
        return image_names(self.pictures)
