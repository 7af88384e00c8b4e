# SPDX-License-Identifier: Apache-2.0
"""The documents of a run: read before any other work, and the verdict on each with its cause after it."""

from __future__ import annotations

import os
import re
from collections.abc import Generator, Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import product
from pathlib import Path

from mxeon.conformance.diagnosis.regions import unreached
from mxeon.conformance.pictures import DOCUMENT_KEY
from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED, Result, Run, counted
from mxeon.conformance.spec import Spec, ValueSpec
from mxeon.conformance.specs import ALL
from mxeon.conformance.specs.emission import EmittingSurface
from mxeon.conformance.specs.thin_films import FilmSpec
from mxeon.errors import DocumentError, InputError, MxeonError
from mxeon.jobs import pool
from mxeon.shaders.contents import ShownNode, document_nodes, node_of
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.library import examples_folder

LETTERS = re.compile(r"\(([A-Z]+)\)$")  # of a model, behind its name
Source = tuple[str, str]  # a file, and the library that it is read with


@dataclass(frozen=True)
class Survey:
    """What the documents of a run contain."""

    # Titles of the nodes of each document, by its path.
    nodes: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # For each document, by title of a node, the regions that its inputs are not in.
    unreached: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    # Documents that cannot be read, each with the library that it is read with.
    unread: frozenset[Source] = frozenset()
    # As of `mxeon.conformance.results.Run`.
    refused: dict[str, tuple[str, ...]] = field(default_factory=dict)


def survey_documents(
    files: Sequence[str], libraries: Sequence[str], policy: Policy, workers: int, timeout: float
) -> Survey:
    """Read documents with each library, in worker processes unless there are none.

    A document that ends its worker has no nodes; the task that draws it says why.

    Raise MxeonError if a library cannot be used.
    """
    sources = [(file, library) for file in dict.fromkeys(files) for library in libraries]
    titles: dict[str, dict[str, set[str]]] = {file: {} for file in files}
    faults: dict[Source, tuple[str, ...]] = {}
    with closing(_answers(sources, policy, workers, timeout)) as answers:
        for (file, library), answer in zip(sources, answers, strict=True):
            if isinstance(answer, DocumentError):
                # An example that cannot be read is the library's fault.
                if not Path(file).resolve().is_relative_to(examples_folder()):
                    faults[file, library] = answer.args
            elif isinstance(answer, MxeonError):
                raise answer
            else:
                for (spec, mode), node in product(_modes(), answer or ()):
                    if _is(node, spec, mode):
                        regions = set(unreached(dict(node.values)))
                        titles[file].setdefault(spec.title, regions).intersection_update(regions)
    refused: dict[str, tuple[str, ...]] = {}
    for (file, library), lines in faults.items():
        if all((file, each) in faults for each in libraries):
            refused[file] = tuple(dict.fromkeys((*refused.get(file, ()), *lines)))
        else:  # another library can read it
            refused[f"{file} with {library}"] = tuple(f"{line} (with {library})" for line in lines)
    return Survey(
        {file: tuple(each) for file, each in titles.items()},
        {
            file: {title: tuple(sorted(each)) for title, each in found.items() if each}
            for file, found in titles.items()
        },
        frozenset(faults),
        refused,
    )


def _answers(
    sources: Sequence[Source], policy: Policy, workers: int, timeout: float
) -> Generator[tuple[ShownNode, ...] | MxeonError | None, None, None]:
    """The nodes of each document, or its error; None where reading it ended the process.

    Processes read until it is closed.
    """
    work = partial(document_nodes, policy)
    if not workers:
        yield from map(work, sources)
    elif sources:
        for outcome in pool.in_order(pool.run(work, sources, workers, timeout)):
            yield outcome.value


def _is(node: ShownNode, spec: Spec, mode: ShownNode) -> bool:
    if isinstance(spec, EmittingSurface) and spec.has_bsdf != ("bsdf" in dict(node.inputs)):
        return False
    return node.has(mode) and (node.film or not isinstance(spec, FilmSpec))


@cache
def _modes() -> tuple[tuple[Spec, ShownNode], ...]:
    """Every node that is judged, in the mode in which it is judged."""
    return tuple((row, node_of(row.document(), row.node)) for row in ALL)


def model_of(title: str) -> str:
    """Name of the model that a node has to be, by its title; its letters where it has some."""
    spec = next(row for row, _ in _modes() if row.title == title)
    own = spec.value_candidates if isinstance(spec, ValueSpec) else ()
    name = own[0].title if own else "as specified"
    letters = LETTERS.search(name)
    return letters[1] if letters else name


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
