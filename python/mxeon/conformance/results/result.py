# SPDX-License-Identifier: Apache-2.0
"""The outcome of one check."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TypedDict

from mxeon.errors import InputError

PASSED, DIFFERS, FAILED, NOT_RUN = "passed", "differs", "failed", "not run"
VERDICTS = (PASSED, DIFFERS, FAILED, NOT_RUN)
# In the place of a document: one material of each node, as every host shows it.
PORTRAIT = "portrait"
SOURCE = "source"  # in the place of a host, for what none has to run
SHADER_FUNCTIONS = "shader twins"  # in the place of a node, for the functions of a library
DIRECT = ("value", "lobe")  # the checks of a node in direct light, of which it has one


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
        Key of the check and the sentence it tests.
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
        The best-matching model with its distance, or another explanation of a failure.
    distances : dict of str to float
        Root-mean-square distance to each known model and defect, by title, where diagnosed.
    control : Control or None
        None only where the check did not run.
    reason : str
        Why it did not run.
    claimed, model : str
        Titles of the model that a renderer's own node claims, and of its published form that was
        judged; "" for other subjects.
    measured : tuple of str
        Inputs of a document's nodes whose values come from the host itself, since nodes of patterns
        have no model; see `mxeon.conformance.reference.measured`.
    pages : tuple of str
        Names of the pages of `docs/upstream/` on the defects that it shows.

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
    pages: tuple[str, ...] = ()

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
        """The reason for a failure: the excess, the diagnosis, and where the defect is described."""
        return "; ".join(filter(None, (self.excess, self.diagnosis, self.references)))

    @property
    def references(self) -> str:
        """Where the defects that it shows are described, in words; "" for none."""
        return "; ".join(f"see docs/upstream/{page}.md" for page in self.pages)


def of_white(radiance: float) -> str:
    """A difference as a share of the radiance of a white, matte surface that faces the light.

    Examples
    --------
    >>> of_white(0.2035), of_white(1e-7)
    ('up to 20 % of white', 'less than 0.1 % of white')
    """
    share = 100.0 * radiance
    return f"up to {in_words(share)} % of white" if share >= 0.1 else "less than 0.1 % of white"


def in_words(number: float) -> str:
    """A number of two digits, without a power of ten.

    Examples
    --------
    >>> in_words(1.234), in_words(1234.5)
    ('1.2', '1,200')
    """
    return f"{float(f'{number:.2g}'):,.10g}"
