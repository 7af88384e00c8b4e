# SPDX-License-Identifier: Apache-2.0
"""One check of one node, as a run makes it."""

import pytest

from mxeon.conformance.run import judge as judging
from mxeon.conformance.run.tasks import Task
from mxeon.shaders.document.policy import DEFAULT


class Verdicts:
    """A judge whose hosts are those of the session."""

    def __init__(self, hosts):
        self._hosts, self._judge = hosts, judging.Judge(DEFAULT)

    def __call__(self, check, subject, host="gl", library="eonlib"):
        """The result of a check of a node, by its title."""
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(judging, "open_engine", self._hosts)
            [result] = self._judge.work(Task(check, subject, host, library)).results
        return result
