# SPDX-License-Identifier: Apache-2.0
"""One check of one node, or one document, as a run judges it; and the words of results."""

from mxeon.conformance import words
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import EVERY_NODE, Task
from mxeon.hosts import open_engine
from mxeon.shaders.document.policy import DEFAULT

PASSED, DIFFERS, FAILED, NOT_RUN = "passed", "differs", "failed", "not run"
SOURCE = "source"  # in the place of a host
STOCK, RENDERER_NODES = "stock", "its own nodes"  # in the place of a library
SHADER_FUNCTIONS = "shader twins"  # in the place of a node


class Verdicts:
    """A judge whose hosts are those of the session, or of another function of their names."""

    def __init__(self, hosts=open_engine):
        self._judge = Judge(DEFAULT, hosts)

    def __call__(self, check, subject, host="gl", library="eonlib", **task):
        """The result of a check of a node, by its title."""
        [result] = self.all(check, subject, host, library, **task)
        return result

    def all(self, check, subject, host="gl", library="eonlib", **task):
        """Results of a task: those of texts and functions are several."""
        return self._work(check, subject, host, library, **task).results

    def texts(self, check, library):
        """Results of the checks of texts that have this key, by their subject."""
        task = check if check == "definition" else SOURCE
        results = self.all(task, EVERY_NODE, SOURCE, library)
        return {each.subject: each for each in results if each.check == check}

    def unjudged(self, check, library, host="gl"):
        """What a task of a whole library does not judge, and the reasons."""
        return dict(self._work(check, EVERY_NODE, host, library).unjudged)

    def document(self, path, host="gl", library="eonlib"):
        """Results, pictures and notes of a document, and why it cannot be read."""
        return self._work("picture", str(path), host, library)

    def _work(self, check, subject, host, library, **task):
        return self._judge.work(Task(check, subject, host, library, **task))


def has(result, *wanted):
    """Whether one cause of a result has all of these: kind, key, branch, region, names and numbers.

    A text with spaces may be a part of a title or of a name; numbers are compared to two digits.
    """
    return not wanted or any(
        all(any(_matches(each, field) for field in _fields(cause)) for each in wanted)
        for cause in result.diagnosis.causes
    )


def said(result):
    """The diagnosis of a result in words, for tests of the words."""
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
