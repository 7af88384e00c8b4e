# SPDX-License-Identifier: Apache-2.0
"""The summary that `mxeon check` prints: materials, wrong nodes, causes, and remedies."""

from __future__ import annotations

import argparse
import json
import re
import sys
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
)
from mxeon.conformance.results.known_issues import issues_of
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.spec import ValueSpec
from mxeon.conformance.specs import ALL
from mxeon.conformance.words import counted, listed
from mxeon.errors import as_output, one_line
from mxeon.report.formats import link
from mxeon.shaders.library import eonlib_folder, kind_of
from mxeon.shaders.library_export import CLIENTS

if TYPE_CHECKING:
    from mxeon.report.diff import Report

MANY = 20  # maximum documents before they are grouped by cause
# Maximum lines of each section, including the header of the table of nodes.
LONGEST = {"material": 4, "node": 4, "cause": 3, "note": 2}
REASONS = 3  # maximum reasons why checks did not run
UNBOUNDED = 1e3  # larger errors are described in words
LETTERS = re.compile(r"\(([A-Z]+)\)$")  # abbreviation at the end of a model's title
REFUSED = "refused"
NO_REFERENCE = "no reference"
# States of a document. If several apply, the first one counts.
STATES = (FAILED, NOT_RUN, REFUSED, DIFFERS, NO_REFERENCE, PASSED)
QUOTED = re.compile(r"'[^']*/[^']*'|\"[^\"]*\"")  # matches a document's own names in a reason
KEYS = ("picture", "finite", DOCUMENT_KEY)
INDIRECT = ("environment", "layering", "transmission", "integral")  # checks in a white environment


def show_run(
    run: Run,
    options: argparse.Namespace,
    said: Collection[str] = (),
    baseline: Report | None = None,
) -> int:
    """Write a run's report, print its summary, and return the exit status.

    Document errors in `said` were already printed. With a baseline, changes determine the status,
    not failures; a refused document still counts as misuse.
    """
    from mxeon import report
    from mxeon.report import diff

    page = report.write(run, options.report) if options.report else None
    status, content = run.exit_status, report.to_json(run) if baseline or options.json else ""
    changes: tuple[diff.Change, ...] = ()
    if baseline:
        changes = diff.compare(baseline, diff.read_report(json.loads(content)))
        status = status if run.refused else diff.status(changes)
    if options.json and baseline:
        both = json.loads(content) | {"changes": diff.to_json(changes)}
        print(as_output(json.dumps(both, indent=1)))
    elif options.json:
        print(as_output(content))
    else:
        files = [
            one_line(f"library {folder}: {origin}: {name}")
            for folder, origins in run.libraries.items()
            for origin, names in origins.items()
            for name in names or ["nothing"]
        ]
        checks = [*map(_line, run.results), *files] if options.full else []
        print(wrapped([*checks, *answer(run, options.full)]))
        if page:
            show(f"report: {page}")
        if baseline:
            print(wrapped(["compared with the baseline:", *diff.lines(changes)]))
    if getattr(options, "annotations", False):
        lines = diff.annotations(changes) if baseline else _annotations(run)
        print("\n".join(lines), file=sys.stderr if options.json else sys.stdout)
    return fail(status, *(each for each in run.errors if each not in said))


def _annotations(run: Run) -> Iterator[str]:
    """GitHub annotations for failures, grouped by cause, and for checks that did not run."""
    for line in _failures(replace(run, results=run.judged, compared=())):
        yield words.annotation("error", "mxeon check", one_line(line))
    for reason in _not_run(run, True, []):
        yield words.annotation("warning", "mxeon check", one_line(reason))


def _line(result: Result) -> str:
    """A line on a check: its error and tolerance, or the reason why it did not pass."""
    numbers = result.reason or words.explanation(result)
    if result.verdict == PASSED:
        error, tolerance = result.error or 0.0, result.tolerance or 0.0
        numbers = f"{error:.3g} <= {tolerance:.3g} {result.unit}" if tolerance else ""
    about = f"{result.verdict}: {result.location}, {result.check}, {result.subject}"
    return Line.of(one_line(f"{about}: {numbers}".rstrip(": ")), result.verdict)


