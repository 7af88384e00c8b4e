# SPDX-License-Identifier: Apache-2.0
"""Make `docs/field.html`: `python -m tools.site.field` checks every available host in sequence.

`python -m tools.site.field DIR` makes it from the reports in a folder instead.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from mxeon import check, report
from mxeon.conformance.results import NOT_RUN
from mxeon.conformance.specs.diffuse import DIFFUSE as DIFFUSE_SPECS
from mxeon.conformance.specs.diffuse import SURFACE_LOBES
from mxeon.hosts import host_rows
from mxeon.shaders.library import examples_folder
from mxeon.survey.field import read_field
from mxeon.survey.field_page import write_field

PAGE = Path(__file__).resolve().parents[2] / "docs" / "field.html"
PAGES = "upstream/{}.md"  # links into the checkout; hooks.py replaces them on the site
EXAMPLE = examples_folder() / "clay.mtlx"
DIFFUSE = tuple(dict.fromkeys(row.node for row in (*DIFFUSE_SPECS, *SURFACE_LOBES)))
LIBRARIES = ("eonlib", "stock")
TIMEOUT = 600.0


def main(folder: str = "") -> None:
    if folder:
        write_field(read_field([folder]), PAGE, PAGES)
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
        write_field(read_field([new]), PAGE, PAGES)


if __name__ == "__main__":
    main(*sys.argv[1:])
