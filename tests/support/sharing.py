# SPDX-License-Identifier: Apache-2.0
"""Expensive values that one pytest process computes for all pytest processes."""

import os
import pickle

import pytest
from filelock import FileLock

import mxeon
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep

# Documents that are judged with each library. With eonlib, all examples are judged and must pass.
EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]
DOCUMENTS = {"eonlib": sorted(examples_folder().glob("*.mtlx")), "stock": EXAMPLES}
_MADE = {}  # values by name, if all tests run in a single process


def shared(factory, name, make):
    """Return the result of `make`, which is called once for all test processes."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        if name not in _MADE:
            _MADE[name] = make()
        return _MADE[name]
    path = factory.getbasetemp().parent / f"{name}.pickle"  # each test session has its own folder
    with FileLock(f"{path}.lock"):
        if not path.exists():
            path.write_bytes(pickle.dumps(make()))
        return pickle.loads(path.read_bytes())


# Checks of shaders for path tracers, which only eonlib provides.
DRAWN = ("pdf", "sample", "path_value", "path_inside", "path_energy", "path_leaving")
DRAWN += ("path_albedo", "path_emission", "path_random")


def every_node(factory, library):
    """Results of a library's nodes and of DOCUMENTS on gl, computed once for all tests.

    The checks in DRAWN are left out, because slower tests cover these checks.
    """

    def make():
        with pytest.MonkeyPatch.context() as patch:
            keep(patch, lambda task: task.check not in DRAWN)
            return mxeon.check(DOCUMENTS[library], ["gl"], [library], nodes=["all"])

    return shared(factory, library, make)
