# SPDX-License-Identifier: Apache-2.0
"""The short answer of a run: the verdict, what the documents' nodes are, and what failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path

from mxeon.conformance.results import DIRECT, FAILED, NOT_RUN, Result, Run, counted
from mxeon.conformance.results.known_issues import issues_of, link
from mxeon.conformance.run.documents import REFUSED, causes, document_verdicts, is_refused
from mxeon.conformance.run.survey import model_of
from mxeon.errors import one_line

LINES = 10  # of an answer, where nothing has to be said twice
NODES = 5  # of a document, beside the number of the others that passed
MANY = 20  # documents, more of which are told by their causes
FEWEST = 3  # lines that failures have in any case
NAMED = 3  # nodes in a line of failures, beside the number of the others
FULL = "--full prints everything"
PICTURES = ("picture", "finite", "document")  # checks of documents


def answer(run: Run) -> list[str]:
    """The lines of a run's short answer."""
    # The verdict, what did not run, and the documents.
    lines = [*map(one_line, (run.sentence, *run.origins)), *_not_run(run)]
    failures, notes = list(_failures(run)), new_notes(run)
    room = LINES - len(lines) - min(len(failures), FEWEST)
    many = len(run.contents) + len(run.refused) > MANY
    documents = summary_by_cause(run) if many else _documents(run, room)
    told = documents if many else documents[: max(room, NODES)]
    lines += told
    # What failed and why, and notes.
    kept = max(FEWEST, LINES - len(lines))
    lines += failures[:kept]
    left = max(1, LINES - len(lines))
    lines += [one_line(f"note: {note}") for note in notes[:left]]
    if len(documents) > len(told) or len(failures) > kept or len(notes) > left:
        lines.append(f"there is more: {FULL}")
    return lines


def summary_by_cause(run: Run) -> list[str]:
    """A line for each cause of a verdict: how many documents have it, and the first of them."""
    verdicts = document_verdicts(run)
    every = {each.document for each in verdicts}
    referenced = len(every - {each.document for each in verdicts if not each.referenced})
    lines = [
        f"{counted(len(every), 'document')}: {referenced} have reference pictures in all materials"
    ]
    for (verdict, cause), documents in causes(verdicts).items():
        more = f" and {len(documents) - 1} more" if len(documents) > 1 else ""
        lines.append(one_line(f"  {len(documents):4} {verdict}: {cause} ({documents[0]}{more})"))
    return lines


def _documents(run: Run, room: int) -> list[str]:
    """A table for each document on each host, those with failures first; short ones if room is."""
    blocks = [
        _block(run, document, host)
        for document in run.contents
        if document not in run.refused
        for host in _hosts(run, document)
    ]
    blocks.sort(key=_passed)
    if sum(map(len, blocks)) > room and len(blocks) > 1:
        blocks = [[_short(block)] if _passed(block) else block for block in blocks]
    return [line for block in blocks for line in block]


def _short(block: Sequence[str]) -> str:
    """A document that passed, in one line."""
    return f"{block[0].split('  ')[0]}: passed"


def new_notes(run: Run) -> list[str]:
    """Notes of a run, those left out that a diagnosis says too."""
    said = tuple({each.diagnosis for each in run.results if each.diagnosis})
    return [note for note in run.notes if not note.endswith(said)]


def _hosts(run: Run, document: str) -> list[str]:
    """Hosts on which a document was judged."""
    names = (result.host for result in run.results if _is_of(result, run, document))
    return list(dict.fromkeys(names))


def _is_of(result: Result, run: Run, document: str) -> bool:
    """Whether a result that ran is of a document: of its pictures or its nodes."""
    if result.verdict == NOT_RUN:
        return False
    return _is_picture(result, document) or result.subject in run.contents[document]


def _is_picture(result: Result, document: str) -> bool:
    name = Path(document).name
    return result.check in PICTURES and result.subject.split(": ")[0] in (name, document)