def answer(run: Run, full: bool = False) -> list[str]:
    """Lines of the summary. Unless it is `full`, each section has a maximum length."""
    many = len(run.contents) + len(run.refused) > MANY
    looks: list[str] = summary_by_cause(run) if many else list(_looks(run))
    idle = _not_run(run, full, [] if many else looks)
    lines: list[str] = [Line.of(one_line(each), NOT_RUN) for each in idle]
    lines += map(one_line, (*words.origins(run), *words.not_judged(run)))
    nodes = [] if many else _table(run, _rows(run))
    causes = [Line.of(one_line(each), each.verdict) for each in _failures(run)]
    notes = [one_line(f"note: {note}") for note in run.notes]
    more = []
    for name, section in (("material", looks), ("node", nodes), ("cause", causes), ("note", notes)):
        # If there are several documents, each has a line.
        whole = full or (name == "material" and len(run.contents) != 1)
        most = len(section) if whole else LONGEST[name]
        lines += section[:most]
        if cut := len(section[most:]):
            more.append(counted(cut, f"more {name}"))
    # Begin with the verdict if there are no documents, or something was not judged.
    begins = run.refused or run.verdict == NOT_RUN or not run.contents
    summary = Line.of(one_line(run.summary), run.verdict)
    lines.insert(0 if begins else len(lines), summary)
    if more:
        lines.append(f"{', '.join(more)}: --full")
    return [*lines, *map(one_line, _remedy(run))]


class DocumentVerdict(NamedTuple):
    document: str  # path
    library: str
    verdict: str  # one of STATES
    cause: str  # same wording for all documents
    referenced: bool  # whether all pictures have a reference


def summary_by_cause(run: Run) -> list[str]:
    """A line for each cause, worst first, with the number of documents and the first document."""
    verdicts = [*_document_verdicts(run)]
    for document, faults in run.refused.items():
        name = (
            document if faults[0].startswith(f"{document}: ") else document.rpartition(" with ")[0]
        )
        reason = faults[0].removeprefix(f"{name}: ")
        reason += f"; {counted(len(faults) - 1, 'more fault')}" if len(faults) > 1 else ""
        cause = QUOTED.sub("...", reason)
        verdicts.append(DocumentVerdict(document, "", REFUSED, cause, False))
    every = {each.document for each in verdicts}
    referenced = len(every - {each.document for each in verdicts if not each.referenced})
    lines = [f"{counted(len(every), 'document')}, {referenced} with reference pictures throughout"]
    libraries = sorted(
        {each.library for each in verdicts}, key=lambda each: (each in run.compared, each)
    )
    for library in libraries:
        place = f" with {library}" if library and len(set(libraries) - {""}) > 1 else ""
        groups: dict[tuple[str, str], list[str]] = {}
        for each in verdicts:
            if each.library == library:
                groups.setdefault((each.verdict, each.cause), []).append(each.document)
        for key in sorted(groups, key=lambda key: (STATES.index(key[0]), -len(groups[key]))):
            (verdict, cause), (first, *others) = key, groups[key]
            more = f" and {len(others)} more" if others else ""
            line = one_line(f"{verdict}{place}: {cause} ({first}{more})")
            lines.append(f"  {1 + len(others):4} {line}")
    return lines


def _document_verdicts(run: Run) -> Iterator[DocumentVerdict]:
    """Verdicts by document, host and library; the worst result of the pictures counts."""
    for document in run.contents:
        groups: dict[tuple[str, str], list[Result]] = {}
        for each in run.results:
            if _is_picture(each, document) and not is_refused(run, document, each.library):
                groups.setdefault((each.host, each.library), []).append(each)
        for (_, library), results in groups.items():
            worst = min(
                results, key=lambda each: (STATES.index(each.verdict), each.check != "finite")
            )
            finite = worst.check == "finite" and worst.verdict == PASSED
            yield DocumentVerdict(
                document,
                library,
                NO_REFERENCE if finite else worst.verdict,
                _cause(worst, any(each.measured for each in results)),
                all(each.check == "picture" and each.error is not None for each in results),
            )


