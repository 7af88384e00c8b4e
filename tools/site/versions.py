# SPDX-License-Identifier: Apache-2.0
"""Checks eonlib and stock MaterialX with all versions: `python -m tools.site.versions`.

The command runs `mxeon check --host gl --node all` and the checks of all surface shaders'
specifications with each version, in 14 minutes of processor time. Results are stored in
`ledger/versions.json`, and are shown in versions.md and on the ledger's pages.
"""

import json
from collections import Counter, defaultdict

from mxeon.conformance.results import DIFFERS, FAILED, NOT_RUN, PASSED
from mxeon.conformance.results.known_issues import issues
from mxeon.io.files import write_text
from mxeon.shaders.library import TESTED
from tests.support.wheels import MAIN
from tools.site import DOCS, surface_texts, with_block
from tools.site.ledger import dumped, pages

PAGE, RECORD = DOCS / "versions.md", pages.VERSIONS
VERSIONS = (*TESTED, "main")
LIBRARIES = ("eonlib", "stock")
COMMAND = ("--node", "all", *surface_texts.OPTIONS, "--library", "eonlib", "--library", "stock")


def record(versions):
    """Data for pages of the site, computed from the results of each version.

    - `nodes`: Number of results by library, version, node and verdict, except the results of checks
      of specifications.
    - `open`: Subjects of checks that eonlib does not pass, by version, check and verdict.
    - `pages`: Whether all checks of a ledger page pass, by page and version, for pages about
      MaterialX that need no host except gl.
    """
    found = {
        "commit": (MAIN.parent / "commits.txt").read_text().split(" ", 2)[:2],
        "nodes": {library: {} for library in LIBRARIES},
        "open": {},
        "pages": {},
    }
    for name, results in versions.items():
        counts = {library: defaultdict(Counter) for library in LIBRARIES}
        not_passed, verdicts = defaultdict(list), {}
        for each in results:
            check, subject, verdict = each["check"], each["subject"], each["verdict"]
            verdicts[each["library"], check, subject] = verdict
            if check == "specification":
                continue
            node = "documents" if ".mtlx" in subject else subject.split(",")[0]
            counts[each["library"]][node][verdict] += 1
            if each["library"] == "eonlib" and verdict != PASSED:
                not_passed[f"`{check}` {verdict}"].append(subject)
        for library in LIBRARIES:
            found["nodes"][library][name] = dict(sorted(counts[library].items()))
        found["open"][name] = {check: sorted(each) for check, each in sorted(not_passed.items())}
        for issue in issues().values():
            if issue.library in LIBRARIES and issue.host in ("gl", "source") and issue.rows:
                passed = all(verdicts[issue.library, *pair] == PASSED for pair in issue.rows)
                found["pages"].setdefault(issue.page, {})[name] = {"passed": passed}
    return found


def page(text):
    known = json.loads(RECORD.read_text(encoding="utf-8"))
    commit, date = known["commit"]
    nodes = [
        f"*Main* is the data of MaterialX's main branch at commit {commit}, of {date}, with the code of {TESTED[-1]}.",
        "",
        "| MaterialX | library | passed | differ | failed | not run |",
        "|---|---|---|---|---|---|",
    ]
    for name in VERSIONS:
        for library in LIBRARIES:
            counts = sum(map(Counter, known["nodes"][library][name].values()), Counter())
            cells = (str(counts[verdict]) for verdict in (PASSED, DIFFERS, FAILED, NOT_RUN))
            nodes.append(f"| {name} | {library} | {' | '.join(cells)} |")
    versions = defaultdict(list)
    for name, found in known["open"].items():
        nodes_open = {each.split(",")[0] for subjects in found.values() for each in subjects}
        versions[", ".join(sorted(nodes_open)) or "none"].append(name)
    lines = [f"- {' and '.join(names)}: {subjects}." for subjects, names in versions.items()]
    text = with_block(text, "nodes", "\n".join([*nodes, ""]))
    return with_block(text, "open", "\n".join([*lines, ""]))


if __name__ == "__main__":
    found = {name: surface_texts.judged_with(name, *COMMAND) for name in VERSIONS}
    write_text(RECORD, dumped(record(found), 3) + "\n")
    write_text(PAGE, page(PAGE.read_text(encoding="utf-8")))
