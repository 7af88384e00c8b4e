# SPDX-License-Identifier: Apache-2.0
"""Write a page with the verdict on each document of a run, and how many have each cause.

mxeon check FOLDER --report DIR
python docs/documents.py DIR PAGE
"""

import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from mxeon.conformance.run import read_run
from mxeon.conformance.run.documents import DocumentVerdict, causes, document_verdicts
from mxeon.io.files import write_text

SHOWN = 3  # inputs of a document that are named


def lines(verdicts: Sequence[DocumentVerdict]) -> Iterator[str]:
    """Lines of the page."""
    # How many documents have each cause.
    documents = {each.document for each in verdicts}
    lacking = {each.document for each in verdicts if not each.referenced}
    yield "# Documents\n"
    yield (
        f"{len(documents) - len(lacking)} of {len(documents)} documents have a reference picture of each "
        "material. `python docs/documents.py DIR PAGE` writes this page from the report of "
        "`mxeon check FOLDER --report DIR`.\n"
    )
    yield "| documents | verdict | cause |\n|---|---|---|"
    for (verdict, cause), names in causes(verdicts).items():
        yield f"| {len(names)} | {verdict} | {_cell(cause)} |"
    # Each document.
    yield "\n| document | verdict | cause | inputs from the host |\n|---|---|---|---|"
    for each in sorted(verdicts, key=lambda each: each.document):
        more = f" and {len(each.measured) - SHOWN} more" if len(each.measured) > SHOWN else ""
        inputs = ", ".join(each.measured[:SHOWN]) + more
        cells = (each.document, each.verdict, each.cause, inputs)
        yield f"| {' | '.join(map(_cell, cells))} |"


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    report, page = sys.argv[1:]
    write_text(Path(page), "\n".join([*lines(document_verdicts(read_run(report))), ""]))
