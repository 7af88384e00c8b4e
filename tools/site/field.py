# SPDX-License-Identifier: Apache-2.0
"""Make `docs/field.html`: `python -m tools.site.field` checks every available host in sequence.

`python -m tools.site.field DIR` makes it from the reports in a folder instead.
"""

import re
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon import check, report
from mxeon.conformance.results import NOT_RUN
from mxeon.conformance.specs.diffuse import DIFFUSE as DIFFUSE_SPECS
from mxeon.conformance.specs.diffuse import SURFACE_LOBES
from mxeon.hosts import host_rows
from mxeon.io.files import write_text
from mxeon.shaders.library import examples_folder
from mxeon.survey.field import read_field
from mxeon.survey.field_page import write_field

PAGE = Path(__file__).resolve().parents[2] / "docs" / "field.html"
PAGES = "upstream/{}.md"  # links into the checkout; hooks.py replaces them on the site
EXAMPLE = examples_folder() / "clay.mtlx"
DIFFUSE = tuple(dict.fromkeys(row.node for row in (*DIFFUSE_SPECS, *SURFACE_LOBES)))
LIBRARIES = ("eonlib", "stock")
TIMEOUT = 600.0
ROW, FIGURE = (
    re.compile(f'<{tag} {name}="([^"]+)".*?</{tag}>', re.DOTALL)
    for tag, name in (("tr", "id"), ("figure", "data-row"))
)
STRIP = '<div class="strip">'


def host_of(row: str) -> str:
    return row.partition("<b>")[2].partition("</b>")[0]


def write(folder: str) -> None:
    """Write the page; keep the rows of hosts that no report in a folder has, with their version."""
    old = PAGE.read_text(encoding="utf-8")
    entries = read_field([folder])
    measured = {each.host for each in entries}
    kept = {row[1]: row[0] for row in ROW.finditer(old) if host_of(row[0]) not in measured}
    version = old.partition("measured by mxeon ")[2].partition("<")[0]
    hosts = dict.fromkeys(map(host_of, kept.values()))
    absent = (row for row in host_rows() if row.name not in {*measured, *hosts})
    texts = [
        f"{row.name} was not measured{f': it needs {row.needs}' * bool(row.needs)}."
        for row in absent
    ]
    if kept:
        texts += [
            f"{', '.join(hosts)}: not measured again, so the rows name the older version of mxeon, and are not counted."
        ]
    write_field(entries, PAGE, PAGES, " ".join(texts))
    table, *strips = PAGE.read_text(encoding="utf-8").split(STRIP)
    rows = "".join(marked(row, name, version) for name, row in kept.items())
    table = table.replace("</tbody>", f"{rows}</tbody>")
    older = (part.partition("</main>")[0] for part in old.split(STRIP)[1:])
    for number, part in enumerate(older):
        figures = "".join(
            marked(each[0], each[1], version) for each in FIGURE.finditer(part) if each[1] in kept
        )
        strips[number] = strips[number].replace("</div>", f"{figures}</div>", 1)
    write_text(PAGE, STRIP.join([table, *strips]))


def marked(text: str, name: str, version: str) -> str:
    """A row or figure of an older page; its name and first line tell the version that measured it."""
    if name.startswith("by-"):
        return text + "\n"
    text = re.sub(r'(id="|data-row="|href="#)row-', rf"\1by-{version}-row-", text)
    return (
        text.replace('<div class="quiet">', f'<div class="quiet">measured by mxeon {version}: ', 1)
        + "\n"
    )


def main(folder: str = "") -> None:
    if folder:
        write(folder)
        return
    with TemporaryDirectory(prefix="mxeon-field-") as new:
        for row in host_rows():
            if not row.needs:
                nodes = DIFFUSE if row.target else ("common",)
                run = check(
                    [EXAMPLE], [row.name], LIBRARIES, workers=1, timeout=TIMEOUT, nodes=nodes
                )
                if any(e.host == row.name and e.verdict != NOT_RUN for e in run.results):
                    report.write(run, Path(new, row.name))
                print(row.name, run.sentence, flush=True)
        write(new)


if __name__ == "__main__":
    main(*sys.argv[1:])
