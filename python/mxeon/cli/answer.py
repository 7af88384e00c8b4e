# SPDX-License-Identifier: Apache-2.0
"""The summary that `mxeon check` prints: materials, wrong nodes, causes, and remedies."""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from mxeon.cli.output import Line, fail, show, wrapped
from mxeon.conformance import words
from mxeon.conformance.pictures import DOCUMENT_KEY
from mxeon.conformance.results import (
    DIFFERS,
    DIRECT,
    FAILED,
    NOT_RUN,
    PASSED,
    Kind,
    Result,
    Run,
    Verdict,
    grouped,
    node_of,
)
from mxeon.conformance.results.known_issues import issues_of
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.spec import ValueSpec
from mxeon.conformance.specs import ALL
from mxeon.conformance.words import counted, listed
from mxeon.errors import LAST_OUTPUT, as_output, one_line
from mxeon.report.formats import link
from mxeon.shaders.library import eonlib_folder, kind_of
from mxeon.shaders.library_export import CLIENTS

if TYPE_CHECKING:
    from mxeon.report.diff import Report

MANY = 20  # maximum number of documents that are not grouped by cause
# Maximum lines of each section, including the header of the table of nodes.
LONGEST = {"material": 4, "node": 4, "cause": 3, "note": 2}
REASONS = 3  # maximum number of listed reasons why checks did not run
UNBOUNDED = 1e3  # larger errors are described in words
ABBREVIATION = re.compile(r"\(([A-Z]+)\)$")  # matches the end of a model's title
QUOTED_PATH = re.compile(r"'[^']*/[^']*'|\"[^\"]*\"")  # quoted paths, which differ by document
REFUSED = "refused"
NO_REFERENCE = "no reference"
# States of a document. If several states apply, the first state in this order counts.
STATES = (FAILED, NOT_RUN, REFUSED, DIFFERS, NO_REFERENCE, PASSED)
PICTURE_CHECKS = ("picture", "finite", DOCUMENT_KEY)
WHITE_CHECKS = ("environment", "layering", "transmission", "integral")  # all in a white environment


def show_run(
    run: Run,
    options: argparse.Namespace,
    printed: Collection[str] = (),
    baseline: Report | None = None,
) -> int:
    """Write a run's report, print its summary, and return the exit status.

    Errors of documents that are in `printed` are not printed again. With a baseline, changes
    instead of failures determine the status, but a refused document still counts as misuse.
    """
    from mxeon import report
    from mxeon.report import diff

    page = report.write(run, options.report) if options.report else None
    status, content = run.exit_status, report.to_json(run) if baseline or options.json else ""
    changes: tuple[diff.Change, ...] = ()
    if baseline:
        changes = diff.compare(baseline, diff.read_report(json.loads(content)))
        status = status if run.refused else diff.status(changes)
    if options.json:
        if baseline:
            both = json.loads(content) | {"changes": diff.to_json(changes)}
            content = json.dumps(both, indent=1)
        print(as_output(content))
    else:
        details = _details(run) if options.full else ()
        print(wrapped([*details, *answer(run, options.full)]))
        if page:
            show(f"report: {page}")
        if baseline:
            print(wrapped(map(Line, ("compared with the baseline:", *diff.lines(changes)))))
    if getattr(options, "annotations", False):
        lines = diff.annotations(changes) if baseline else _annotations(run)
        print("\n".join(lines), file=sys.stderr if options.json else sys.stdout)
    return fail(status, *(each for each in run.errors if each not in printed))


def _annotations(run: Run) -> Iterator[str]:
    """GitHub annotations for failures, grouped by cause, and for checks that did not run."""
    for line in _failures(replace(run, results=run.judged, compared=())):
        yield words.annotation("error", "mxeon check", line)
    for line in _not_run(run, True, True):
        yield words.annotation("warning", "mxeon check", line)


def _details(run: Run) -> Iterator[Line]:
    """A line for each file of each library folder, and a line for each result of a check."""
    for folder, origins in run.libraries.items():
        for origin, names in origins.items():
            for name in names or ["nothing"]:
                yield _line(f"library {folder}: {origin}: {name}")
    for each in run.results:
        numbers = each.reason or words.explanation(each)
        if each.verdict == PASSED:
            error, tolerance = each.error or 0.0, each.tolerance or 0.0
            numbers = f"{error:.3g} <= {tolerance:.3g} {each.unit}" if tolerance else ""
        about = f"{each.verdict}: {each.location}, {each.check}, {each.subject}"
        yield _line(f"{about}: {numbers}".rstrip(": "), each.verdict)


