# SPDX-License-Identifier: Apache-2.0
"""Verdicts on one check of one node, or on one document, as in a run; and the words of results."""

from mxeon.conformance import words
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import EVERY_NODE, Task
from mxeon.hosts import open_engine
from mxeon.shaders.document.policy import DEFAULT

PASSED, DIFFERS, FAILED, NOT_RUN = "passed", "differs", "failed", "not run"
SOURCE = "source"  # stands for a host in checks of texts
STOCK, RENDERER_NODES = "stock", "its own nodes"  # names of libraries
SHADER_FUNCTIONS = "shader twins"  # stands for a node in checks of shader functions


class Verdicts:
    """A judge that uses the session's hosts, or a given function from names to hosts."""

    def __init__(self, hosts=open_engine):
        self._judge = Judge(DEFAULT, hosts)

    def __call__(self, check, subject, host="gl", library="eonlib", **task):
        """The result of a check of a node, by its title."""
        [result] = self.all(check, subject, host, library, **task)
        return result

    def all(self, check, subject, host="gl", library="eonlib", **task):
        """All results of a task; tasks on texts and functions have several."""
        return self._work(check, subject, host, library, **task).results

    def texts(self, check, library):
        """Results of the text checks with this key, by subject."""
        results = self.all(SOURCE, EVERY_NODE, SOURCE, library)
        return {each.subject: each for each in results if each.check == check}

    def unjudged(self, check, library, host="gl"):
        """Subjects that a task on a whole library does not judge, with the reasons."""
        return dict(self._work(check, EVERY_NODE, host, library).unjudged)

    def document(self, path, host="gl", library="eonlib"):
        """Results, pictures and notes of a document, and the errors of reading it."""
        return self._work("picture", str(path), host, library)

    def _work(self, check, subject, host, library, **task):
        return self._judge.work(Task(check, subject, host, library, **task))


def has(result, *wanted):
    """Whether one cause of a result has all of these: kind, key, branch, region, names and numbers.

    A text with spaces may be part of a title or name; numbers are compared to two digits.
    """
    return not wanted or any(
        all(any(_matches(each, field) for field in _fields(cause)) for each in wanted)
        for cause in result.diagnosis.causes
    )


def said(result):
    """The diagnosis of a result in words, for tests of the wording."""
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
