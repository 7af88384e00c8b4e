# SPDX-License-Identifier: Apache-2.0
"""Judges a check of a node, or a document, as in a run, and searches diagnoses."""

from mxeon.conformance import words
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import EVERY_NODE, Task
from mxeon.hosts import open_engine
from mxeon.shaders.document.policy import DEFAULT

PASSED, DIFFERS, FAILED, NOT_RUN = "passed", "differs", "failed", "not run"
SOURCE = "source"  # name of the host in results of checks of source code
STOCK, RENDERER_NODES = "stock", "its own nodes"  # names of libraries in results
SHADER_FUNCTIONS = "shader twins"  # subject of checks of shader functions


class Verdicts:
    """Judges nodes and documents on hosts. `hosts` is a function that returns a host by name."""

    def __init__(self, hosts=open_engine):
        self._judge = Judge(DEFAULT, hosts)

    def __call__(self, check, subject, host="gl", library="eonlib", **task):
        """Result of one check of the node with the title `subject`."""
        [result] = self.all(check, subject, host, library, **task)
        return result

    def all(self, check, subject, host="gl", library="eonlib", **task):
        """All results of one task. Tasks that check source or functions have several results."""
        return self._work(check, subject, host, library, **task).results

    def texts(self, check, library):
        """Results of the check of source code with the key `check`, by subject."""
        results = self.all(SOURCE, EVERY_NODE, SOURCE, library)
        return {each.subject: each for each in results if each.check == check}

    def unjudged(self, check, library, host="gl"):
        """Subjects that a check of a whole library does not judge, and the reasons."""
        return dict(self._work(check, EVERY_NODE, host, library).unjudged)

    def document(self, path, host="gl", library="eonlib"):
        """Findings of a document: results, pictures, notes and errors while reading."""
        return self._work("picture", str(path), host, library)

    def _work(self, check, subject, host, library, **task):
        return self._judge.work(Task(check, subject, host, library, **task))


def has(result, *wanted):
    """Whether a single cause in the diagnosis contains all wanted kinds, keys, names and numbers.

    A wanted text with spaces may be part of a title or name. Numbers match if two digits agree.
    """
    return not wanted or any(
        all(any(_matches(each, field) for field in _fields(cause)) for each in wanted)
        for cause in result.diagnosis.causes
    )


def said(result):
    return words.diagnosis(result.diagnosis)


def _fields(cause):
    region = cause.region
    place = (region.name, region.part, region.low, region.high, *region.channels) if region else ()
    return (cause.kind.value, cause.key, cause.branch, *cause.names, *cause.values, *place)


def _matches(wanted, field):
    if isinstance(wanted, str) and isinstance(field, str):
        return wanted == field or (" " in wanted and wanted in field)
    numbers = isinstance(wanted, float) and isinstance(field, float)
    return numbers and abs(wanted - field) <= 0.05 * abs(wanted)