def _line(text: str, verdict: Verdict | None = None) -> Line:
    return Line(one_line(text), verdict)


def answer(run: Run, full: bool = False) -> list[Line]:
    """Lines of the summary. Each section has a maximum length, unless `full` is true."""
    many = len(run.contents) + len(run.refused) > MANY
    sections = {
        "material": [*map(Line, summary_by_cause(run))] if many else [*_materials(run)],
        "node": [] if many else [*map(Line, _nodes(run))],
        "cause": [*_failures(run)],
        "note": [_line(f"note: {note}") for note in run.notes],
    }
    lines = [*_not_run(run, full, many)]
    lines += map(_line, (*words.origins(run), *words.not_judged(run)))
    omitted = []
    for name, section in sections.items():
        # If there are several documents, each document has a line.
        complete = full or (name == "material" and len(run.contents) != 1)
        lines += section if complete else section[: LONGEST[name]]
        if not complete and len(section) > LONGEST[name]:
            omitted.append(counted(len(section) - LONGEST[name], f"more {name}"))
    # The verdict comes first if there are no documents, or if something was not judged.
    first = run.refused or run.verdict == NOT_RUN or not run.contents
    lines.insert(0 if first else len(lines), _line(run.summary, run.verdict))
    if omitted:
        lines.append(Line(f"{', '.join(omitted)}: --full"))
    return [*lines, *map(_line, _remedy(run))]


class DocumentState(NamedTuple):
    document: str  # path
    library: str
    state: str  # one of STATES
    cause: str  # equal text for all documents with the same cause
    referenced: bool = False  # whether all pictures have a reference


def summary_by_cause(run: Run) -> list[str]:
    """A line for each cause, worst first, with the number of documents and the first document."""
    states = [*_document_states(run)]
    documents = {each.document for each in states}
    referenced = len(documents - {each.document for each in states if not each.referenced})
    several = len({each.library for each in states if each.library}) > 1
    groups = grouped(states, lambda each: (each.library, each.state, each.cause))

    def order(group: tuple[str, str, str]) -> tuple[object, ...]:
        library, state, _ = group
        return library in run.compared, library, STATES.index(state), -len(groups[group])

    lines = [
        f"{counted(len(documents), 'document')}, {referenced} with reference pictures throughout"
    ]
    for library, state, cause in sorted(groups, key=order):
        first, *others = groups[library, state, cause]
        place = f" with {library}" if library and several else ""
        more = f" and {len(others)} more" if others else ""
        line = one_line(f"{state}{place}: {cause} ({first.document}{more})")
        lines.append(f"  {1 + len(others):4} {line}")
    return lines


def _document_states(run: Run) -> Iterator[DocumentState]:
    """The state of each document's worst picture on each host with each library."""
    for document in run.contents:
        pictures = (
            each
            for each in run.results
            if _is_picture(each, document) and not _is_refused(run, document, each.library)
        )
        groups = grouped(pictures, lambda each: (each.host, each.library))
        for (_, library), results in groups.items():
            worst = min(
                results, key=lambda each: (STATES.index(each.verdict), each.check != "finite")
            )
            finite = worst.check == "finite" and worst.verdict == PASSED
            yield DocumentState(
                document,
                library,
                NO_REFERENCE if finite else worst.verdict,
                _cause(worst, any(each.measured for each in results)),
                all(each.check == "picture" and each.error is not None for each in results),
            )
    for each in run.refused:
        document, (fault, *others) = each.document, each.faults
        more = f"; {counted(len(others), 'more fault')}" if others else ""
        cause = QUOTED_PATH.sub("...", fault.removeprefix(f"{document}: ") + more)
        yield DocumentState(document, "", REFUSED, cause)


def _cause(result: Result, measured: bool) -> str:
    """The reason for a document's state, derived from the document's worst picture."""
    if result.verdict == PASSED and result.check == "picture":
        inputs = ", with inputs that the host computed" if measured else ""
        return f"matches the reference{inputs}"
    if result.verdict == PASSED and result.check == DOCUMENT_KEY:
        return "shaders are generated"
    # Omit the size of the difference, so that documents with the same cause share a line.
    if result.difference and result.diagnosis.first.key in ("", "other_node"):
        return words.appearance(result.difference)
    reason = result.reason or words.diagnosis(result.diagnosis)
    reason = reason.split(LAST_OUTPUT)[0].removeprefix("reference: ")
    return QUOTED_PATH.sub("...", reason) or words.excess(result)


