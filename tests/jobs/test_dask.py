# SPDX-License-Identifier: Apache-2.0
"""Jobs on Dask clusters, with real schedulers and worker processes on this machine."""

import os
import socket
import subprocess
import sys
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager
from unittest.mock import Mock

import pytest

import mxeon
from mxeon import check
from mxeon.errors import InputError, NotRun
from mxeon.jobs import dask
from mxeon.jobs.pool import Outcome
from mxeon.shaders.library import examples_folder
from tests.support.faults import Lost, meet, need, once, square
from tests.support.plans import keep_checks

ONE_THREAD = ["--nthreads", "1"]
OTHER_VERSION = "import mxeon\nmxeon.__version__ = '0.0.9'\n"
# Dask leaves sockets open after the search for a port, so warnings about sockets are ignored.
pytestmark = [
    pytest.mark.whole,
    pytest.mark.filterwarnings("ignore:unclosed <socket:ResourceWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
]
EXAMPLE = examples_folder() / "plaster.mtlx"


def run(work, items, address, timeout=600.0):
    with dask.connect(address) as workers:
        return dict(dask.run(work, items, workers, timeout, NotRun))


@contextmanager
def farm(*workers):
    """Address of a scheduler. Each argument holds a worker's additional environment variables."""
    from distributed import LocalCluster  # slow to import

    with ExitStack() as stack:
        options = {"n_workers": 0, "dashboard_address": ":0", "protocol": "tcp"}
        started = stack.enter_context(LocalCluster(**options))
        for more in workers:
            arguments = more.pop("arguments", ONE_THREAD)
            command = [sys.executable, "-m", "distributed.cli.dask_worker", "--no-dashboard"]
            paths = os.pathsep.join(filter(None, sys.path))
            process = subprocess.Popen(
                [*command, started.scheduler_address, *arguments],
                env=os.environ | {"PYTHONPATH": paths, "PYTHONSAFEPATH": "1"} | more,
                stderr=subprocess.DEVNULL,
            )
            stack.callback(process.wait, 60.0)
            stack.callback(process.terminate)
        started.wait_for_workers(len(workers), timeout=300)
        yield started.scheduler_address


@pytest.fixture(scope="module")
def pair():
    """Address of a scheduler with two workers. Only one of the workers has the variable LAMP."""
    with farm({}, {"LAMP": "on"}) as address:
        yield address


def test_every_item_is_worked_on_once_and_by_all_workers(pair, tmp_path):
    assert run(square, range(20), pair) == {item: Outcome(item * item) for item in range(20)}
    assert len({outcome.value for outcome in run(meet, [str(tmp_path)] * 8, pair).values()}) == 2


def test_what_one_worker_lacks_is_done_by_another(pair):
    assert run(need, ["LAMP"] * 8, pair) == {place: Outcome("on") for place in range(8)}


def test_what_all_workers_lack_is_not_run(pair):
    assert run(need, ["MOON"], pair) == {0: Outcome(None, "MOON: missing")}


def test_a_worker_killed_at_work_costs_nothing(pair, tmp_path):
    items = [str(tmp_path / name) for name in "ab"]
    assert run(once, items, pair) == dict.fromkeys((0, 1), Outcome("done"))
    assert run(square, [3], pair) == {0: Outcome(9)}


def test_a_worker_killed_with_its_result_costs_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(dask, "FETCH", 1.0)
    with farm({}) as address:  # no other worker can take over the task
        assert run(Lost, [str(tmp_path / "a")], address) == {0: Outcome("done")}


def test_workers_that_do_not_fit_get_no_work_and_are_named(tmp_path):
    preload = tmp_path / "preload.py"
    preload.write_text(OTHER_VERSION)
    other = {"arguments": ["--no-nanny", "--preload", str(preload), *ONE_THREAD]}
    threads = {"arguments": ["--no-nanny", "--nthreads", "2"]}
    fit = {"FIT": "yes", "arguments": ["--no-nanny", *ONE_THREAD]}
    with farm(fit, other, threads) as address, pytest.warns(UserWarning) as said:
        found = run(need, ["FIT"] * 12, address)
    assert found == {place: Outcome("yes") for place in range(12)}
    words = " | ".join(str(each.message) for each in said)
    assert f"it must have mxeon {mxeon.__version__}; got 0.0.9" in words
    assert "it must have one thread, --nthreads 1, because of OpenGL; got 2" in words


NOBODY = {"workers": {}}
SOMEBODY, TWO_THREADS = ({"workers": {"tcp://a": {"nthreads": each}}} for each in (1, 2))


class Client:
    """Stand-in for a Dask client that returns prepared lists of workers, one after another."""

    def __init__(self, *answers):
        self._answers = list(answers)

    def scheduler_info(self, n_workers):
        return self._answers.pop(0) if len(self._answers) > 1 else self._answers[0]

    def run(self, *_, workers, on_error):
        return dict.fromkeys(workers, mxeon.__version__)


WAITED = "no compatible Dask worker was available within 0.01 s; raise it with --waitForWorkers"
ONE = f"must have a worker with mxeon {mxeon.__version__} and --nthreads 1; got 1 incompatible"


@pytest.mark.filterwarnings("ignore:worker tcp:UserWarning")
@pytest.mark.parametrize(
    "answers, wait, submitted, error, words",
    [
        ((TWO_THREADS,), 60.0, None, InputError, ONE),
        ((NOBODY,), 0.01, None, NotRun, WAITED),
        ((SOMEBODY, NOBODY), 0.01, None, NotRun, WAITED),
        ((SOMEBODY, SOMEBODY, {}), 60.0, None, NotRun, dask.GONE),
        ((SOMEBODY,), 60.0, OSError("closed"), NotRun, f"^{dask.GONE}$"),
        ((SOMEBODY,), 60.0, CancelledError(), NotRun, f"^{dask.GONE}$"),
    ],
)
def test_a_cluster_that_cannot_go_on_is_one_line(answers, wait, submitted, error, words):
    client = Client(*answers)
    client.submit = Mock(side_effect=submitted)
    with pytest.raises(error, match=words):
        list(dask.run(square, [1], dask.Workers(client, wait), 1.0, NotRun))


@pytest.mark.parametrize(
    "address, wait, words",
    [
        ("", 1.0, "scheduler must be the address"),
        (" ", 1.0, "scheduler must be the address"),
        ("tcp://127.0.0.1:9", 0.0, "waitForWorkers must be positive and at most"),
        ("tcp://127.0.0.1:9", 1.0, "^scheduler must be the address of a running [^\n]*$"),
        ("listener", 0.5, "scheduler must be the address"),
    ],
)
def test_an_address_without_an_answer_is_one_line(address, wait, words):
    with socket.create_server(("127.0.0.1", 0)) as server:  # a server that never answers
        if address == "listener":
            address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(InputError, match=words):
            check([EXAMPLE], scheduler=address, wait=wait)


def test_a_farm_finds_what_one_machine_finds(pair, tmp_path, monkeypatch):
    keep_checks(monkeypatch, "value", "reciprocity", "picture")
    found = check([EXAMPLE], scheduler=pair, folder=tmp_path)
    assert found.results == check([EXAMPLE]).results and not found.missing