def _cause(result: Result, measured: bool) -> str:
    """Reason for a document's verdict, from the result that decides it."""
    if result.verdict == PASSED and result.check == "picture":
        return f"matches the reference{', with inputs that the host computed' * measured}"
    if result.verdict == PASSED and result.check == DOCUMENT_KEY:
        return "shaders are generated"
    # Leave out the size of the difference, so that documents with the same cause share a line.
    if result.difference and result.diagnosis.first.key in ("", "other_node"):
        return words.appearance(result.difference)
    reason = result.reason or words.diagnosis(result.diagnosis)
    reason = reason.split("; last output:")[0].removeprefix("reference: ")
    return QUOTED.sub("...", reason) or words.excess(result)


def is_refused(run: Run, document: str, library: str) -> bool:
    """Whether a document was refused, alone or with this library."""
    return not run.refused.keys().isdisjoint((document, f"{document} with {library}"))


def _looks(run: Run) -> Iterator[Line]:
    """Sentences on materials, worst first; materials that look the same share a sentence."""
    hosts = {each.host for each in run.results if each.check in KEYS}
    alike: dict[str, list[str]] = {}
    ranks: dict[str, int] = {}
    tones: dict[str, Verdict | None] = {}
    for document in run.contents:
        if document in run.refused:
            continue
        found: dict[tuple[str, str], list[Result]] = {}
        for each in run.results:
            if _is_picture(each, document):
                found.setdefault((each.subject, each.host), []).append(each)
        if not found:
            alike.setdefault("not rendered on this host", []).append(document)
        for (subject, host), results in found.items():
            element = subject.removeprefix(f"{Path(document).name}: ")
            name = element if len(run.contents) == 1 else subject
            place = f" on {host}" if len(hosts) > 1 else ""
            sentence = _look(run, document, results)
            alike.setdefault(sentence, []).append(f"{name}{place}")
            ranks[sentence] = min(STATES.index(each.verdict) for each in results)
            own = [each.verdict for each in results if each.library not in run.compared]
            tones[sentence] = min(own, key=STATES.index, default=None)
    for sentence, names in sorted(alike.items(), key=lambda each: ranks.get(each[0], len(STATES))):
        yield Line.of(one_line(f"{', '.join(names)}: {sentence}."), tones.get(sentence))


def _look(run: Run, document: str, results: Sequence[Result]) -> str:
    """Appearance of a material on one host with each library."""
    looks: dict[str, list[str]] = {}
    for each in results:
        looks.setdefault(_appearance(run, document, each), []).append(_title(run, each.library))
    drawn = {each.library for each in results}
    for library in _unique([*(each.library for each in run.results), *run.compared]):
        refused = is_refused(run, document, library)
        if library not in drawn and (refused or library in run.compared):
            looks.setdefault(REFUSED if refused else "not judged", []).append(_title(run, library))
    right = looks.pop(words.AS_SPECIFIED, [])
    parts = [f"{words.AS_SPECIFIED} with {' and '.join(right)}"] * bool(right)
    parts += [f"with {' and '.join(names)}, {each}" for each, names in looks.items()]
    if measured := [name for each in results for name in each.measured]:
        parts.append(words.unchecked(measured))
    return "; ".join(parts)


def _appearance(run: Run, document: str, result: Result) -> str:
    look = words.look(result)
    wrong = [
        run.is_elsewhere(each, document)
        for each in run.results
        if each.verdict == FAILED and (each.host, each.library) == (result.host, result.library)
        if each.subject in run.contents[document]
    ]
    if wrong and look == words.AS_SPECIFIED:
        other = " for inputs that this material does not use" * all(wrong)
        return f"the picture is right; its nodes are wrong{other}"
    return look


def _is_seen(result: Result) -> bool:
    """Whether a material differs visibly from the reference."""
    return bool(result.difference and result.difference.is_visible)


def _title(run: Run, library: str) -> str:
    name = (
        f"stock MaterialX {run.software['MaterialX']}" if "MaterialX" in run.software else "stock"
    )
    return name if library == "stock" else library


def _is_picture(result: Result, document: str) -> bool:
    name = Path(document).name
    return result.check in KEYS and result.subject.split(": ")[0] in (name, document)


WRONG, ELSEWHERE, RIGHT = range(3)
Rows = dict[tuple[str, str], list[Result]]  # keys: node and host


