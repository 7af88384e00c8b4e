# SPDX-License-Identifier: Apache-2.0
"""Hosts for the tests, opened once per session when a test first needs them."""

import atexit
import gc
import os
import signal
import tempfile
from contextlib import ExitStack, nullcontext
from importlib import import_module
from pkgutil import walk_packages

import pytest

from mxeon import models
from mxeon.conformance import reference as reference_host
from mxeon.hosts import open_engine
from mxeon.hosts.process import Worker
from mxeon.jobs.signals import ENDING
from tests.support.availability import available, required
from tests.support.tracing import untraced
from tests.support.verdicts import Verdicts


def pytest_configure():
    """Restore signals that nohup or a background job ignores, and refuse unknown hosts.

    Otherwise every command that the tests start would inherit the ignored signals. Mesa's software
    driver compiles shaders without optimizing them, which is faster and changes no bit of their
    values.
    """
    os.environ.setdefault("GALLIVM_PERF", "nopt")
    for number in ENDING:
        if signal.getsignal(number) == signal.SIG_IGN:
            default = signal.default_int_handler if number == signal.SIGINT else signal.SIG_DFL
            signal.signal(number, default)
    try:
        required()
    except ValueError as error:
        raise pytest.UsageError(str(error)) from None


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Import the models, whose lines are traced, then collect without tracing.

    Garbage collection is disabled meanwhile, and skips the objects that exist then until the
    process ends.
    """
    for module in walk_packages(models.__path__, f"{models.__name__}."):
        import_module(module.name)
    gc.disable()
    with untraced():
        collected = yield
    gc.freeze()
    atexit.register(gc.unfreeze)
    gc.enable()
    return collected


def pytest_make_parametrize_id(val):
    """A function's name as its id; the default contains an address, which differs between workers."""
    return getattr(val, "__name__", None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """Trace lines only in the tests of the models, which must cover all lines by themselves."""
    with nullcontext() if "models" in item.path.parts else untraced():
        return (yield)


@pytest.fixture(scope="session", autouse=True)
def one_worker():
    """Run commands in this process with one worker, because other tests use the other processors."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("os.cpu_count", lambda: 1)
        yield


@pytest.fixture(scope="session", autouse=True)
def temporary(tmp_path_factory):
    """Temporary files that Blender or killed processes leave are deleted with the tests' folders."""
    folder = tmp_path_factory.getbasetemp() / "t"  # short, for the sockets of a browser
    folder.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(folder))
        patch.setattr(tempfile, "tempdir", str(folder))
        yield


@pytest.fixture(scope="session", autouse=True)
def optimized_pictures():
    """Storm draws for much longer than its driver compiles, so its driver optimizes."""
    start = Worker.start

    def optimized(worker):
        with pytest.MonkeyPatch.context() as patch:
            if "storm" in worker.log.parent.name:
                patch.delenv("GALLIVM_PERF", raising=False)
            start(worker)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Worker, "start", optimized)
        yield


@pytest.fixture(scope="session")
def hosts():
    """A function that opens a host by name, once per session."""
    opened = {}

    def host(name):
        if name not in opened:
            with available(name), ExitStack() as failed:
                engine = failed.enter_context(open_engine(name, reference_host.ROW))
                engine.identity()  # some engines do not start before this
                failed.pop_all()
                opened[name] = engine
        return opened[name]

    yield host
    for each in opened.values():
        each.close()


@pytest.fixture(scope="session")
def judged(hosts):
    """A function that judges one check of one node; see `Verdicts`."""
    return Verdicts(hosts)


@pytest.fixture(scope="session")
def gl(hosts):
    """The gl host."""
    return hosts("gl")


@pytest.fixture(scope="session")
def reference(hosts):
    """The reference host."""
    return hosts("reference")
