# SPDX-License-Identifier: Apache-2.0
"""What a conformance run leaves behind: plain data, from `conformance` to `report`."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mxeon.errors import InputError
from mxeon.shaders.hosts.base import Identity

PASSED, FAILED, NOT_RUN = "passed", "failed", "not run"
VERDICTS = (PASSED, FAILED, NOT_RUN)


@dataclass(frozen=True)
class Control:
    """The deliberately wrong variant of a check, run on the same host; it has to fail.

    Attributes
    ----------
    variant : str
        What was made wrong.
    figure : float
        What the check measured on it.
    caught : bool
        Whether the check failed on it, as it must.
    """

    variant: str
    figure: float
    caught: bool


@dataclass(frozen=True)
class Result:
    """The outcome of one check of one subject on one host.

    Attributes
    ----------
    check, claim : str
        Key of the check's row and the sentence it tests.
    subject : str
        What was judged: a node and its flag, or a document and its element.
    host, library : str
        Where it ran, and whose data library it used.
    verdict : str
        PASSED, FAILED or NOT_RUN.
    figure, tolerance : float or None
        Measured and allowed, in `unit`; a check passes at figure <= tolerance.
    unit, derivation : str
        Unit of both, and where the tolerance comes from.
    worst : dict of str to list of float
        The inputs and values at the worst point, by name.
    diagnosis : str
        The nearest known model with its distance, or what else explains a failure.
    distances : dict of str to float
        Root-mean-square distance to each known model and defect, by title, where diagnosed.
    control : Control or None
        None only where the check did not run.
    reason : str
        Why it did not run.

    Raises
    ------
    ValueError
        If the verdict is unknown, or a figure is negative or stands without its tolerance.
    """

    check: str
    claim: str
    subject: str
    host: str
    library: str
    verdict: str
    figure: float | None = None
    unit: str = ""
    tolerance: float | None = None
    derivation: str = ""
    worst: dict[str, list[float]] = field(default_factory=dict)
    diagnosis: str = ""
    distances: dict[str, float] = field(default_factory=dict)
    control: Control | None = None
    reason: str = ""

    def __post_init__(self):
        if self.verdict not in VERDICTS:
            raise InputError(f"verdict must be one of {', '.join(VERDICTS)}; got {self.verdict!r}")
        if self.figure is None:
            return
        if self.tolerance is None:
            raise InputError(f"figure must have its tolerance; got {self.figure} and none")
        if min(self.figure, self.tolerance) < 0:
            raise InputError(
                f"figure and tolerance must be at least 0; got {self.figure} and {self.tolerance}"
            )


@dataclass(frozen=True)
class Picture:
    """One host's picture of one element, and the reference's where the models can express it.

    Attributes
    ----------
    document, element, host, library, scene : str
        What is shown, by whom, under which light.
    image : ndarray, shape (size, size, 3), float32
        Linear radiance; see `mxeon.shaders.scene` for its scale.
    reference : ndarray or None
        The same from the NumPy models, or None where the material has other lobes.
    metadata : dict of str to str
        What made it: version, host, device, library, document, element, scene.
    """

    document: str
    element: str
    host: str
    library: str
    scene: str
    image: np.ndarray
    reference: np.ndarray | None
    metadata: dict[str, str]


@dataclass(frozen=True)
class Curve:
    """Directional albedo over the cosine, measured on a host beside its closed form.

    Attributes
    ----------
    subject, host, library : str
        What was measured, where.
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
    mu: np.ndarray
    measured: np.ndarray
    expected: np.ndarray


@dataclass(frozen=True)
class Item:
    """One independent piece of a run: a check of one subject on one host with one library.

    Attributes
    ----------
    check : str
        Key of a row of `mxeon.conformance.checks.table.CHECKS`, or "host", "source", "curve" or "picture".
    subject : str
        Title of a node, path of a document, or "shader twins".
    host, library : str
    """

    check: str
    subject: str
    host: str
    library: str

    def __str__(self):
        return f"{self.host}, {self.check}, {self.subject}, {self.library}"


@dataclass(frozen=True)
class Plan:
    """What a run consists of; two runs are the same if their plans are.

    Attributes
    ----------
    version : str
        Of mxeon.
    software : dict of str to str
        Versions of what takes part (Python, NumPy, MaterialX, ...).
    items : tuple of Item
    documents : tuple of str
        Their paths.
    options : dict of str to str
        What the documents may do, by the option of the command.
    files : dict of str to str
        SHA-256 of each file that the findings depend on, by path; "" where it cannot be read.
        Empty where the run is not kept.
    """

    version: str
    software: dict[str, str]
    items: tuple[Item, ...]
    documents: tuple[str, ...]
    options: dict[str, str] = field(default_factory=dict)
    files: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Findings:
    """What the work on one item found; see Run."""

    results: tuple[Result, ...] = ()
    pictures: tuple[Picture, ...] = ()
    curves: tuple[Curve, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    errors: tuple[str, ...] = ()
    hosts: tuple[Identity, ...] = ()

    def answer(self, item):
        """Whether these are findings of an item: there are some, and all are of its place."""
        records = (*self.results, *self.pictures, *self.curves)
        place = (item.host, item.library)
        return bool(records or self.errors) and all((r.host, r.library) == place for r in records)


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
    missing : tuple of str
        Items that are not done yet, where the run was interrupted.
    """

    version: str
    software: dict
    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[Picture, ...] = ()
    curves: tuple[Curve, ...] = ()
    notes: tuple[str, ...] = ()
    errors: tuple[str, ...] = ()
    documents: tuple[Path, ...] = ()
    missing: tuple[str, ...] = ()
