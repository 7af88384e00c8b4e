# SPDX-License-Identifier: Apache-2.0
"""Expensive values, computed by one of pytest's processes for all of them."""

import os
import pickle

import pytest
from filelock import FileLock

import mxeon
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep

# Documents that are judged with each library: eonlib must render all examples correctly.
EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]
DOCUMENTS = {"eonlib": sorted(examples_folder().glob("*.mtlx")), "stock": EXAMPLES}


_MADE = {}  # values by name, for tests in a single process


def shared(factory, name, make):
    """The value of `make`; with several test processes, the first one computes it."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        if name not in _MADE:
            _MADE[name] = make()
        return _MADE[name]
    path = factory.getbasetemp().parent / f"{name}.pickle"  # a folder of this session
    with FileLock(f"{path}.lock"):
        if not path.exists():
            path.write_bytes(pickle.dumps(make()))
        return pickle.loads(path.read_bytes())


# Checks of the text for path tracers, which eonlib alone has.
DRAWN = (
    *("pdf", "sample", "path_value", "path_inside", "path_energy", "path_leaving", "path_albedo"),
    *("path_emission", "path_random"),
)


def every_node(factory, library):
    """Results of every node and some documents on gl with a library, computed once for all tests.

    The longest tests judge the text for path tracers.
    """

    def make():
        with pytest.MonkeyPatch.context() as patch:
            keep(patch, lambda task: task.check not in DRAWN)
            return mxeon.check(DOCUMENTS[library], ["gl"], [library], nodes=["all"])

    return shared(factory, library, make)