def _is_refused(run: Run, document: str, library: str) -> bool:
    """Whether a document was refused with a library, or with every library if `library` is ""."""
    return any(each.concerns(document, library) for each in run.refused)


def _materials(run: Run) -> Iterator[Line]:
    """Sentences about materials, worst first. Materials with the same look share a sentence."""
    hosts = {each.host for each in run.results if _shows_a_document(each)}
    # Name, sentence, rank and verdict of each material on each host.
    rows: list[tuple[str, str, int, Verdict | None]] = []
    same_name = Counter(Path(each).name for each in run.contents)
    for document in run.contents:
        if _is_refused(run, document, ""):
            continue
        pictures = (each for each in run.results if _is_picture(each, document))
        materials = grouped(pictures, lambda each: (each.element, each.host))
        if not materials:
            rows.append((document, "not rendered on this host", len(STATES), None))
        for (element, host), results in materials.items():
            title = document if same_name[Path(document).name] > 1 else Path(document).name
            names = [element or title] if len(run.contents) == 1 else [title, element]
            name = ": ".join(filter(None, names))
            place = f" on {host}" if len(hosts) > 1 else ""
            rank = min(STATES.index(each.verdict) for each in results)
            judged = [each.verdict for each in results if each.library not in run.compared]
            verdict = min(judged, key=STATES.index, default=None)
            rows.append((f"{name}{place}", _appearance(run, document, results), rank, verdict))
    groups = grouped(rows, lambda row: row[1])
    for sentence, group in sorted(groups.items(), key=lambda item: item[1][-1][2]):
        *_, verdict = group[-1]
        yield _line(f"{', '.join(name for name, *_ in group)}: {sentence}.", verdict)


def _appearance(run: Run, document: str, results: Sequence[Result]) -> str:
    """Text on how a material looks on one host with each library."""
    looks = [(_look(run, document, each), each.library) for each in results]
    rendered = {each.library for each in results}
    for library in _unique([*(each.library for each in run.results), *run.compared]):
        refused = _is_refused(run, document, library)
        if library not in rendered and (refused or library in run.compared):
            looks.append((REFUSED if refused else "not judged", library))
    stock = " ".join(filter(None, ("stock", "MaterialX", run.software.get("MaterialX"))))
    libraries = {
        look: " and ".join(stock if library == "stock" else library for _, library in group)
        for look, group in grouped(looks, lambda each: each[0]).items()
    }
    right = libraries.pop(words.AS_SPECIFIED, "")
    parts = [f"{words.AS_SPECIFIED} with {right}"] if right else []
    parts += [f"with {names}, {look}" for look, names in libraries.items()]
    if measured := [name for each in results for name in each.measured]:
        parts.append(words.unchecked(measured))
    return "; ".join(parts)


def _look(run: Run, document: str, result: Result) -> str:
    """Text on a material in one picture. A picture can be right although a node is wrong."""
    unused = [
        run.is_elsewhere(each, document)
        for each in run.results
        if each.verdict == FAILED and each.location == result.location
        if each.subject in run.contents[document]
    ]
    if not (unused and _is_right(result)):
        return words.look(result)
    inputs = "inputs that this material does not use" if all(unused) else "other inputs"
    return f"the picture is right; the material's nodes are wrong for {inputs}"


def _is_visible(result: Result) -> bool:
    """Whether a material differs visibly from the reference."""
    return bool(result.difference and result.difference.is_visible)


def _is_right(result: Result) -> bool:
    """Whether a picture was compared with a reference and has no visible difference."""
    return result.check == "picture" and result.verdict == PASSED and not _is_visible(result)


def _shows_a_document(result: Result) -> bool:
    """Whether a result is about a document; a node also has a check called `finite`."""
    return result.check in PICTURE_CHECKS and bool(result.document)


def _is_picture(result: Result, document: str) -> bool:
    return result.document == str(Path(document))


WRONG, ELSEWHERE, RIGHT = range(3)


