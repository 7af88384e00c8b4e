# SPDX-License-Identifier: Apache-2.0
"""One check of one node, as a run makes it."""

import pytest

from mxeon.conformance.run import judge as judging
from mxeon.conformance.run.plan import EVERY_NODE, Task
from mxeon.shaders.document.policy import DEFAULT


class Verdicts:
    """A judge whose hosts are those of the session."""

    def __init__(self, hosts):
        self._hosts, self._judge = hosts, judging.Judge(DEFAULT)

    def __call__(self, check, subject, host="gl", library="eonlib"):
        """The result of a check of a node, by its title."""
        [result] = self.all(check, subject, host, library)
        return result

    def all(self, check, subject, host, library):
        """Results of a task: those of texts and functions are several."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(judging, "open_engine", self._hosts)
            return self._judge.work(Task(check, subject, host, library)).results

    def texts(self, check, library):
        """Results of the checks of texts that have this key, by their subject."""
        task = check if check == "definition" else "source"
        results = self.all(task, EVERY_NODE, "source", library)
        return {each.subject: each for each in results if each.check == check}
