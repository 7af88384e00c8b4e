# SPDX-License-Identifier: Apache-2.0
"""Fixtures and hooks for all tests. A host is opened once, when a test first needs the host."""

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
    """Set up signals and Mesa for the tests, and refuse unknown names in MXEON_REQUIRE.

    Signals that nohup or a background job ignores get their default handlers, because commands
    started by tests would inherit the ignored signals. Mesa's software driver skips optimizations
    that take time and change no value.
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
    """Import the models with line tracing on, and collect the tests with tracing off.

    Garbage collection is off during the import, and afterwards ignores the imported objects.
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
    """Name test parameters by functions, rows or files. Without names, pytest uses numbers."""
    names = (getattr(val, each, None) for each in ("__name__", "name", "title", "page", "key"))
    return next((name for name in names if isinstance(name, str)), None)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item):
    """Trace lines only in tests of the models. These tests must cover all lines of the models."""
    with nullcontext() if "models" in item.path.parts else untraced():
        return (yield)


@pytest.fixture(scope="session", autouse=True)
def one_worker():
    """Limit commands in this process to one worker, because other tests use the other cores."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("os.cpu_count", lambda: 1)
        yield


@pytest.fixture(scope="session", autouse=True)
def temporary(tmp_path_factory):
    """Put temporary files into pytest's folder, where pytest deletes files of killed processes."""
    # The path is short, because a browser's socket paths have a limited length.
    folder = tmp_path_factory.getbasetemp() / "t"
    folder.mkdir()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", str(folder))
        patch.setattr(tempfile, "tempdir", str(folder))
        yield


@pytest.fixture(scope="session", autouse=True)
def optimized_pictures():
    """Let Mesa optimize shaders for Storm, which takes much longer to render than to compile."""
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
    """Function that returns the host with a given name. Each host is opened once per session."""
    opened = {}

    def host(name):
        if name not in opened:
            with available(name), ExitStack() as failed:
                engine = failed.enter_context(open_engine(name, reference_host.ROW))
                engine.identity()  # starts the engine
                failed.pop_all()
                opened[name] = engine
        return opened[name]

    yield host
    for each in opened.values():
        each.close()


@pytest.fixture(scope="session")
def judged(hosts):
    """Function that judges one check of one node, see `Verdicts`."""
    return Verdicts(hosts)


@pytest.fixture(scope="session")
def gl(hosts):
    """The host that evaluates shaders with OpenGL."""
    return hosts("gl")


@pytest.fixture(scope="session")
def reference(hosts):
    """The host that evaluates the models in float64."""
    return hosts("reference")
