# SPDX-License-Identifier: Apache-2.0
"""The documents of a run: those of a folder, the verdict on each, and the documents of each cause."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from mxeon.conformance.pictures.documents import DOCUMENT_KEY
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Result, Run, counted
from mxeon.errors import InputError

REFUSED = "refused"
NO_REFERENCE = "no reference"  # whose pixels are numbers
FROM_HOST = "as the reference's, with inputs that the host computed"
WHOLE = "as the reference's"
# The first decides about a document.
STATES = (FAILED, NOT_RUN, REFUSED, DIFFERS, NO_REFERENCE, PASSED)
QUOTED = re.compile(r"'[^']*/[^']*'|\"[^\"]*\"")  # names of one document in a reason
SHARE = re.compile(r"(up to|less than) [\d.,]+ % of white ")  # which no two documents share
KEYS = ("picture", "finite", DOCUMENT_KEY)


@dataclass(frozen=True)
class DocumentVerdict:
    """What a run says of one document."""

    document: str  # its path
    host: str  # "" where the document was refused
    library: str
    verdict: str  # one of STATES
    cause: str  # why, in words that documents share
    referenced: bool = False  # whether all of its pictures have a reference
    measured: tuple[str, ...] = ()  # inputs whose values these take from the host


def documents_in(files: Iterable[str | os.PathLike[str]]) -> tuple[str, ...]:
    """Files, and in the place of a folder the documents in it and below it, in order.

    Raise ValueError if a folder holds no document.
    """
    documents: list[str] = []
    for file in files:
        inside = [os.fspath(file)]
        if os.path.isdir(file):
            inside = sorted(map(str, Path(file).rglob("*.mtlx")))
        if not inside:
            raise InputError(f"{file}: must hold MaterialX documents (*.mtlx); there is none")
        documents += inside
    return tuple(dict.fromkeys(documents))


def document_verdicts(run: Run) -> tuple[DocumentVerdict, ...]:
    results: dict[tuple[str, str, str], list[Result]] = {}
    for each in run.results:
        if each.check in KEYS:
            name = each.subject.split(": ")[0]
            results.setdefault((name, each.host, each.library), []).append(each)
    verdicts = []
    for document in map(str, run.contents):
        keys = [key for key in results if key[0] in (Path(document).name, document)]
        keys = [key for key in keys if not is_refused(run, document, key[2])]
        verdicts += [_verdict(document, key, results[key]) for key in keys]
    return (*verdicts, *(_refused(*each) for each in run.refused.items()))


def is_refused(run: Run, document: str, library: str) -> bool:
    """Whether a document was refused, with a library at least."""
    return not run.refused.keys().isdisjoint((document, f"{document} with {library}"))


def causes(verdicts: Sequence[DocumentVerdict]) -> dict[tuple[str, str], tuple[str, ...]]:
    """Documents by their verdict and its cause, the worst first, and those of most documents."""
    groups: dict[tuple[str, str], list[str]] = {}
    for each in verdicts:
        groups.setdefault((each.verdict, each.cause), []).append(each.document)
    order = sorted(groups, key=lambda key: (STATES.index(key[0]), -len(groups[key])))
    return {key: tuple(groups[key]) for key in order}


def _verdict(
    document: str, key: tuple[str, str, str], results: Sequence[Result]
) -> DocumentVerdict:
    worst = min(results, key=lambda each: (STATES.index(each.verdict), each.check != "finite"))
    finite = worst.check == "finite" and worst.verdict == PASSED
    measured = tuple(dict.fromkeys(name for each in results for name in each.measured))
    return DocumentVerdict(
        document,
        *key[1:],
        NO_REFERENCE if finite else worst.verdict,
        _cause(worst, measured),
        all(each.check == "picture" and each.error is not None for each in results),
        measured,
    )


def _cause(result: Result, measured: Sequence[str]) -> str:
    """Why a document has its verdict, by the result that decides."""
    if result.verdict == PASSED and result.check == "picture":
        return FROM_HOST if measured else WHOLE
    if result.verdict == PASSED and result.check == DOCUMENT_KEY:
        return "shaders are generated"
    reason = (result.reason or result.diagnosis).split("; last output:")[0]
    reason = SHARE.sub("", reason.removeprefix("reference: "))
    return QUOTED.sub("...", reason) or result.excess


def _refused(document: str, lines: Sequence[str]) -> DocumentVerdict:
    """The verdict on a document that could not be used, by the first line that says so."""
    known = lines[0].startswith(f"{document}: ")
    name = document if known else document.rpartition(" with ")[0]
    reason = lines[0].removeprefix(f"{name}: ")
    reason += f"; {counted(len(lines) - 1, 'more fault')}" if len(lines) > 1 else ""
    return DocumentVerdict(document, "", "", REFUSED, QUOTED.sub("...", reason))
