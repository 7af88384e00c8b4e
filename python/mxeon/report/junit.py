# SPDX-License-Identifier: Apache-2.0
"""A run as JUnit XML, for build servers."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

from mxeon.conformance import words
from mxeon.conformance.results import FAILED, NOT_RUN, Result, Run
from mxeon.conformance.results.known_issues import issues_of
from mxeon.errors import one_line
from mxeon.report.formats import page_address, vector

# Characters that XML 1.0 cannot hold, escaped or not (section 2.2, production Char).
NOT_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def to_junit(run: Run) -> str:
    """A run as JUnit XML, with a suite for each host and library, and a case for each result.

    A failed check has the type "known" if a page describes the defect, otherwise "new". Checks that
    did not run and failures of a compared library are skipped. Refused documents are errors in a
    separate suite. Folders of libraries are named without their paths, which differ between
    machines, unless two folders share a name.
    """
    root = ElementTree.Element("testsuites", name="mxeon")
    folders = {result.library for result in run.results}
    uses = Counter(Path(each).name for each in folders)
    names = {each: Path(each).name if uses[Path(each).name] == 1 else each for each in folders}
    for place in dict.fromkeys(result.location for result in run.results):
        # Failures of a compared library count as not run.
        results = [
            replace(each, verdict=NOT_RUN, reason=f"for comparison: {words.explanation(each)}")
            if each.verdict == FAILED and each.library in run.compared
            else each
            for each in run.results
            if each.location == place
        ]
        counts = Counter(result.verdict for result in results)
        counted = {"tests": str(len(results)), "failures": str(counts[FAILED]), "errors": "0"}
        counted["skipped"] = str(counts[NOT_RUN])
        counted["time"] = f"{sum(each.seconds or 0.0 for each in results):.3f}"
        host, library = results[0].host, names[results[0].library]
        name = _xml(f"{host} with {library}")
        suite = ElementTree.SubElement(root, "testsuite", {"name": name} | counted)
        properties = ElementTree.SubElement(suite, "properties")
        versions = {"mxeon": run.version} | run.software
        for identity in run.hosts:
            if identity.name == host:
                versions |= {"host": identity.name, "host version": identity.version}
                versions["device"] = identity.device
        for key, value in versions.items():
            ElementTree.SubElement(properties, "property", name=_xml(key), value=_xml(value))
        for result in results:
            _add_case(suite, result, f"mxeon.{host}.{library}.{result.check}")
    if run.refused:
        count = str(len(run.refused))
        totals = {"tests": count, "failures": "0", "errors": count, "skipped": "0"}
        suite = ElementTree.SubElement(root, "testsuite", {"name": "documents"} | totals)
        for each in run.refused:
            attributes = {"classname": "mxeon.documents", "name": _xml(each)}
            case = ElementTree.SubElement(suite, "testcase", attributes)
            first = ElementTree.SubElement(
                case, "error", type="refused", message=_xml(each.faults[0])
            )
            first.text = _xml("\n".join(each.faults))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    # The XML declaration is written here, because ElementTree would declare the encoding of the
    # system's locale.
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _add_case(suite: ElementTree.Element, result: Result, name: str) -> None:
    about = {"classname": _xml(name), "name": _xml(result.subject)}
    case = ElementTree.SubElement(
        suite, "testcase", about | {"time": f"{result.seconds or 0.0:.3f}"}
    )
    if result.verdict == NOT_RUN:
        ElementTree.SubElement(case, "skipped", message=_xml(result.reason))
    if result.verdict == FAILED:
        found = words.diagnosis(result.diagnosis)
        message = one_line(f"{result.claim} {words.excess(result) or found}")
        kind = "known" if result.pages else "new"
        failure = ElementTree.SubElement(case, "failure", type=kind, message=_xml(message))
        pages = (f"see {page_address(issue)}" for issue in issues_of(result))
        text = "; ".join(filter(None, (found, *pages)))
        if result.worst:
            worst = (f"{name} {vector(values)}" for name, values in result.worst.items())
            text += f"\nworst point: {', '.join(worst)}"
        failure.text = _xml(text)


def _xml(text: object) -> str:
    return NOT_XML.sub("\N{REPLACEMENT CHARACTER}", str(text))