def _block(run: Run, document: str, host: str) -> list[str]:
    """A document on a host: a line for each node and its pictures, a column for each library."""
    # What there is to show.
    results = [each for each in run.results if each.host == host and _is_of(each, run, document)]
    libraries = list(dict.fromkeys(each.library for each in results))
    rows: dict[str, list[Result]] = {}
    for each in results:
        title = "pictures" if _is_picture(each, document) else each.subject
        rows.setdefault(title, []).append(each)
    # Failures first, then the nodes in their order, the pictures last.
    elsewhere = {id(each) for each in results if run.is_elsewhere(each, document)}
    failed = {
        title: any(each.verdict == FAILED and id(each) not in elsewhere for each in row)
        for title, row in rows.items()
    }
    titles = sorted(rows, key=lambda title: (not failed[title], title == "pictures"))
    kept = [title for title in titles if failed[title] or title == "pictures"]
    kept += [title for title in titles if title not in kept][: max(1, NODES - len(kept))]
    table = [[one_line(f"{document} on {host}"), *map(one_line, libraries)]]
    refused = {name: REFUSED if is_refused(run, document, name) else "" for name in libraries}
    for title in filter(kept.__contains__, titles):
        cells = []
        for library in libraries:
            row = [each for each in rows[title] if each.library == library]
            own = [each for each in row if id(each) not in elsewhere]
            words = _cell(own or row) + ", other inputs wrong" * (len(own) < len(row))
            cells.append(refused[library] or words)
        table.append([f"  {title}", *cells])
    if others := len(titles) - len(kept):
        cells = [refused[library] or "passed" for library in libraries]
        table.append([f"  {counted(others, 'other node')}", *cells])
    return _aligned(table)


def _passed(block: Sequence[str]) -> bool:
    return not any(word in line for line in block[1:] for word in (FAILED, REFUSED))


def _cell(results: Sequence[Result]) -> str:
    """What a node or the pictures are with one library: model, error, bound."""
    if not results:
        return "not judged"
    failed = [result for result in results if result.verdict == FAILED]
    direct = [result for result in results if result.check in DIRECT]
    shown = max(failed or direct or results, key=_ratio)
    numbers = f"error {shown.error:.2g}, bound {shown.tolerance:.2g}" if shown.tolerance else ""
    words = "failed" if failed else _words(shown, len(results))
    return ", ".join(filter(None, (words, numbers)))


def _words(result: Result, count: int) -> str:
    """What a subject is that passed."""
    if result.check == "picture":
        names = ", ".join(result.measured[:NAMED])
        return f"{count} as the reference's" + (f", {names} from the host" if names else "")
    if result.check in PICTURES:
        return "finite" if result.check == "finite" else "shaders generated"
    return model_of(result.subject)


def _ratio(result: Result) -> float:
    return (result.error or 0.0) / (result.tolerance or 1.0)


def _aligned(table: Sequence[Sequence[str]]) -> list[str]:
    """Lines of a table with columns of equal width."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in table
    ]


def _not_run(run: Run) -> Iterator[str]:
    """Each reason that kept checks from running, with their number."""
    reasons = Counter(
        (each.location, each.reason) for each in run.results if each.verdict == NOT_RUN
    )
    for (where, reason), count in list(reasons.items())[:FEWEST]:
        yield one_line(f"not run: {where}, {counted(count, 'check')}: {reason}")
    if len(reasons) > FEWEST:
        yield f"not run for {counted(len(reasons) - FEWEST, 'other reason')}; {FULL}"


def _failures(run: Run) -> Iterator[str]:
    """A line for each page or diagnosis that explains failures: a sentence, and its link.

    Failures that no page explains come first, those of other inputs than the documents' last.
    """
    groups: dict[tuple[str, str], list[Result]] = {}
    failures = (each for each in run.results if each.verdict == FAILED)
    for each in sorted(failures, key=lambda each: (run.is_elsewhere(each), bool(each.pages))):
        reason = " ".join(each.pages) or each.explanation
        other = "for other inputs than yours: " * run.is_elsewhere(each)
        groups.setdefault((f"{each.location}: {other}", reason), []).append(each)
    # Pictures are wrong because nodes are, where some are.
    places = {place for (place, _), each in groups.items() if any(map(_is_of_node, each))}
    for (place, _), results in groups.items():
        if place not in places or any(map(_is_of_node, results)):
            yield one_line(f"failed: {place}{_sentence(results)}")


def _is_of_node(result: Result) -> bool:
    return result.check not in PICTURES


def _sentence(results: Sequence[Result]) -> str:
    """What explains failures of one reason, and which checks they are."""
    first = results[0]
    # The checks by their keys, and the nodes; one in one mode by its whole name.
    subjects = list(dict.fromkeys(each.subject for each in results))
    keys = ", ".join(dict.fromkeys(each.check for each in results))
    nodes = list(dict.fromkeys(each.partition(",")[0] for each in subjects))
    more = f" and {len(nodes) - NAMED} more" if len(nodes) > NAMED else ""
    where = subjects[0] if len(subjects) == 1 else ", ".join(nodes[:NAMED]) + more
    about = f"{where} ({keys})"
    # The sentence of its page, and where that is.
    if issues := issues_of(first):
        links = ", ".join(map(link, issues))
        return f"{about}: {'; '.join(issue.title for issue in issues)}: {links}"
    return f"{about}: {first.explanation}"