def _rank(run: Run, result: Result) -> int:
    """Rank of a node: wrong in a document, wrong for inputs that no document uses, or right."""
    if result.verdict != FAILED:
        return RIGHT
    if run.is_elsewhere(result):
        return ELSEWHERE
    right = [
        _is_right(each)
        for document, titles in run.contents.items()
        if result.subject in titles
        for each in run.results
        if each.check == "picture" and each.location == result.location
        if _is_picture(each, document)
    ]
    return ELSEWHERE if right and all(right) else WRONG


def _nodes(run: Run) -> list[str]:
    """Lines of the table of the documents' nodes, worst first, with a column for each library."""
    titles = {title for titles in run.contents.values() for title in titles}
    judged = (each for each in run.results if each.subject in titles and each.verdict != NOT_RUN)
    rows = grouped(judged, lambda each: (each.subject, each.host))
    if not rows:
        return []
    order = sorted(rows, key=lambda row: min(_rank(run, each) for each in rows[row]))
    hosts = _unique(host for _, host in order)
    libraries = _unique(each.library for row in order for each in rows[row])
    table = [[f"nodes on {', '.join(hosts)}, largest error", *libraries]]
    for title, host in order:
        cells = grouped(rows[title, host], lambda each: each.library)
        name = title if len(hosts) == 1 else f"{title} on {host}"
        table.append([name, *(_cell(run, cells.get(library, [])) for library in libraries)])
    table = [list(map(one_line, row)) for row in table]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [f"  {'  '.join(map(str.ljust, row, widths))}".rstrip() for row in table]


def _cell(run: Run, results: Sequence[Result]) -> str:
    """Text of a table cell: the model of a node, or an error and the check that found the error."""
    if not results:
        return "not judged"
    rank = min(_rank(run, each) for each in results)
    wrong = [each for each in results if rank != RIGHT and _rank(run, each) == rank]
    direct = [each for each in results if each.check in DIRECT]
    # The error in direct light is the most informative, so this error is preferred.
    shown = max(
        wrong or direct or results,
        key=lambda each: (each.check in DIRECT, (each.error or 0.0) / (each.tolerance or 1.0)),
    )
    text = {WRONG: "wrong", ELSEWHERE: "wrong for other inputs"}.get(rank, model_of(shown.subject))
    check = "" if rank == RIGHT else f" ({shown.check})"
    if rank == RIGHT and any(each.verdict == DIFFERS for each in results):
        text += ", allowed difference"
    if shown.error is None:
        return text
    if not shown.tolerance:
        return f"{text}: {words.excess(shown)}{check}" if check else text
    if shown.error > UNBOUNDED and shown.quantity is not Quantity.KIT:
        return f"{text}, unbounded ({shown.check})"
    return f"{text}, {shown.error:.2g}{check}"


def model_of(title: str) -> str:
    """The model that the node `title` must have, abbreviated if possible."""
    spec = next(row for row in ALL if row.title == title)
    models = spec.value_candidates if isinstance(spec, ValueSpec) else ()
    name = models[0].title if models else "as specified"
    abbreviation = ABBREVIATION.search(name)
    return abbreviation[1] if abbreviation else name


def _not_run(run: Run, full: bool, pictures: bool) -> Iterator[Line]:
    """Reasons why checks did not run. With `full`, all reasons are listed.

    Without `pictures`, checks of documents' pictures are left out.
    """
    documents = [each for each in run.contents if not (pictures or _is_refused(run, each, ""))]
    not_run = (
        each
        for each in run.results
        if each.verdict == NOT_RUN and not each.follows
        if not any(_is_picture(each, document) for document in documents)
    )
    reasons = grouped(not_run, lambda each: each.reason)
    shown = len(reasons) if full else REASONS
    for reason, results in [*reasons.items()][:shown]:
        places = listed(_unique(each.location for each in results))
        yield _line(f"not run: {places}, {counted(len(results), 'check')}: {reason}", NOT_RUN)
    if len(reasons) > shown:
        others = counted(len(reasons) - shown, "other reason")
        yield Line(f"not run for {others}; --full", NOT_RUN)


