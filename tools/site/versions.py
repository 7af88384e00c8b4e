# SPDX-License-Identifier: Apache-2.0
"""Judge eonlib and stock with every version of MaterialX: `python -m tools.site.versions` writes the page.

It runs `mxeon check --host gl --node all` with each version, 13 minutes of processor time in all, and keeps
what the page shows in `ledger/versions.json`; `python -m tools.site.versions page` writes the page, and the ledger's, from
that file alone.
"""

import json
import sys
from collections import Counter

from mxeon.io.files import write_text
from mxeon.shaders.library import TESTED
from tests.reliability.versions import run
from tests.support.wheels import MAIN, wheel
from tools.site import DOCS
from tools.site.ledger import dumped, entries, pages, pairs

PAGE, RECORD = DOCS / "versions.md", pages.VERSIONS
VERSIONS = (*TESTED, "main")
LIBRARIES = ("eonlib", "stock")
COMMAND = ("check", "--host", "gl", "--node", "all", "--workers", "0", "--json")
TEXT = """\
# Versions of MaterialX

Does eonlib work with your MaterialX, and which defects does that version have? mxeon runs with every MaterialX whose
closure interface matches, including [your own build](check.md#your-build-of-materialx). A version that was not tested
gets a warning and a note in the report. If its generators call a closure in another way than eonlib's sources define it,
the checks of that node on that target are *not run*. Every [entry of the ledger](upstream/README.md) ends with the
versions that have the defect.

## Targets

Checks that pass with eonlib, out of those planned, for each wheel since 1.38.10:

| MaterialX | gl | webgl | vulkan | slang |
|---|---|---|---|---|
| 1.38.10, 1.39.0, 1.39.1, 1.39.2 | refused | refused | refused | refused |
| 1.39.3 | 35 of 35 | 31 of 31 | 2 of 33 | 0 of 33 |
| 1.39.4 | 35 of 35 | 31 of 31 | 30 of 30 | 0 of 33 |
| 1.39.5 | 35 of 35 | 31 of 31 | 30 of 30 | 30 of 30 |

The Vulkan GLSL of 1.39.3 compiles with no library, because the declaration of the view direction is missing. The
generator for Slang exists since 1.39.5. A version that lacks a method is refused before anything is generated:

    mxeon: MaterialX 1.38.10 lacks Document.setDataLibrary; install 1.39.3 or later: pip install materialx==1.39.5

## Nodes

`mxeon check --host gl --node all` with each version (`python -m tools.site.versions`): the number of checks that pass,
out of all. A check that *differs*, because the text leaves a choice, is counted behind the +. The versions are wheels,
with their own code and data. *Main* is the data of MaterialX's main branch at commit {commit}, of {date}, with the code
of {release}.

{nodes}
What does not pass with eonlib:

{open}
MaterialX 1.39.3 and 1.39.4 have no input `retroreflective`, and their GLSL adds the transmittance of a medium below a
layer instead of multiplying. Their `gltf_pbr` has no input `dispersion` for `reach` to vary, and `opacityMode` of their
`UsdPreviewSurface` changes nothing that `reach` measures.
"""


def judged(version):
    """What a run with a version says, as it prints it."""
    libraries = [word for each in LIBRARIES for word in ("--library", each)]
    done = run(wheel(version), *COMMAND, *libraries)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"MaterialX {version}: {done.stderr}")
    return json.loads(done.stdout)


def record(reports):
    """What the page shows, of the reports of all versions by their names."""
    found = {name: report["results"] for name, report in reports.items()}
    return {
        "commit": (MAIN.parent / "commits.txt").read_text().split(" ", 2)[:2],
        "nodes": {
            library: {name: _counts(each, library) for name, each in found.items()}
            for library in LIBRARIES
        },
        "open": {name: _open(each) for name, each in found.items()},
        "pages": {
            row.page: {name: _shown(row, each) for name, each in found.items()} for row in _ours()
        },
    }


def _ours():
    """Entries of the ledger that checks of MaterialX on gl, or of its texts, show."""
    return [
        each
        for each in entries().values()
        if each.library == "stock" and each.host in ("gl", "source") and each.rows
    ]


def _node(subject):
    """The node of the subject of a result, or what else it is about."""
    return "documents" if ".mtlx" in subject else subject.split(",")[0]


def _counts(results, library):
    """Number of results by node and verdict."""
    counts = {}
    for each in results:
        if each["library"] == library:
            counts.setdefault(_node(each["subject"]), Counter())[each["verdict"]] += 1
    return dict(sorted(counts.items()))


def _open(results):
    """Subjects of eonlib's results that do not pass, by check and verdict."""
    found = {}
    for each in results:
        if each["library"] == "eonlib" and each["verdict"] != "passed":
            found.setdefault(f"`{each['check']}` {each['verdict']}", []).append(each["subject"])
    return {check: sorted(subjects) for check, subjects in sorted(found.items())}


def _shown(row, results):
    """Whether all rows of a page pass."""
    found = {
        (each["check"], each["subject"]): each for each in results if each["library"] == "stock"
    }
    return {"passed": all(found[pair]["verdict"] == "passed" for pair in pairs(row.rows))}


def page_text(known):
    """The page."""
    commit, date = known["commit"]
    return TEXT.format(
        commit=commit,
        date=date,
        release=TESTED[-1],
        nodes=_nodes_table(known["nodes"]),
        open="".join(f"- {name}: {_listed(each)}.\n" for name, each in known["open"].items()),
    )


def _listed(found):
    """Subjects by check, in words."""
    return "; ".join(f"{check}: {'; '.join(each)}" for check, each in found.items()) or "nothing"


def _nodes_table(nodes):
    columns = [(library, name) for name in VERSIONS for library in LIBRARIES]
    text = f"| node | {' | '.join(f'{library}, {name}' for library, name in columns)} |\n"
    text += f"|---|{len(columns) * '---|'}\n"
    for node in nodes["eonlib"][VERSIONS[-1]]:
        cells = [_share(Counter(nodes[library][name].get(node, {}))) for library, name in columns]
        text += f"| {node} | {' | '.join(cells)} |\n"
    return text


def _share(counts):
    """Checks that pass, of all."""
    if not counts.total():
        return "none"
    differs = f" + {counts['differs']}" if counts["differs"] else ""
    return f"{counts['passed']}{differs} of {counts.total()}"


def main():
    """Judge every version, or take what is known, and write the pages."""
    if sys.argv[1:] != ["page"]:
        known = record({name: judged(name) for name in VERSIONS})
        write_text(RECORD, dumped(known, 3) + "\n")
    write_text(PAGE, page_text(json.loads(RECORD.read_text(encoding="utf-8"))))
    pages.main()


if __name__ == "__main__":
    main()