def _rows(run: Run) -> Rows:
    """Results by node; failures at the documents' own inputs come first, passed ones last."""
    nodes = {title for titles in run.contents.values() for title in titles}
    rows: Rows = {}
    for each in run.results:
        if each.subject in nodes and each.verdict != NOT_RUN:
            rows.setdefault((each.subject, each.host), []).append(each)
    ranks = {place: min(_rank(run, each) for each in row) for place, row in rows.items()}
    return {place: rows[place] for place in sorted(rows, key=lambda place: ranks[place])}


def _rank(run: Run, result: Result) -> int:
    """Rank of a node: wrong in a document, wrong only for inputs that no document uses, right."""
    if result.verdict != FAILED:
        return RIGHT
    if run.is_elsewhere(result):
        return ELSEWHERE
    place = result.host, result.library
    right = [
        each.verdict == PASSED and not _is_seen(each)
        for document, titles in run.contents.items()
        if result.subject in titles
        for each in run.results
        if each.check == "picture"
        and (each.host, each.library) == place
        and _is_picture(each, document)
    ]
    return ELSEWHERE if right and all(right) else WRONG


def _table(run: Run, rows: Rows) -> list[str]:
    """The table of nodes: a header, a line per node, and a column per library."""
    if not rows:
        return []
    hosts = _unique(host for _, host in rows)
    libraries = _unique(each.library for row in rows.values() for each in row)
    table = [[f"nodes on {', '.join(hosts)}, largest error", *libraries]]
    for (title, host), row in rows.items():
        cells = [_cell(run, [each for each in row if each.library == name]) for name in libraries]
        table.append([title if len(hosts) == 1 else f"{title} on {host}", *cells])
    table = [list(map(one_line, row)) for row in table]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    rows_of_cells = (map(str.ljust, line, widths) for line in table)
    return [f"  {'  '.join(cells)}".rstrip() for cells in rows_of_cells]


def _cell(run: Run, results: Sequence[Result]) -> str:
    """Text of a table cell: a node's model, or its error and the check that measured it."""
    if not results:
        return "not judged"
    rank = min(_rank(run, each) for each in results)
    chosen = [each for each in results if _rank(run, each) == rank and rank != RIGHT]
    direct = [each for each in results if each.check in DIRECT]
    # Prefer the error in direct light, which is the most informative.
    shown = max(
        chosen or direct or results,
        key=lambda each: (each in direct, (each.error or 0.0) / (each.tolerance or 1.0)),
    )
    cell = {WRONG: "wrong", ELSEWHERE: "wrong for other inputs"}.get(rank, model_of(shown.subject))
    if rank == RIGHT and any(each.verdict == DIFFERS for each in results):
        cell += ", differs as allowed"
    if shown.error is None:
        return cell
    if not shown.tolerance:
        return f"{cell}: {words.excess(shown)} ({shown.check})" if rank != RIGHT else cell
    if shown.error > UNBOUNDED and shown.quantity is not Quantity.KIT:
        return f"{cell}, unbounded ({shown.check})"
    return f"{cell}, {shown.error:.2g}" + f" ({shown.check})" * (rank != RIGHT)


def model_of(title: str) -> str:
    """Title of the model that a node must have, or its abbreviation; `title` is the node's."""
    spec = next(row for row in ALL if row.title == title)
    own = spec.value_candidates if isinstance(spec, ValueSpec) else ()
    name = own[0].title if own else "as specified"
    letters = LETTERS.search(name)
    return letters[1] if letters else name


def _not_run(run: Run, full: bool, looks: Sequence[str]) -> Iterator[str]:
    """Reasons why checks did not run (all if `full`), except those in a material's sentence."""
    reasons: dict[str, list[Result]] = {}
    for each in run.results:
        said = each.check in KEYS and any(one_line(each.reason) in look for look in looks)
        if each.verdict == NOT_RUN and not each.follows and not said:
            reasons.setdefault(each.reason, []).append(each)
    shown = len(reasons) if full else REASONS
    for reason, results in list(reasons.items())[:shown]:
        where = listed(_unique(each.location for each in results))
        yield f"not run: {where}, {counted(len(results), 'check')}: {reason}"
    if len(reasons) > shown:
        yield f"not run for {counted(len(reasons) - shown, 'other reason')}; --full"