def _remedy(run: Run) -> Iterator[str]:
    """The remedy for the documents, if known: correct an input, load eonlib, or do nothing."""
    if not run.contents:
        return
    pictures = [each for each in run.results if _shows_a_document(each)]
    causes = [each.diagnosis.first for each in pictures]
    if inputs := _unique(f'input "{c.names[0]}"' for c in causes if c.kind is Kind.INPUT):
        yield f"To fix it, correct {listed(inputs)}"
        return
    compared = {
        each.library for each in pictures if each.check == "picture" and each.error is not None
    }
    failed = [each for each in run.results if each.verdict == FAILED]
    wrong = {each.library for each in pictures if _is_visible(each)} | {
        each.library
        for each in failed
        if _shows_a_document(each) or (each.library not in compared and not run.is_elsewhere(each))
    }
    libraries = {each.library for each in run.results}
    # eonlib has none of the defects that have a page in docs/upstream, except unavoidable defects.
    nodes = [issues_of(each) for each in failed if not _shows_a_document(each)]
    known = all(issues and not any(each.unavoidable for each in issues) for issues in nodes)
    if "stock" in wrong and (
        "eonlib" in libraries - wrong or (known and "eonlib" not in libraries)
    ):
        yield (
            f"To fix it, load {eonlib_folder()} before MaterialX's own libraries; `mxeon library` "
            f"prints the line for {', '.join(CLIENTS)}"
        )
    elif wrong and "eonlib" not in libraries | {kind_of(each) for each in run.libraries}:
        yield "To find out whether eonlib fixes it, check with --library eonlib"
    elif wrong or run.refused or not pictures:
        return
    elif all(each.check == "picture" and each.verdict == PASSED for each in pictures):
        several = len({each.subject for each in pictures}) > 1
        yield f"Nothing to do for {'these materials' if several else 'this material'}"


def _failures(run: Run) -> Iterator[Line]:
    """A line for each page or diagnosis that explains failures.

    Five questions sort the failures, and "no" comes first: is the library only compared, are the
    inputs used by no document, does a page exist, did only the negative control fail the check, is
    the light another than in wrong pictures?
    """
    failures = [each for each in run.results if each.verdict == FAILED]
    white = any(each.difference and each.difference.scene == "furnace" for each in failures)

    def order(result: Result) -> tuple[bool, bool, bool, bool, bool, float]:
        lit = result.check in (WHITE_CHECKS if white else DIRECT)
        # Errors of albedos and throughputs have a common scale, so the largest error comes first.
        size = (result.error or 0.0) if white and lit else 0.0
        known = run.is_elsewhere(result), bool(result.pages), result.within
        return result.library in run.compared, *known, not lit, -size

    def place(result: Result) -> tuple[str, bool]:
        return result.location, run.is_elsewhere(result)

    def line(results: Sequence[Result], text: str) -> Line:
        """A line about failures with one host and library, colored if the library is judged."""
        location, elsewhere = place(results[0])
        inputs = ", for inputs that no document uses" if elsewhere else ""
        if results[0].library in run.compared:
            return _line(f"cause: {location}{inputs}: {text}")
        return _line(f"failed: {location}{inputs}: {text}", FAILED)

    nodes = {(each.location, node_of(each.subject)) for each in failures}
    explained = []  # pictures that failing nodes explain
    groups = grouped(
        sorted(failures, key=order),
        lambda each: (place(each), each.pages or words.explanation(each)),
    )
    for results in groups.values():
        if pictures := [each for each in results if nodes & _lobes(each)]:
            explained += pictures
        else:
            yield line(results, _sentence(results))
    if run.contents:  # the sentences on materials already cover pictures
        return
    for results in grouped(explained, place).values():
        names = _unique(name for each in results for _, name in sorted(nodes & _lobes(each)))
        subjects = listed([each.subject for each in results])
        yield line(results, f"{counted(len(results), 'picture')} of {listed(names)}: {subjects}")


def _lobes(result: Result) -> set[tuple[str, str]]:
    """Lobes that explain a failing picture, each with the result's host and library."""
    causes = (each for each in result.diagnosis.causes if each.kind is Kind.FOLLOWS)
    return {(result.location, name) for cause in causes for name in cause.names}


def _sentence(results: Sequence[Result]) -> str:
    """Text with the nodes and checks that fail for one reason, and with the reason or a link."""
    subjects = _unique(each.subject for each in results)
    nodes = _unique(map(node_of, subjects))
    checks = ", ".join(_unique(each.check for each in results))
    reasons = [f"{issue.title}: {link(issue)}" for issue in issues_of(results[0])]
    reason = "; ".join(reasons) or words.explanation(results[0])
    return f"{subjects[0] if len(subjects) == 1 else listed(nodes)} ({checks}): {reason}"


def _unique(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