def _remedy(run: Run) -> Iterator[str]:
    """The remedy for the documents, if known: correct an input, load eonlib, or do nothing."""
    shown = [each for each in run.results if each.check in KEYS]
    if not run.contents:
        return
    own = (each.diagnosis.first for each in shown)
    if inputs := _unique(f'input "{c.names[0]}"' for c in own if c.kind is Kind.INPUT):
        yield f"To fix it, correct {listed(inputs)}"
        return
    judged = {each.library for each in shown if each.check == "picture" and each.error is not None}
    failed = [each for each in run.results if each.verdict == FAILED]
    wrong = {
        each.library
        for each in failed
        if each.check in KEYS or (each.library not in judged and not run.is_elsewhere(each))
    } | {each.library for each in shown if _is_seen(each)}
    libraries = {each.library for each in run.results}
    # eonlib does not have the defects that have a page.
    nodes = [issues_of(each) for each in failed if each.check not in KEYS]
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
    elif (
        shown
        and not wrong
        and not run.refused
        and all(each.check == "picture" and each.verdict == PASSED for each in shown)
    ):
        several = len({each.subject for each in shown}) > 1
        yield f"Nothing to do for {'these materials' if several else 'this material'}"


def _failures(run: Run) -> Iterator[Line]:
    """A line for each page or diagnosis that explains failures.

    Compared libraries come last. Otherwise the order is: failures at the documents' own inputs,
    failures without a page, failures in the light in which the first picture is most wrong.
    """
    groups: dict[tuple[str, str], list[Result]] = {}
    failures = [each for each in run.results if each.verdict == FAILED]
    white = any(each.difference and each.difference.scene == "furnace" for each in failures)

    def order(result: Result) -> tuple[bool, bool, bool, bool, float]:
        lit = result.check in (INDIRECT if white else DIRECT)
        # Errors of albedos and throughputs have a common scale.
        size = (result.error or 0.0) if white and lit else 0.0
        known = run.is_elsewhere(result), bool(result.pages)
        return result.library in run.compared, *known, not lit, -size

    for each in sorted(failures, key=order):
        kind = "cause" if each.library in run.compared else "failed"
        other = ", for inputs that no document uses" * run.is_elsewhere(each)
        place = f"{kind}: {each.location}{other}"
        groups.setdefault((place, " ".join(each.pages) or words.explanation(each)), []).append(each)
    # Group pictures that failing nodes explain. For documents, other sentences cover pictures.
    nodes = {(each.location, each.subject.partition(",")[0]) for each in failures}
    shown: dict[str, list[Result]] = {}
    for (place, _), results in groups.items():
        if explained := [each for each in results if nodes & _lobes(each)]:
            shown.setdefault(place, []).extend(explained)
        else:
            yield Line.of(f"{place}: {_sentence(results)}", _tone(run, results))
    for place, results in shown.items() if not run.contents else ():
        names = _unique(name for each in results for _, name in sorted(nodes & _lobes(each)))
        subjects = listed([each.subject for each in results])
        pictures = f"{place}: {counted(len(results), 'picture')} of {listed(names)}: {subjects}"
        yield Line.of(pictures, _tone(run, results))


def _tone(run: Run, results: Iterable[Result]) -> Verdict | None:
    """The verdict of failures; None if all are of libraries that are judged for comparison."""
    return None if all(each.library in run.compared for each in results) else FAILED


def _lobes(result: Result) -> set[tuple[str, str]]:
    """Lobes that explain a failing picture, each with the result's host and library."""
    causes = (each for each in result.diagnosis.causes if each.kind is Kind.FOLLOWS)
    return {(result.location, name) for cause in causes for name in cause.names}


def _sentence(results: Sequence[Result]) -> str:
    """A sentence on the nodes and checks that fail for the same reason, with the reason's page."""
    subjects = list(dict.fromkeys(each.subject for each in results))
    nodes = _unique(each.partition(",")[0] for each in subjects)
    keys = ", ".join(_unique(each.check for each in results))
    about = f"{subjects[0] if len(subjects) == 1 else listed(nodes)} ({keys})"
    if issues := issues_of(results[0]):
        return f"{about}: {'; '.join(f'{issue.title}: {link(issue)}' for issue in issues)}"
    return f"{about}: {words.explanation(results[0])}"


def _unique(names: Iterable[str]) -> list[str]:
    return list(dict.fromkeys(names))
